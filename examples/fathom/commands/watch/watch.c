/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): fmemopen */
#include <errno.h>
#include <inttypes.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>

#include "cli/command.h"
#include "cli/rows.h"
#include "commands/commands.h"
#include "commands/watch/watch_terminal.h"
#include "ports/host.h"

#define SENSORS(member) offsetof(sensor_settings_t, member)
static const option_table_t tables[] = {
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

typedef struct {
    loop_t loop;
    picture_t picture;
    lanes_t lanes;
    int rows; /* of the window */
    int columns;
    uint64_t next_us;          /* when the next picture or line is due */
    char message[MESSAGE];     /* below the lanes */
    uint64_t message_end_us;   /* when it disappears */
    char loss[MESSAGE];        /* the last message about a port that was lost */
    fathom_status_t *reported; /* for lines: the last failure of each sensor that was printed */
    bool draws;                /* pictures, else lines */
    bool wants_all;   /* the next picture is drawn as a whole: others may have written to the terminal */
    int output_error; /* errno */
} watch_t;

/* Shows a message below the lanes; without a picture it is printed. */
static void show(watch_t *watch, const char *text, uint64_t for_us)
{
    (void)snprintf(watch->message, sizeof watch->message, "%s", text);
    watch->message_end_us = loop_time_us(&watch->loop) + for_us;
}

static void print(const watch_t *watch, const char *text)
{
    if (!watch->draws) (void)fprintf(stderr, "fathom: %s\n", text);
}

/* The advice of fathom read. */
static void get_advice(char text[MESSAGE], const reading_t *reading)
{
    /* The advice names the model and the address itself, but neither if the port fails. */
    const bool has_name = reading->sensor->has_own_name && reading->status != FATHOM_ERR_PORT;
    const int used = has_name ? snprintf(text, MESSAGE, "%s: ", reading->sensor->name) : 0;
    FILE *const to = fmemopen(text + used, (size_t)(MESSAGE - used), "w");
    if (to == NULL) return;
    advice_print(to, reading->evidence);
    (void)fclose(to);
    text[MESSAGE - 1] = '\0';
}

static void show_failure(watch_t *watch, const reading_t *reading)
{
    fathom_status_t *const reported = &watch->reported[reading->sensor->number];
    if (!reading->evidence->is_told) {
        char text[MESSAGE] = "";
        get_advice(text, reading);
        show(watch, text, MESSAGE_US);
        if (reading->status == FATHOM_ERR_PORT) (void)snprintf(watch->loss, sizeof watch->loss, "%s", text);
        if (*reported != reading->status) print(watch, text);
    }
    *reported = reading->status;
}

static void on_reading(void *ctx, const reading_t *reading)
{
    watch_t *const watch = ctx;
    const uint64_t now_us = loop_time_us(&watch->loop);
    lanes_pass(&watch->lanes, now_us);
    lanes_add(&watch->lanes, reading);
    if (reading->evidence != NULL) show_failure(watch, reading);
    if (reading->failure != NULL) return;
    if (watch->message_end_us > now_us + MESSAGE_US) watch->message_end_us = now_us + MESSAGE_US;
    watch->reported[reading->sensor->number] = FATHOM_OK;
}

/* A message that may ask for something stays until there are readings. */
static void on_notice(void *ctx, const notice_t *notice)
{
    watch_t *const watch = ctx;
    char line[MESSAGE];
    (void)snprintf(line, sizeof line, "%s%s%s", notice->sensor != NULL ? notice->sensor->name : "",
                   notice->sensor != NULL ? ": " : "", notice->text);
    show(watch, line, notice->kind == NOTICE_OPEN ? MESSAGE_US : UINT32_MAX);
    print(watch, line);
    if (notice->kind == NOTICE_REMARK) return;
    watch->wants_all = true;
    if (notice->kind != NOTICE_OPEN) (void)snprintf(watch->loss, sizeof watch->loss, "%s", line);
}

/* "/dev/ttyUSB0", or "ttyUSB0, ttyUSB1, ttyUSB2 and 3 more". */
static void name_ports(const site_t *site, char text[PORTS])
{
    enum { NAMED = 3 };
    size_t at = 0;
    size_t count = 0;
    if (site->line_count == 1) {
        (void)snprintf(text, PORTS, "%s", site->lines->settings.path);
        return;
    }
    for (const line_t *line = site->lines; line != NULL && count != NAMED && at < PORTS; line = line->next)
        at += (size_t)snprintf(text + at, PORTS - at, "%s%s", count++ != 0 ? ", " : "",
                               port_last_part(line->settings.path));
    if (site->line_count > NAMED && at < PORTS)
        (void)snprintf(text + at, PORTS - at, " and %zu more", site->line_count - NAMED);
}

static void draw(watch_t *watch, uint64_t now_us)
{
    const uint32_t seconds = (uint32_t)(now_us / 1000000u);
    char title[MESSAGE];
    char ports[PORTS];
    name_ports(&watch->loop.site, ports);
    (void)snprintf(title, sizeof title,
                   "fathom watch %s   %02" PRIu32 ":%02" PRIu32 ":%02" PRIu32 "   %sCtrl-C ends", ports,
                   seconds / 3600, seconds / 60 % 60, seconds % 60, terminal_has_keys() ? "q or " : "");
    picture_draw(&watch->picture, watch->rows, watch->columns, &watch->lanes, title,
                 now_us < watch->message_end_us ? watch->message : "");
    watch->output_error = terminal_show(&watch->picture, watch->wants_all);
    /* While a port is waited for, others may write to the terminal. */
    watch->wants_all = loop_is_lost(&watch->loop);
}

/* All lanes in one line. */
static void print_line(watch_t *watch, uint64_t now_us)
{
    const lanes_t *const lanes = &watch->lanes;
    errno = 0;
    (void)printf("%6" PRIu64 ".%" PRIu64 " s", now_us / 1000000u, now_us / 100000u % 10);
    for (int i = 0; i != lanes->count; i++) {
        const lane_t *const lane = &lanes->lane[i];
        const uint32_t rate = lane_rate_tenths(lanes, lane);
        char value[LANE_VALUE];
        (void)printf("  %s %s %" PRIu32 ".%" PRIu32 "/s", lane->name, lane_value(lane, value), rate / 10,
                     rate % 10);
        if (lane->lost != 0) (void)printf(" lost %" PRIu64 " of %" PRIu64, lane->lost, lane->outcomes);
    }
    (void)puts("");
    watch->output_error = output_flush();
}

static uint32_t tick(void *ctx)
{
    watch_t *const watch = ctx;
    const uint64_t now_us = loop_time_us(&watch->loop);
    const uint32_t every_us = watch->draws ? PICTURE_US : LINE_US;
    if (host_had_signal()) {
        terminal_size(&watch->rows, &watch->columns);
        watch->wants_all = true;
        watch->next_us = now_us;
    }
    if (terminal_wants_end()) loop_stop(&watch->loop);
    if (now_us < watch->next_us) return (uint32_t)(watch->next_us - now_us);
    lanes_pass(&watch->lanes, now_us);
    if (watch->draws)
        draw(watch, now_us);
    else
        print_line(watch, now_us);
    if (watch->output_error != 0) loop_stop(&watch->loop);
    watch->next_us += every_us;
    if (watch->next_us <= now_us) watch->next_us = now_us + every_us;
    return (uint32_t)(watch->next_us - now_us);
}

static int finish(watch_t *watch)
{
    const host_t *const host = watch->loop.host;
    account_t account;
    if (!terminal_close()) return STATUS_FAILED;
    if (watch->output_error == EINTR && host->has_ended(host->ctx)) watch->output_error = 0;
    if (watch->output_error == EPIPE || host->is_output_gone(host->ctx)) return STATUS_FAILED;
    if (watch->output_error != 0)
        (void)fprintf(stderr, "fathom: the picture cannot be written: %s\n", strerror(watch->output_error));
    /* On the screen that has just gone, this stood last. */
    if ((loop_is_lost(&watch->loop) || watch->loop.has_failed) && watch->draws)
        (void)fprintf(stderr, "fathom: %s\n", watch->loss);
    loop_account(&watch->loop, &account);
    stats_print_short(&account, stderr);
    return !loop_is_good(&watch->loop) || watch->output_error != 0 ? STATUS_FAILED : STATUS_OK;
}

static bool set_up(site_t *site, const arguments_t *arguments)
{
    if (!sensors_read(site, arguments, arguments->settings, arguments->count, false)) return false;
    for (size_t i = 0; i != site->sensor_count; i++)
        site->sensors[i]->settings.repeat_us = 250000; /* a column */
    return true;
}

static int watch_site(watch_t *watch)
{
    loop_t *const loop = &watch->loop;
    const host_t *const host = loop->host;
    int status = STATUS_FAILED;
    watch->reported = calloc(loop->site.sensor_count, sizeof *watch->reported);
    if (watch->reported == NULL || !lanes_init(&watch->lanes, &loop->site)) {
        (void)fprintf(stderr, "fathom: no memory left.\n");
        return STATUS_FAILED;
    }
    if (!host->begin(host->ctx)) return STATUS_FAILED;
    watch->draws = terminal_can_draw();
    if (watch->draws) {
        host_watch_signal(SIGWINCH);
        terminal_open();
    }
    terminal_size(&watch->rows, &watch->columns);
    if (loop_open(loop)) {
        if (watch->draws) terminal_add_keys(&loop->sources);
        loop_run(loop);
        status = finish(watch);
    } else if (terminal_close() && watch->draws) {
        (void)fprintf(stderr, "fathom: %s\n", watch->loss);
    }
    loop_close(loop);
    return status;
}

static int start(const host_t *host, const arguments_t *arguments)
{
    static const sink_t sink = {on_reading, on_notice, tick};
    watch_t *const watch = calloc(1, sizeof *watch);
    if (watch == NULL) {
        (void)fprintf(stderr, "fathom: no memory left.\n");
        return STATUS_FAILED;
    }
    loop_init(&watch->loop, host, &sink, watch);
    const int status = set_up(&watch->loop.site, arguments) ? watch_site(watch) : STATUS_USAGE;
    loop_deinit(&watch->loop);
    lanes_free(&watch->lanes);
    free(watch->reported);
    free(watch);
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
