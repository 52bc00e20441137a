/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): fmemopen */
#include <errno.h>
#include <inttypes.h>
#include <signal.h>
#include <string.h>

#include "cli/complete.h"
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
    poll_loop_t loop;
    picture_t picture;
    uint16_t rows; /* of the window */
    uint16_t columns;
    uint64_t next_us;      /* when the next picture or line is due */
    char message[MESSAGE]; /* the last failure, or what has happened to the port */
    uint64_t message_end_us;
    char loss[MESSAGE];                      /* what was said of a port that was lost last */
    fathom_status_t reported[STATION_SLOTS]; /* for lines: what was printed of each sensor's last failure */
    bool draws;                              /* pictures, else lines */
    bool wants_all;   /* of the next picture, because something else may have written to the terminal */
    int output_error; /* errno */
    lanes_t lanes;    /* last: only those of them that are used are ever touched */
} watch_t;

static void say(watch_t *watch, const char *text, uint64_t for_us)
{
    (void)snprintf(watch->message, sizeof watch->message, "%s", text);
    watch->message_end_us = poll_loop_time_us(&watch->loop) + for_us;
}

static bool take_reading(void *ctx, const station_t *station, const fathom_sample_t *sample)
{
    watch_t *const watch = ctx;
    lanes_pass(&watch->lanes, poll_loop_time_us(&watch->loop));
    lanes_reading(&watch->lanes, station, sample);
    const uint64_t end_us = poll_loop_time_us(&watch->loop) + MESSAGE_US;
    if (watch->message_end_us > end_us) watch->message_end_us = end_us;
    watch->reported[station->slot] = FATHOM_OK;
    return true;
}

/* What to try, as fathom read has it. */
static void get_advice(char text[MESSAGE], const failure_t *failure, const station_t *station)
{
    const int start = failure->status != FATHOM_ERR_PORT ? snprintf(text, MESSAGE, "%s: ", station->name) : 0;
    FILE *const to = fmemopen(text + start, (size_t)(MESSAGE - start), "w");
    if (to == NULL) return;
    advice_print(to, failure);
    (void)fclose(to);
    text[MESSAGE - 1] = '\0';
}

static void take_failure(void *ctx, const failure_t *failure, const station_t *station)
{
    watch_t *const watch = ctx;
    fathom_status_t *const reported = &watch->reported[station->slot];
    char text[MESSAGE] = "";
    lanes_pass(&watch->lanes, poll_loop_time_us(&watch->loop));
    lanes_failure(&watch->lanes, failure, station);
    get_advice(text, failure, station);
    if (!failure->is_told) say(watch, text, MESSAGE_US);
    if (failure->status == FATHOM_ERR_PORT && !failure->is_told)
        (void)snprintf(watch->loss, sizeof watch->loss, "%s", text);
    if (!watch->draws && !failure->is_told && *reported != failure->status)
        (void)fprintf(stderr, "fathom: %s\n", text);
    *reported = failure->status;
}

static void take_absence(void *ctx, const station_t *station)
{
    watch_t *const watch = ctx;
    lanes_pass(&watch->lanes, poll_loop_time_us(&watch->loop));
    lanes_away(&watch->lanes, station);
}

/* It stays until there are readings: it may be something to do. */
static void take_remark(void *ctx, const station_t *station, const char *text)
{
    watch_t *const watch = ctx;
    char line[MESSAGE];
    (void)snprintf(line, sizeof line, "%s: %s", station->name, text);
    say(watch, line, UINT32_MAX);
    if (!watch->draws) (void)fprintf(stderr, "fathom: %s\n", line);
}

static void take_port(void *ctx, const char *text, poll_port_state_t state)
{
    watch_t *const watch = ctx;
    say(watch, text, state == POLL_PORT_THERE ? MESSAGE_US : UINT32_MAX);
    watch->wants_all = true;
    if (state != POLL_PORT_THERE) (void)snprintf(watch->loss, sizeof watch->loss, "%s", text);
    if (!watch->draws) (void)fprintf(stderr, "fathom: %s\n", text);
}

/* "/dev/ttyUSB0", or "ttyUSB0, ttyUSB1, ttyUSB2 and 3 more". */
static void name_ports(const sensor_options_t *options, char text[PORTS])
{
    enum { NAMED = 3 };
    const size_t count = options->port_count;
    size_t at = 0;
    if (count == 1) {
        (void)snprintf(text, PORTS, "%s", options->ports[0].path);
        return;
    }
    for (size_t i = 0; i != count && i != NAMED && at < PORTS; i++)
        at += (size_t)snprintf(text + at, PORTS - at, "%s%s", i != 0 ? ", " : "",
                               port_last_part(options->ports[i].path));
    if (count > NAMED && at < PORTS) (void)snprintf(text + at, PORTS - at, " and %zu more", count - NAMED);
}

static void draw(watch_t *watch, uint64_t now_us)
{
    const uint32_t seconds = (uint32_t)(now_us / 1000000u);
    char title[MESSAGE];
    char ports[PORTS];
    name_ports(&watch->loop.options, ports);
    (void)snprintf(title, sizeof title,
                   "fathom watch %s   %02" PRIu32 ":%02" PRIu32 ":%02" PRIu32 "   %sCtrl-C ends", ports,
                   seconds / 3600, seconds / 60 % 60, seconds % 60, terminal_has_keys() ? "q or " : "");
    picture_draw(&watch->picture, watch->rows, watch->columns, &watch->lanes, title,
                 now_us < watch->message_end_us ? watch->message : "");
    watch->output_error = terminal_show(&watch->picture, watch->wants_all);
    /* While a port is waited for, others may write to the terminal. */
    watch->wants_all = poll_loop_is_lost(&watch->loop);
}

/* All lanes in one line. */
static void print_line(watch_t *watch, uint64_t now_us)
{
    const lanes_t *const lanes = &watch->lanes;
    errno = 0;
    (void)printf("%6" PRIu64 ".%" PRIu64 " s", now_us / 1000000u, now_us / 100000u % 10);
    for (size_t i = 0; i != lanes->count; i++) {
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
    const uint64_t now_us = poll_loop_time_us(&watch->loop);
    const uint32_t every_us = watch->draws ? PICTURE_US : LINE_US;
    if (host_had_signal()) {
        terminal_size(&watch->rows, &watch->columns);
        watch->wants_all = true;
        watch->next_us = now_us;
    }
    if (now_us < watch->next_us) return (uint32_t)(watch->next_us - now_us);
    lanes_pass(&watch->lanes, now_us);
    if (watch->draws)
        draw(watch, now_us);
    else
        print_line(watch, now_us);
    watch->next_us += every_us;
    if (watch->next_us <= now_us) watch->next_us = now_us + every_us;
    return (uint32_t)(watch->next_us - now_us);
}

static bool is_over(const void *ctx)
{
    return ((const watch_t *)ctx)->output_error != 0 || terminal_wants_end();
}

static int finish(watch_t *watch)
{
    const host_t *const host = watch->loop.host;
    account_t account;
    if (!terminal_give_back()) return STATUS_FAILED;
    if (watch->output_error == EINTR && host->has_ended(host->ctx)) watch->output_error = 0;
    if (watch->output_error == EPIPE || host->is_output_gone(host->ctx)) return STATUS_FAILED;
    if (watch->output_error != 0)
        (void)fprintf(stderr, "fathom: the picture cannot be written: %s\n", strerror(watch->output_error));
    /* On the screen that has just gone, this stood last. */
    if ((poll_loop_is_lost(&watch->loop) || watch->loop.has_failed) && watch->draws)
        (void)fprintf(stderr, "fathom: %s\n", watch->loss);
    poll_loop_account(&watch->loop, &account);
    counters_print(&account, stderr);
    return !poll_loop_is_good(&watch->loop) || watch->output_error != 0 ? STATUS_FAILED : STATUS_OK;
}

static bool set_up(sensor_options_t *options, const arguments_t *arguments)
{
    if (!sensors_read(options, arguments, arguments->settings, arguments->count, false)) return false;
    for (size_t i = 0; i != options->station_count; i++)
        options->stations[i]->settings.repeat_us = 250000; /* a column */
    return true;
}

static int start(const host_t *host, const arguments_t *arguments)
{
    static const poll_loop_user_t user = {take_reading, take_failure, take_absence, take_remark,
                                          take_port,    tick,         is_over};
    static watch_t watch; /* too large for any stack */
    poll_loop_t *const loop = &watch.loop;
    memset(&watch, 0, offsetof(watch_t, lanes));
    poll_loop_begin(loop, host, &user, &watch);
    if (!set_up(&loop->options, arguments)) return STATUS_USAGE;
    if (!host->begin(host->ctx)) return STATUS_FAILED;
    lanes_begin(&watch.lanes, &loop->options);
    watch.draws = terminal_can_draw();
    if (watch.draws) {
        host_watch_signal(SIGWINCH);
        terminal_take();
    }
    terminal_size(&watch.rows, &watch.columns);
    int status = STATUS_FAILED;
    if (poll_loop_open(loop)) {
        if (watch.draws) terminal_attend(&loop->sources);
        poll_loop_run(loop);
        status = finish(&watch);
    } else {
        if (terminal_give_back() && watch.draws) (void)fprintf(stderr, "fathom: %s\n", watch.loss);
    }
    poll_loop_close(loop);
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
    .operands = operands_sensors,
    .settings_size = sizeof(sensor_settings_t),
    .start = start,
};
