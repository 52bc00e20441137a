/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): stpcpy */
#include "commands/watch/watch_picture.h"

#include <inttypes.h>
#include <stdarg.h>
#include <string.h>

/* Left of a plot are GUTTER columns with its scale; in a lane of one row, NARROW columns with all its words. Below the
 * lanes are an axis, a legend and a message of two rows, if there is space for them. */
enum { GUTTER = 8, NARROW = 36, LEAST_FOR_FOOTER = 8, LEAST_FOR_TWO = 16, EIGHTHS = 8 };

enum { PLAIN, BAR, CALM, LOSS, BOLD };

static void put(picture_t *picture, int row, int column, int glyph, int colour)
{
    if (row < picture->rows && column < picture->columns)
        picture->cells[row][column] = (cell_t){(uint8_t)glyph, (uint8_t)colour};
}

/* Returns the column behind the text. A character that is not printable ASCII becomes '?'. */
static int put_text(picture_t *picture, int row, int column, int colour, const char *format, ...)
    __attribute__((format(printf, 5, 6)));
static int put_text(picture_t *picture, int row, int column, int colour, const char *format, ...)
{
    char text[PICTURE_COLUMNS + 1];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    for (const char *at = text; *at != '\0'; at++, column++)
        put(picture, row, column, *at >= ' ' && *at <= '~' ? *at : '?', colour);
    return column;
}

static int colour_of(uint8_t mark)
{
    if (mark == MARK_NONE) return PLAIN;
    return marks[mark].is_loss || mark == MARK_FAULT ? LOSS : CALM;
}

/* ---- one lane ---- */

/* The next round number of metres over all that is shown. */
static uint32_t scale_mm(const lanes_t *lanes, const lane_t *lane, int width)
{
    static const uint32_t rounds_mm[] = {500, 1000, 2000, 5000, 10000, 20000, 50000, 70000};
    uint32_t most_mm = 0;
    int i = 0;
    for (int ago = 0; ago < width && ago < LANE_STEPS; ago++) {
        const step_t step = lane_step(lanes, lane, ago);
        if (step.has_distance && step.distance_mm > most_mm) most_mm = step.distance_mm;
    }
    while (rounds_mm[i] < most_mm) i++; /* 65535 is below the last one */
    return rounds_mm[i];
}

/* A bar from the bottom. A mark fills the height, or covers the foot of the bar. */
static void draw_step(picture_t *picture, const step_t *step, int column, int first_row, int height,
                      uint32_t top_mm)
{
    const int eighths =
        (int)(((uint32_t)step->distance_mm * (uint32_t)height * EIGHTHS + top_mm - 1) / top_mm);
    for (int n = 0; n != height; n++) {
        const int row = first_row + height - 1 - n;
        const int filled = eighths - n * EIGHTHS;
        if (step->mark != MARK_NONE && (n == 0 || !step->has_distance))
            put(picture, row, column, marks[step->mark].character, colour_of(step->mark));
        else if (step->has_distance && filled > 0)
            put(picture, row, column, GLYPH_BLOCK + (filled < EIGHTHS ? filled : EIGHTHS), BAR);
    }
}

static void draw_plot(picture_t *picture, const lanes_t *lanes, const lane_t *lane, int first_row, int height,
                      int first_column)
{
    const int width = picture->columns - first_column;
    const uint32_t top_mm = scale_mm(lanes, lane, width);
    if (first_column == GUTTER)
        (void)put_text(picture, first_row, 0, PLAIN, "%4" PRIu32 ".%" PRIu32 " m", top_mm / 1000,
                       top_mm % 1000 / 100);
    if (first_column == GUTTER && height > 1)
        (void)put_text(picture, first_row + height - 1, 0, PLAIN, "     0 m");
    for (int ago = 0; ago < width && ago < LANE_STEPS; ago++) {
        const step_t step = lane_step(lanes, lane, ago);
        draw_step(picture, &step, picture->columns - 1 - ago, first_row, height, top_mm);
    }
}

/* Name, value, rate; in a higher lane also the losses. */
static void draw_words(picture_t *picture, const lanes_t *lanes, const lane_t *lane, int row, bool is_short)
{
    const uint32_t left_s = reader_facts(lane->sensor->reader).backoff_left_us / 1000000;
    const uint32_t rate = lane_rate_tenths(lanes, lane);
    const int longer = lanes->name_width - LEAST_NAME;
    char value[LANE_VALUE];
    (void)put_text(picture, row, 0, BOLD, "%.*s", lanes->name_width, lane->name);
    (void)put_text(picture, row, 15 + longer, colour_of((uint8_t)lane->mark), "%s", lane_value(lane, value));
    (void)put_text(picture, row, 27 + longer, PLAIN, "%4" PRIu32 ".%" PRIu32 "/s", rate / 10, rate % 10);
    if (is_short) return;
    const int end = put_text(picture, row, 38 + longer, lane->lost != 0 ? LOSS : PLAIN,
                             "lost %" PRIu64 " of %" PRIu64, lane->lost, lane->outcomes);
    if (left_s != 0) (void)put_text(picture, row, end + 2, PLAIN, "asked again in %" PRIu32 " s", left_s);
}

static int narrow(const lanes_t *lanes) { return NARROW + lanes->name_width - LEAST_NAME; }

static void draw_lane(picture_t *picture, const lanes_t *lanes, const lane_t *lane, int row, int height)
{
    draw_words(picture, lanes, lane, row, height == 1);
    if (height == 1)
        draw_plot(picture, lanes, lane, row, 1, narrow(lanes));
    else
        draw_plot(picture, lanes, lane, row + 1, height - 1, GUTTER);
}

/* Returns the height of a lane of one row if there is not more space for each. */
static int draw_lanes(picture_t *picture, const lanes_t *lanes, int end)
{
    const int space = end - 1;
    const int shown = lanes->count < space ? lanes->count : space;
    int row = 1;
    for (int i = 0; i != shown; i++) {
        const int height = space / shown + (i < space % shown ? 1 : 0);
        draw_lane(picture, lanes, &lanes->lane[i], row, height);
        row += height;
    }
    if (lanes->count > shown && picture->columns > 24)
        (void)put_text(picture, 0, picture->columns - 18, LOSS, "%4d more: enlarge", lanes->count - shown);
    return space / shown;
}

/* ---- around them ---- */

static void draw_axis(picture_t *picture, const lanes_t *lanes, int row, int first_column)
{
    const int width = picture->columns - first_column;
    const int steps = width < LANE_STEPS ? width : LANE_STEPS;
    if (width < 24) return;
    for (int column = first_column; column != picture->columns; column++)
        put(picture, row, column, '-', PLAIN);
    (void)put_text(picture, row, first_column, PLAIN, "%" PRIu64 " s ago ",
                   (uint64_t)steps * lanes->step_us / 1000000u);
    (void)put_text(picture, row, picture->columns - 4, PLAIN, " now");
}

/* A rare mark is in the legend after its first use: all marks together need more than 80 columns. */
static void draw_legend(picture_t *picture, const lanes_t *lanes, int row)
{
    int column = 0;
    for (uint8_t mark = MARK_NO_TARGET; mark != MARKS; mark++) {
        if (marks[mark].is_rare && (lanes->seen >> mark & 1) == 0) continue;
        put(picture, row, column, marks[mark].character, colour_of(mark));
        column = put_text(picture, row, column + 2, PLAIN, "%s", marks[mark].name) + 1;
    }
}

/* In the rows that are left; the last one is cut. */
static void draw_message(picture_t *picture, const char *message, int row)
{
    while ((int)strlen(message) > picture->columns && row + 1 < picture->rows) {
        int length = picture->columns;
        while (length != 0 && message[length] != ' ') length--;
        if (length == 0) length = picture->columns;
        (void)put_text(picture, row++, 0, LOSS, "%.*s", length, message);
        message += length;
        while (*message == ' ') message++;
    }
    (void)put_text(picture, row, 0, LOSS, "%s", message);
}

void picture_draw(picture_t *picture, int rows, int columns, const lanes_t *lanes, const char *title,
                  const char *message)
{
    picture->rows = rows < PICTURE_ROWS ? rows : PICTURE_ROWS;
    picture->columns = columns < PICTURE_COLUMNS ? columns : PICTURE_COLUMNS;
    for (int row = 0; row != picture->rows; row++)
        for (int column = 0; column != picture->columns; column++)
            picture->cells[row][column] = (cell_t){' ', PLAIN};
    (void)put_text(picture, 0, 0, BOLD, "%s", title);
    if (picture->rows < 2) return;
    const bool has_footer = picture->rows >= LEAST_FOR_FOOTER;
    const int end = picture->rows - (!has_footer ? 0 : picture->rows >= LEAST_FOR_TWO ? 4 : 3);
    const int height = draw_lanes(picture, lanes, end);
    if (!has_footer) return;
    draw_axis(picture, lanes, end, height == 1 && lanes->count >= end - 1 ? narrow(lanes) : GUTTER);
    draw_legend(picture, lanes, end + 1);
    draw_message(picture, message, end + 2);
}

/* ---- for the terminal ---- */

static const char *glyph_text(uint8_t glyph, bool is_utf8, char ascii[2])
{
    static const char blocks[][4] = {"\xE2\x96\x81", "\xE2\x96\x82", "\xE2\x96\x83", "\xE2\x96\x84",
                                     "\xE2\x96\x85", "\xE2\x96\x86", "\xE2\x96\x87", "\xE2\x96\x88"};
    static const char plain[] = "...::###";
    if (glyph > GLYPH_BLOCK && is_utf8) return blocks[glyph - GLYPH_BLOCK - 1];
    ascii[0] = glyph > GLYPH_BLOCK ? plain[glyph - GLYPH_BLOCK - 1] : (char)glyph;
    ascii[1] = '\0';
    return ascii;
}

int picture_row(const picture_t *picture, int row, bool has_colours, bool is_utf8,
                char text[PICTURE_ROW_TEXT])
{
    static const char *const codes[] = {[PLAIN] = "\x1B[0m",
                                        [BAR] = "\x1B[0;36m",
                                        [CALM] = "\x1B[0;33m",
                                        [LOSS] = "\x1B[0;31m",
                                        [BOLD] = "\x1B[0;1m"};
    const cell_t *const cells = picture->cells[row];
    uint8_t colour = PLAIN;
    int columns = picture->columns;
    char *at = text;
    while (columns != 0 && cells[columns - 1].glyph == ' ') columns--;
    for (int column = 0; column != columns; column++) {
        char ascii[2];
        if (has_colours && cells[column].colour != colour && cells[column].glyph != ' ') {
            colour = cells[column].colour;
            at = stpcpy(at, codes[colour]);
        }
        at = stpcpy(at, glyph_text(cells[column].glyph, is_utf8, ascii));
    }
    (void)strcpy(at, colour != PLAIN ? codes[PLAIN] : "");
    return columns;
}
