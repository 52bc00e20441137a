/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE                                                                                          \
    1 /* NOLINT(bugprone-reserved-identifier): fmemopen, open_memstream, strcasestr, tcgetpgrp */
#include <errno.h>
#include <inttypes.h>
#include <poll.h>
#include <signal.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include "cli/command.h"
#include "cli/rows.h"
#include "commands/commands.h"
#include "commands/watch/lanes.h"
#include "output/words.h"
#include "ports/host.h"

/* fathom watch draws pictures of all lanes on a terminal, and prints lines into anything else. */

/* The picture shows distances as they are read. */
static const option_t elsewhere_rows[] = {
    {"median", .is_hidden = true, .instead = "median of 'fathom read'"},
    {"level", .is_hidden = true, .instead = "level of 'fathom read'"},
    {"alarm", .is_hidden = true, .instead = "alarm of 'fathom read'"},
    {.name = NULL},
};

#define SENSORS(member) offsetof(sensor_settings_t, member)
static const option_table_t tables[] = {
    {elsewhere_rows, 0},
    {word_rows, SENSORS(defaults)},
    {interval_rows, SENSORS(reader)},
    {request_rows, SENSORS(reader)},
    {reading_rows, SENSORS(reader)},
    {port_rows, SENSORS(defaults)},
    {reconnect_rows, SENSORS(run)},
    {NULL, 0},
};

/* Eight pictures a second are smooth; a line a second can be read. A message stays for a while. */
enum { PICTURE_US = 125000, LINE_US = 1000000, MESSAGE_US = 5000000, MESSAGE = 512, PORTS = 256 };

static struct {
    loop_t loop;
    lanes_t lanes;
    uint64_t next_us;                      /* when the next picture or line is due */
    char message[MESSAGE];                 /* below the lanes */
    uint64_t message_end_us;               /* when it disappears */
    char loss[MESSAGE];                    /* the last message about a port that was lost */
    fathom_status_t reported[MAX_SENSORS]; /* for lines: the last failure of each sensor that was printed */
    bool draws;                            /* pictures, else lines */
    bool wants_all;   /* the next picture is drawn as a whole: others may have written to the terminal */
    bool wants_end;   /* q was pressed */
    int output_error; /* errno */
} watch;

/* ---- the picture: characters in rows and columns ---- */

enum { ROWS = 200, COLUMNS = 400 };

/* Left of a plot are GUTTER columns with its scale; in a lane of one row, NARROW columns with all its words. Below the
 * lanes are an axis, a legend and a message of two rows, if there is space for them. */
enum { GUTTER = 8, NARROW = 36, LEAST_FOR_FOOTER = 8, LEAST_FOR_TWO = 16, EIGHTHS = 8 };

typedef enum { PLAIN, BAR, CALM, LOSS, BOLD } colour_t;

/* A glyph from 1 to 8 is a block of eighths that is filled from below. */
typedef struct {
    uint8_t glyph;
    uint8_t colour;
} cell_t;

typedef struct {
    int rows; /* of the window, as far as they are drawn */
    int columns;
    cell_t cells[ROWS][COLUMNS];
} picture_t;

static picture_t picture;
static picture_t shown; /* the one on the terminal; without rows: none */

static void put(int row, int column, int glyph, colour_t colour)
{
    if (row < picture.rows && column < picture.columns)
        picture.cells[row][column] = (cell_t){(uint8_t)glyph, (uint8_t)colour};
}

/* Returns the column behind the text. A character that is not printable ASCII becomes '?'. */
static int put_text(int row, int column, colour_t colour, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
static int put_text(int row, int column, colour_t colour, const char *format, ...)
{
    char text[COLUMNS + 1];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    for (const char *at = text; *at != '\0'; at++, column++)
        put(row, column, *at >= ' ' && *at <= '~' ? *at : '?', colour);
    return column;
}

static colour_t colour_of(mark_t mark)
{
    if (mark == MARK_NONE || mark == MARK_WAITING) return PLAIN;
    return marks[mark].is_loss || mark == MARK_FAULT ? LOSS : CALM;
}

/* A bar from the bottom. A mark fills the height, or covers the foot of the bar. */
static void draw_step(const step_t *step, int column, int first_row, int height, uint32_t top_mm)
{
    const int eighths =
        (int)(((uint32_t)step->distance_mm * (uint32_t)height * EIGHTHS + top_mm - 1) / top_mm);
    for (int n = 0; n != height; n++) {
        const int row = first_row + height - 1 - n;
        const int filled = eighths - n * EIGHTHS;
        if (step->mark != MARK_NONE && (n == 0 || !step->has_distance))
            put(row, column, marks[step->mark].character, colour_of(step->mark));
        else if (step->has_distance && filled > 0)
            put(row, column, filled < EIGHTHS ? filled : EIGHTHS, BAR);
    }
}

/* The scale of a plot ends at the next round number of metres over all that is shown. */
static void draw_plot(const lane_t *lane, int first_row, int height, int first_column)
{
    static const uint32_t rounds_mm[] = {500, 1000, 2000, 5000, 10000, 20000, 50000, 70000};
    const uint32_t *top_mm = rounds_mm;
    int width = picture.columns - first_column;
    if (width > LANE_STEPS) width = LANE_STEPS;
    for (int ago = 0; ago < width; ago++) {
        const step_t *const step = lane_step(&watch.lanes, lane, ago);
        while (step->has_distance && step->distance_mm > *top_mm) top_mm++; /* 65535 is below the last one */
    }
    if (first_column == GUTTER)
        (void)put_text(first_row, 0, PLAIN, "%4" PRIu32 ".%" PRIu32 " m", *top_mm / 1000,
                       *top_mm % 1000 / 100);
    if (first_column == GUTTER && height > 1) (void)put_text(first_row + height - 1, 0, PLAIN, "     0 m");
    for (int ago = 0; ago < width; ago++)
        draw_step(lane_step(&watch.lanes, lane, ago), picture.columns - 1 - ago, first_row, height, *top_mm);
}

/* Name, value, rate; in a higher lane also the losses. */
static void draw_words(const lane_t *lane, int row, bool is_short)
{
    const uint32_t left_s = reader_facts(lane->sensor->reader).backoff_left_us / 1000000;
    const int longer = watch.lanes.name_width - LEAST_NAME;
    char text[LANE_TEXT];
    (void)put_text(row, 0, BOLD, "%.*s", watch.lanes.name_width, lane->name);
    (void)put_text(row, 15 + longer, colour_of(lane->mark), "%s", lane_value(lane, text));
    (void)put_text(row, 27 + longer, PLAIN, "%8s", lane_rate(&watch.lanes, lane, text));
    if (is_short) return;
    const int end = put_text(row, 38 + longer, lane->lost != 0 ? LOSS : PLAIN, "lost %" PRIu64 " of %" PRIu64,
                             lane->lost, lane->outcomes);
    if (left_s != 0) (void)put_text(row, end + 2, PLAIN, "asked again in %" PRIu32 " s", left_s);
}

/* Draws the lanes above row `end`. Returns the column in which the plots of the last rows begin. */
static int draw_lanes(int end)
{
    const int narrow = NARROW + watch.lanes.name_width - LEAST_NAME;
    const int count = watch.lanes.count;
    const int space = end - 1;
    const int drawn = count < space ? count : space;
    int row = 1;
    for (int i = 0; i != drawn; i++) {
        const lane_t *const lane = &watch.lanes.lane[i];
        const int height = space / drawn + (i < space % drawn ? 1 : 0);
        draw_words(lane, row, height == 1);
        if (height == 1)
            draw_plot(lane, row, 1, narrow);
        else
            draw_plot(lane, row + 1, height - 1, GUTTER);
        row += height;
    }
    if (count > space && picture.columns > 24)
        (void)put_text(0, picture.columns - 18, LOSS, "%4d more: enlarge", count - space);
    return count >= space ? narrow : GUTTER;
}

static void draw_axis(int row, int first_column)
{
    const int width = picture.columns - first_column;
    const int steps = width < LANE_STEPS ? width : LANE_STEPS;
    if (width < 24) return;
    for (int column = first_column; column != picture.columns; column++) put(row, column, '-', PLAIN);
    (void)put_text(row, first_column, PLAIN, "%" PRIu64 " s ago ",
                   (uint64_t)steps * watch.lanes.step_us / 1000000u);
    (void)put_text(row, picture.columns - 4, PLAIN, " now");
}

/* A rare mark is in the legend after its first use: all marks together need more than 80 columns. */
static void draw_legend(int row)
{
    int column = 0;
    for (mark_t mark = MARK_NO_TARGET; mark != MARKS; mark++) {
        if (marks[mark].is_rare && (watch.lanes.seen >> mark & 1) == 0) continue;
        put(row, column, marks[mark].character, colour_of(mark));
        column = put_text(row, column + 2, PLAIN, "%s", marks[mark].name) + 1;
    }
}

/* In the rows that are left; the last one is cut. */
static void draw_message(const char *message, int row)
{
    while ((int)strlen(message) > picture.columns && row + 1 < picture.rows) {
        int length = picture.columns;
        while (length != 0 && message[length] != ' ') length--;
        if (length == 0) length = picture.columns;
        (void)put_text(row++, 0, LOSS, "%.*s", length, message);
        message += length;
        while (*message == ' ') message++;
    }
    (void)put_text(row, 0, LOSS, "%s", message);
}

/* Writes a row without its position and the blanks at its end. Returns the columns that it fills. */
static int print_row(FILE *to, int row, bool has_colours, bool is_utf8)
{
    static const char *const codes[] = {[PLAIN] = "\x1B[0m",
                                        [BAR] = "\x1B[0;36m",
                                        [CALM] = "\x1B[0;33m",
                                        [LOSS] = "\x1B[0;31m",
                                        [BOLD] = "\x1B[0;1m"};
    const cell_t *const cells = picture.cells[row];
    uint8_t colour = PLAIN;
    int columns = picture.columns;
    while (columns != 0 && cells[columns - 1].glyph == ' ') columns--;
    for (int column = 0; column != columns; column++) {
        const uint8_t glyph = cells[column].glyph;
        if (has_colours && cells[column].colour != colour && glyph != ' ') {
            colour = cells[column].colour;
            (void)fputs(codes[colour], to);
        }
        if (glyph > EIGHTHS)
            (void)fputc(glyph, to);
        else if (is_utf8)
            (void)fprintf(to, "\xE2\x96%c", 0x80 + glyph); /* U+2581 to U+2588 */
        else
            (void)fputc("...::###"[glyph - 1], to);
    }
    if (colour != PLAIN) (void)fputs(codes[PLAIN], to);
    return columns;
}

/* ---- the terminal ---- */

/*
 * While the terminal is open, the picture has another screen without a cursor, nothing that is typed is echoed, and
 * Ctrl-Z and Ctrl-\ do nothing, because they would leave the terminal in this state.
 */
static struct {
    struct termios before;
    bool has_input; /* `before` is set */
} terminal;

static bool terminal_can_draw(void)
{
    const char *const type = environment("TERM");
    return isatty(STDOUT_FILENO) == 1 && type[0] != '\0' && strcmp(type, "dumb") != 0;
}

/* By the name of the locale, which need not be installed. */
static bool terminal_is_utf8(void)
{
    const char *locale = environment("LC_ALL");
    if (locale[0] == '\0') locale = environment("LC_CTYPE");
    if (locale[0] == '\0') locale = environment("LANG");
    return strcasestr(locale, "utf-8") != NULL || strcasestr(locale, "utf8") != NULL;
}

/* A signal that ends the command also ends a write to a terminal that accepts nothing, as after Ctrl-S. Returns 0, or
 * errno. */
static int write_all(const char *text)
{
    enum { STUCK_MS = 200 };
    struct pollfd entry = {STDOUT_FILENO, POLLOUT, 0};
    while (text[0] != '\0') {
        if (host_posix.has_ended(NULL) && poll(&entry, 1, STUCK_MS) == 0) return EINTR;
        const ssize_t n = write(STDOUT_FILENO, text, strlen(text));
        if (n >= 0)
            text += n;
        else if (errno != EINTR || host_posix.has_ended(NULL))
            return errno;
    }
    return 0;
}

static void terminal_open(void)
{
    /* A program in the background would be stopped for changing it. */
    terminal.has_input =
        tcgetpgrp(STDIN_FILENO) == getpgrp() && tcgetattr(STDIN_FILENO, &terminal.before) == 0;
    if (terminal.has_input) {
        struct termios quiet = terminal.before;
        quiet.c_lflag &= ~(tcflag_t)(ECHO | ICANON);
        quiet.c_cc[VSUSP] = _POSIX_VDISABLE;
        quiet.c_cc[VQUIT] = _POSIX_VDISABLE;
        quiet.c_cc[VMIN] = 0; /* a read does not wait */
        quiet.c_cc[VTIME] = 0;
        (void)tcsetattr(STDIN_FILENO, TCSADRAIN, &quiet);
    }
    shown.rows = 0;
    /* Another screen, no cursor, no wrap at the right edge, nothing on the screen. */
    (void)write_all("\x1B[?1049h\x1B[?25l\x1B[?7l\x1B[2J");
}

/* Restores the terminal. False: a signal ended the command, and the terminal is stuck. */
static bool terminal_close(void)
{
    const bool is_restored = write_all("\x1B[0m\x1B[?7h\x1B[?25h\x1B[?1049l") != EINTR;
    /* What was typed is dropped. TCSAFLUSH would wait for output that a stuck terminal does not accept. */
    if (terminal.has_input)
        (void)tcsetattr(STDIN_FILENO, is_restored ? TCSAFLUSH : TCSANOW, &terminal.before);
    if (terminal.has_input && !is_restored) (void)tcflush(STDIN_FILENO, TCIFLUSH);
    return is_restored;
}

static int keys_fd(const fathom_loop_source_t *source)
{
    (void)source;
    return STDIN_FILENO;
}

static bool poll_keys(fathom_loop_source_t *source)
{
    char keys[64];
    ssize_t n;
    if (!source->is_readable) return true;
    while ((n = read(STDIN_FILENO, keys, sizeof keys)) > 0)
        if (memchr(keys, 'q', (size_t)n) != NULL || memchr(keys, 'Q', (size_t)n) != NULL)
            watch.wants_end = true;
    return true;
}

/* 80 x 24 if the system does not know. */
static void read_window(void)
{
    struct winsize size = {0, 0, 0, 0};
    const bool is_known =
        ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_row != 0 && size.ws_col != 0;
    const int rows = is_known ? size.ws_row : 24;
    const int columns = is_known ? size.ws_col : 80;
    picture.rows = rows < ROWS ? rows : ROWS;
    picture.columns = columns < COLUMNS ? columns : COLUMNS;
}

/* Writes the rows that have changed, or all of them: in one write as a rule, so that no half picture is seen. Returns 0,
 * or errno. */
static int show_picture(bool all)
{
    const bool has_colours = environment("NO_COLOR")[0] == '\0';
    const bool is_utf8 = terminal_is_utf8();
    char *text = NULL;
    size_t size = 0;
    FILE *const to = open_memstream(&text, &size);
    if (to == NULL) return ENOMEM;
    if (picture.rows != shown.rows || picture.columns != shown.columns) all = true;
    if (all) (void)fputs("\x1B[0m\x1B[2J", to);
    for (int row = 0; row != picture.rows; row++) {
        const size_t bytes = (size_t)picture.columns * sizeof(cell_t);
        if (!all && memcmp(picture.cells[row], shown.cells[row], bytes) == 0) continue;
        (void)fprintf(to, "\x1B[%d;1H", row + 1);
        /* at the right edge this would erase the last character */
        if (print_row(to, row, has_colours, is_utf8) != picture.columns) (void)fputs("\x1B[K", to);
    }
    const int error = fclose(to) == 0 ? write_all(text) : errno;
    free(text);
    shown = picture;
    return error;
}

/* ---- all of it at once ---- */

/* "/dev/ttyUSB0", or "ttyUSB0, ttyUSB1, ttyUSB2 and 3 more". */
static void name_ports(const site_t *site, char text[PORTS])
{
    enum { NAMED = 3 };
    size_t count = 0;
    text[0] = '\0';
    for (const line_t *line = site->lines; line != NULL && count++ != NAMED; line = line->next)
        list_add(text, PORTS, site->line_count == 1 ? line->settings.path : last_part(line->settings.path));
    const size_t length = strlen(text);
    if (site->line_count > NAMED)
        (void)snprintf(text + length, PORTS - length, " and %zu more", site->line_count - NAMED);
}

static void draw(uint64_t now_us)
{
    const unsigned seconds = (unsigned)(now_us / 1000000u);
    char ports[PORTS];
    name_ports(&watch.loop.site, ports);
    for (int row = 0; row != picture.rows; row++)
        for (int column = 0; column != picture.columns; column++)
            picture.cells[row][column] = (cell_t){' ', PLAIN};
    (void)put_text(0, 0, BOLD, "fathom watch %s   %02u:%02u:%02u   %sCtrl-C ends", ports, seconds / 3600,
                   seconds / 60 % 60, seconds % 60, terminal.has_input ? "q or " : "");
    if (picture.rows >= LEAST_FOR_FOOTER) {
        const int end = picture.rows - (picture.rows >= LEAST_FOR_TWO ? 4 : 3);
        draw_axis(end, draw_lanes(end));
        draw_legend(end + 1);
        draw_message(now_us < watch.message_end_us ? watch.message : "", end + 2);
    } else if (picture.rows > 1) {
        (void)draw_lanes(picture.rows);
    }
    watch.output_error = show_picture(watch.wants_all);
    /* While a port is waited for, others may write to the terminal. */
    watch.wants_all = loop_is_lost(&watch.loop);
}

/* All lanes in one line. */
static void print_line(uint64_t now_us)
{
    errno = 0;
    (void)printf("%6" PRIu64 ".%" PRIu64 " s", now_us / 1000000u, now_us / 100000u % 10);
    for (int i = 0; i != watch.lanes.count; i++) {
        const lane_t *const lane = &watch.lanes.lane[i];
        char value[LANE_TEXT];
        char rate[LANE_TEXT];
        (void)printf("  %s %s %s", lane->name, lane_value(lane, value), lane_rate(&watch.lanes, lane, rate));
        if (lane->lost != 0) (void)printf(" lost %" PRIu64 " of %" PRIu64, lane->lost, lane->outcomes);
    }
    (void)puts("");
    watch.output_error = output_flush();
}

/* ---- what the loop reports ---- */

/* Shows a message below the lanes. Without a picture it is printed, unless it was printed before. */
static void show_message(const char *text, uint64_t for_us, bool is_new)
{
    (void)snprintf(watch.message, sizeof watch.message, "%s", text);
    watch.message_end_us = loop_time_us(&watch.loop) + for_us;
    if (!watch.draws && is_new) (void)fprintf(stderr, "fathom: %s\n", text);
}

/* Shows the advice of fathom read. */
static void show_failure(const reading_t *reading)
{
    fathom_status_t *const reported = &watch.reported[reading->sensor->number];
    /* The advice names the model and the address itself, but neither if the port fails. */
    const bool has_name = reading->sensor->has_own_name && reading->status != FATHOM_ERR_PORT;
    char text[MESSAGE] = "";
    FILE *const to = reading->evidence->is_told ? NULL : fmemopen(text, sizeof text - 1, "w");
    if (to != NULL) {
        if (has_name) (void)fprintf(to, "%s: ", reading->sensor->name);
        advice_print(to, reading->evidence);
        (void)fclose(to);
        show_message(text, MESSAGE_US, *reported != reading->status);
        if (reading->status == FATHOM_ERR_PORT) memcpy(watch.loss, text, sizeof text);
    }
    *reported = reading->status;
}

static void on_reading(void *ctx, const reading_t *reading)
{
    const uint64_t now_us = loop_time_us(&watch.loop);
    (void)ctx;
    lanes_pass(&watch.lanes, now_us);
    lanes_add(&watch.lanes, reading);
    if (reading->evidence != NULL) show_failure(reading);
    if (reading->failure != NULL) return;
    if (watch.message_end_us > now_us + MESSAGE_US) watch.message_end_us = now_us + MESSAGE_US;
    watch.reported[reading->sensor->number] = FATHOM_OK;
}

/* A message that may ask for something stays until there are readings. */
static void on_notice(void *ctx, const notice_t *notice)
{
    const bool has_sensor = notice->sensor != NULL;
    char line[MESSAGE];
    (void)ctx;
    (void)snprintf(line, sizeof line, "%s%s%s", has_sensor ? notice->sensor->name : "",
                   has_sensor ? ": " : "", notice->text);
    show_message(line, notice->kind == NOTICE_OPEN ? MESSAGE_US : UINT32_MAX, true);
    if (notice->kind == NOTICE_REMARK) return;
    watch.wants_all = true;
    if (notice->kind != NOTICE_OPEN) memcpy(watch.loss, line, sizeof line);
}

static uint32_t tick(void *ctx)
{
    const uint64_t now_us = loop_time_us(&watch.loop);
    const uint32_t every_us = watch.draws ? PICTURE_US : LINE_US;
    (void)ctx;
    if (host_had_signal()) {
        read_window();
        watch.wants_all = true;
        watch.next_us = now_us;
    }
    if (watch.wants_end) loop_stop(&watch.loop);
    if (now_us < watch.next_us) return (uint32_t)(watch.next_us - now_us);
    lanes_pass(&watch.lanes, now_us);
    if (watch.draws)
        draw(now_us);
    else
        print_line(now_us);
    if (watch.output_error != 0) loop_stop(&watch.loop);
    watch.next_us = now_us - now_us % every_us + every_us;
    return (uint32_t)(watch.next_us - now_us);
}

/* ---- the command ---- */

/* is_open: the loop ran. Returns the exit status. */
static int finish(const host_t *host, bool is_open)
{
    account_t account;
    if (watch.output_error == EINTR && host->has_ended(host->ctx)) watch.output_error = 0;
    if (watch.output_error == EPIPE || host->is_output_gone(host->ctx)) return STATUS_FAILED;
    if (watch.output_error != 0)
        (void)fprintf(stderr, "fathom: the picture cannot be written: %s\n", strerror(watch.output_error));
    /* On the screen that has just gone, this stood last. */
    if (watch.draws && (!is_open || loop_is_lost(&watch.loop) || watch.loop.has_failed))
        (void)fprintf(stderr, "fathom: %s\n", watch.loss);
    if (!is_open) return STATUS_FAILED;
    loop_account(&watch.loop, &account);
    stats_print_short(&account, stderr);
    return loop_is_good(&watch.loop) && watch.output_error == 0 ? STATUS_OK : STATUS_FAILED;
}

static int watch_site(const host_t *host)
{
    static const fathom_loop_kind_t kind = {.fd = keys_fd, .poll = poll_keys};
    fathom_loop_source_t keys = {.kind = &kind};
    lanes_init(&watch.lanes, &watch.loop.site);
    if (!host->begin(host->ctx)) return STATUS_FAILED;
    watch.draws = terminal_can_draw();
    if (watch.draws) {
        host_watch_signal(SIGWINCH);
        terminal_open();
    }
    read_window();
    const bool is_open = loop_open(&watch.loop);
    if (is_open && terminal.has_input) fathom_loop_add(&watch.loop.sources, &keys);
    if (is_open) loop_run(&watch.loop);
    const int status = !watch.draws || terminal_close() ? finish(host, is_open) : STATUS_FAILED;
    loop_close(&watch.loop);
    return status;
}

static int start(const host_t *host, const arguments_t *arguments)
{
    static const sink_t sink = {on_reading, on_notice, tick};
    site_t *const site = &watch.loop.site;
    int status = STATUS_USAGE;
    memset(&watch, 0, sizeof watch);
    loop_init(&watch.loop, host, &sink, NULL);
    if (sensors_read(site, arguments, arguments->settings, arguments->count, false)) {
        for (size_t i = 0; i != site->sensor_count; i++)
            site->sensors[i]->settings.repeat_us = 250000; /* a column */
        status = watch_site(host);
    }
    loop_deinit(&watch.loop);
    free(watch.lanes.lane);
    return status;
}

const command_t watch_command = {
    .name = "watch",
    .summary = "Show the distances of sensors live in the terminal",
    .usage = "[NAME=]SENSOR[:ADDRESS][:MODE][@PORT]... [OPTIONS]",
    .tables = tables,
    .common = "port interval duration window reconnect",
    .examples = "  fathom watch a16 --port /dev/ttyUSB0\n"
                "  fathom watch a05:2:modbus hps167s:7 --port /dev/ttyUSB0 --interval 500\n"
                "  fathom watch hps167s --port /dev/ttyUSB0 --duration 60 > log.txt\n",
    .status = "Press q or Ctrl-C to end. 'fathom help picture' explains the picture.\n"
              "Exit status: 0 success, 1 an attempt or the port failed, 2 wrong usage.\n",
    .topics = "picture, sensors, ports, pins, values",
    .operands = OPERANDS_SENSORS,
    .settings_size = sizeof(sensor_settings_t),
    .start = start,
};
