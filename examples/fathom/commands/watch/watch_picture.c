/* SPDX-License-Identifier: MIT */
#include "commands/watch/watch_picture.h"

#include <inttypes.h>
#include <string.h>

/* Left of a lane's plot stands its scale; in a lane of one row, all that is said of it. */
enum { GUTTER = 8, NARROW = 36 };

/* Below the lanes: an axis, a legend, a message. With fewer rows than these there is none of it, or the message has one
 * row instead of two. */
enum { LEAST_FOR_FOOTER = 8, LEAST_FOR_TWO = 16 };

enum { EIGHTHS = 8 };

static void put(picture_t *picture, uint16_t row, uint16_t column, uint8_t glyph, colour_t colour)
{
    if (row >= picture->rows || column >= picture->columns) return;
    picture->cells[row][column] = (cell_t){glyph, (uint8_t)colour};
}

/* Returns the column after it. What is no printable ASCII would need a width, and becomes '?'. */
static uint16_t put_text(picture_t *picture, uint16_t row, uint16_t column, const char *text, colour_t colour)
{
    for (; *text != '\0'; text++, column++)
        put(picture, row, column, *text >= ' ' && *text <= '~' ? (uint8_t)*text : '?', colour);
    return column;
}

static colour_t colour_of(mark_t mark)
{
    if (mark == MARK_NONE) return COLOUR_PLAIN;
    return mark_is_loss(mark) || mark == MARK_FAULT ? COLOUR_LOSS : COLOUR_CALM;
}

/* ---- one lane ---- */

/* The next round number of metres over all that is to be seen. */
static uint32_t scale_mm(const lanes_t *lanes, const lane_t *lane, uint16_t width)
{
    static const uint32_t rounds_mm[] = {500, 1000, 2000, 5000, 10000, 20000, 50000, 70000};
    uint32_t most_mm = 0;
    size_t i = 0;
    for (uint32_t ago = 0; ago < width && ago < LANE_STEPS; ago++) {
        const step_t step = lane_step(lanes, lane, ago);
        if (step.has_distance && step.distance_mm > most_mm) most_mm = step.distance_mm;
    }
    while (rounds_mm[i] < most_mm) i++; /* 65535 is under the last one */
    return rounds_mm[i];
}

/* A bar from the bottom; what came instead of distances over the whole height, or over the foot of the bar. */
static void draw_step(picture_t *picture, const step_t *step, uint16_t column, uint16_t first_row,
                      uint16_t height, uint32_t top_mm)
{
    const uint8_t mark = (uint8_t)mark_character((mark_t)step->mark);
    const colour_t colour = colour_of((mark_t)step->mark);
    const uint32_t eighths = ((uint32_t)step->distance_mm * height * EIGHTHS + top_mm - 1) / top_mm;
    for (uint16_t n = 0; n != height; n++) {
        const uint16_t row = (uint16_t)(first_row + height - 1 - n);
        const uint32_t below = (uint32_t)n * EIGHTHS; /* this row */
        if (step->mark != MARK_NONE && (n == 0 || !step->has_distance))
            put(picture, row, column, mark, colour);
        else if (step->has_distance && eighths > below)
            put(picture, row, column,
                (uint8_t)(GLYPH_BLOCK + (eighths - below < EIGHTHS ? eighths - below : EIGHTHS)), COLOUR_BAR);
    }
}

static void draw_plot(picture_t *picture, const lanes_t *lanes, const lane_t *lane, uint16_t first_row,
                      uint16_t height, uint16_t first_column, bool has_scale)
{
    const uint16_t width = picture->columns > first_column ? (uint16_t)(picture->columns - first_column) : 0;
    const uint32_t top_mm = scale_mm(lanes, lane, width);
    if (has_scale) {
        char label[GUTTER + 4];
        (void)snprintf(label, sizeof label, "%4" PRIu32 ".%" PRIu32 " m", top_mm / 1000, top_mm % 1000 / 100);
        (void)put_text(picture, first_row, 0, label, COLOUR_PLAIN);
        if (height > 1)
            (void)put_text(picture, (uint16_t)(first_row + height - 1), 0, "     0 m", COLOUR_PLAIN);
    }
    for (uint32_t ago = 0; ago < width && ago < LANE_STEPS; ago++) {
        const step_t step = lane_step(lanes, lane, ago);
        draw_step(picture, &step, (uint16_t)(picture->columns - 1 - ago), first_row, height, top_mm);
    }
}

/* So many columns farther to the right stands what is behind the names. */
static uint16_t longer_names(const lanes_t *lanes) { return (uint16_t)(lanes->name_width - LEAST_NAME); }

/* Name, value, rate, losses. */
static void draw_words(picture_t *picture, const lanes_t *lanes, const lane_t *lane, uint16_t row,
                       bool is_short)
{
    const reader_facts_t facts = reader_facts(lane->sensor->reader);
    const uint32_t rate = lane_rate_tenths(lanes, lane);
    char value[LANE_VALUE];
    char text[96];
    const uint16_t longer = longer_names(lanes);
    (void)snprintf(text, sizeof text, "%.*s", lanes->name_width, lane->name);
    (void)put_text(picture, row, 0, text, COLOUR_BOLD);
    (void)put_text(picture, row, (uint16_t)(15 + longer), lane_value(lane, value), colour_of(lane->mark));
    (void)snprintf(text, sizeof text, "%4" PRIu32 ".%" PRIu32 "/s", rate / 10, rate % 10);
    (void)put_text(picture, row, (uint16_t)(27 + longer), text, COLOUR_PLAIN);
    if (is_short) return;
    (void)snprintf(text, sizeof text, "lost %" PRIu64 " of %" PRIu64, lane->lost, lane->outcomes);
    uint16_t end =
        put_text(picture, row, (uint16_t)(38 + longer), text, lane->lost != 0 ? COLOUR_LOSS : COLOUR_PLAIN);
    if (facts.backoff_left_us < 1000000) return;
    (void)snprintf(text, sizeof text, "asked again in %" PRIu32 " s", facts.backoff_left_us / 1000000);
    (void)put_text(picture, row, (uint16_t)(end + 2), text, COLOUR_PLAIN);
}

static void draw_lane(picture_t *picture, const lanes_t *lanes, const lane_t *lane, uint16_t row,
                      uint16_t height)
{
    draw_words(picture, lanes, lane, row, height == 1);
    if (height == 1)
        draw_plot(picture, lanes, lane, row, 1, (uint16_t)(NARROW + longer_names(lanes)), false);
    else
        draw_plot(picture, lanes, lane, (uint16_t)(row + 1), (uint16_t)(height - 1), GUTTER, true);
}

/* ---- around them ---- */

static void draw_axis(picture_t *picture, const lanes_t *lanes, uint16_t row, uint16_t first_column)
{
    char text[32];
    if (picture->columns < first_column + 24) return;
    const uint32_t width = (uint32_t)(picture->columns - first_column);
    const uint64_t seconds = (uint64_t)(width < LANE_STEPS ? width : LANE_STEPS) * lanes->step_us / 1000000u;
    for (uint16_t column = first_column; column != picture->columns; column++)
        put(picture, row, column, '-', COLOUR_PLAIN);
    (void)snprintf(text, sizeof text, "%" PRIu64 " s ago ", seconds);
    (void)put_text(picture, row, first_column, text, COLOUR_PLAIN);
    (void)put_text(picture, row, (uint16_t)(picture->columns - 4), " now", COLOUR_PLAIN);
}

/* Returns true if most sensors never have this mark. */
static bool is_rare(mark_t mark)
{
    return (mark >= MARK_UNKNOWN && mark <= MARK_NEAR) || mark == MARK_LINE_BUSY || mark == MARK_OTHER_MASTER;
}

/* A rare mark appears in the legend after its first use: all marks together need more than 80 columns. */
static void draw_legend(picture_t *picture, const lanes_t *lanes, uint16_t row)
{
    uint16_t column = 0;
    for (mark_t mark = MARK_NO_TARGET; mark != MARKS; mark++) {
        if (is_rare(mark) && (lanes->seen >> mark & 1) == 0) continue;
        put(picture, row, column, (uint8_t)mark_character(mark), colour_of(mark));
        column =
            (uint16_t)(put_text(picture, row, (uint16_t)(column + 2), mark_name(mark), COLOUR_PLAIN) + 1);
    }
}

/* How many lanes have no space, at the right end of the title. */
static void draw_hidden(picture_t *picture, size_t count)
{
    char text[32];
    if (count == 0) return;
    const int length = snprintf(text, sizeof text, " %zu more: enlarge", count);
    if (length < picture->columns)
        (void)put_text(picture, 0, (uint16_t)(picture->columns - length), text, COLOUR_LOSS);
}

/* In as many rows as there are, the last of which is cut. */
static void draw_message(picture_t *picture, const char *message, uint16_t row)
{
    while (strlen(message) > picture->columns && row + 1 < picture->rows) {
        size_t length = picture->columns;
        while (length != 0 && message[length] != ' ') length--;
        if (length == 0) length = picture->columns;
        char part[PICTURE_COLUMNS + 1];
        memcpy(part, message, length);
        part[length] = '\0';
        (void)put_text(picture, row++, 0, part, COLOUR_LOSS);
        message += length;
        while (*message == ' ') message++;
    }
    (void)put_text(picture, row, 0, message, COLOUR_LOSS);
}

void picture_draw(picture_t *picture, uint16_t rows, uint16_t columns, const lanes_t *lanes,
                  const char *title, const char *message)
{
    picture->rows = rows < PICTURE_ROWS ? rows : PICTURE_ROWS;
    picture->columns = columns < PICTURE_COLUMNS ? columns : PICTURE_COLUMNS;
    for (uint16_t row = 0; row != picture->rows; row++)
        for (uint16_t column = 0; column != picture->columns; column++)
            picture->cells[row][column] = (cell_t){' ', COLOUR_PLAIN};
    (void)put_text(picture, 0, 0, title, COLOUR_BOLD);
    if (picture->rows < 2) return;
    const bool has_footer = picture->rows >= LEAST_FOR_FOOTER;
    const uint16_t footer = (uint16_t)(picture->rows >= LEAST_FOR_TWO ? 4 : 3);
    const uint16_t end = (uint16_t)(picture->rows - (has_footer ? footer : 0));
    const uint16_t height_of_all = (uint16_t)(end - 1);
    const size_t shown = lanes->count < height_of_all ? lanes->count : height_of_all;
    uint16_t row = 1;
    for (size_t i = 0; i != shown; i++) {
        const uint16_t height = (uint16_t)(height_of_all / shown + (i < height_of_all % shown ? 1 : 0));
        draw_lane(picture, lanes, &lanes->lane[i], row, height);
        row = (uint16_t)(row + height);
    }
    draw_hidden(picture, lanes->count - shown);
    if (!has_footer) return;
    draw_axis(picture, lanes, end,
              height_of_all == shown ? (uint16_t)(NARROW + longer_names(lanes)) : GUTTER);
    draw_legend(picture, lanes, (uint16_t)(end + 1));
    draw_message(picture, message, (uint16_t)(end + 2));
}

/* ---- for the terminal ---- */

static const char *glyph_text(uint8_t glyph, bool is_utf8, char ascii[2])
{
    static const char *const blocks[] = {" ",
                                         "\xE2\x96\x81",
                                         "\xE2\x96\x82",
                                         "\xE2\x96\x83",
                                         "\xE2\x96\x84",
                                         "\xE2\x96\x85",
                                         "\xE2\x96\x86",
                                         "\xE2\x96\x87",
                                         "\xE2\x96\x88"};
    static const char plain[] = " ...::###";
    if (glyph > GLYPH_BLOCK && is_utf8) return blocks[glyph - GLYPH_BLOCK];
    ascii[0] = glyph > GLYPH_BLOCK ? plain[glyph - GLYPH_BLOCK] : (char)glyph;
    ascii[1] = '\0';
    return ascii;
}

uint16_t picture_row(const picture_t *picture, uint16_t row, bool has_colours, bool is_utf8, char *text)
{
    static const char *const codes[] = {[COLOUR_PLAIN] = "\x1B[0m",
                                        [COLOUR_BAR] = "\x1B[0;36m",
                                        [COLOUR_CALM] = "\x1B[0;33m",
                                        [COLOUR_LOSS] = "\x1B[0;31m",
                                        [COLOUR_BOLD] = "\x1B[0;1m"};
    const cell_t *const cells = picture->cells[row];
    uint8_t colour = COLOUR_PLAIN;
    uint16_t columns = picture->columns;
    size_t at = 0;
    while (columns != 0 && cells[columns - 1].glyph == ' ') columns--;
    for (uint16_t column = 0; column != columns; column++) {
        char ascii[2];
        if (has_colours && cells[column].colour != colour && cells[column].glyph != ' ') {
            colour = cells[column].colour;
            at += (size_t)snprintf(text + at, PICTURE_ROW_TEXT - at, "%s", codes[colour]);
        }
        at += (size_t)snprintf(text + at, PICTURE_ROW_TEXT - at, "%s",
                               glyph_text(cells[column].glyph, is_utf8, ascii));
    }
    if (colour != COLOUR_PLAIN)
        at += (size_t)snprintf(text + at, PICTURE_ROW_TEXT - at, "%s", codes[COLOUR_PLAIN]);
    text[at] = '\0';
    return columns;
}
