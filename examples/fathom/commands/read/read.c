/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): fmemopen */
#include <errno.h>
#include <inttypes.h>
#include <string.h>

#include "cli/command.h"
#include "commands/commands.h"
#include "commands/read/output.h"
#include "commands/read/read_options.h"
#include "reading/loop.h"

/* Instead of an errno: the file has rows of CSV, and a header with other columns or the command another format. */
enum { OTHER_COLUMNS = -1, OTHER_FORMAT = -2 };

typedef struct {
    read_options_t *options;
    const format_t *format;
    loop_t loop;
    uint64_t stats_us; /* when all counters are printed next */
    int output_error;  /* errno, OTHER_COLUMNS or OTHER_FORMAT */
    bool has_begun;    /* the output */
    bool has_alarm;    /* an alarm is on, and ends the command */
} run_t;

static void fail(run_t *run, int error)
{
    run->output_error = error;
    loop_stop(&run->loop);
}

static void flush(run_t *run)
{
    const int error = output_flush();
    if (error != 0) fail(run, error);
}

/* ---- rows ---- */

static unsigned columns_of_all(const run_t *run)
{
    const site_t *const site = &run->loop.site;
    unsigned columns = 0;
    for (size_t i = 0; i != site->sensor_count; i++) columns |= sensor_columns(site->sensors[i]);
    return columns;
}

/* Returns OTHER_COLUMNS or OTHER_FORMAT if the rows do not suit the header of the file, and otherwise 0. Without a
 * header (--no-header, or an emptied file) all rows suit. */
static int check_header(const run_t *run)
{
    enum { HEADER = 512 };
    char header[HEADER] = "";
    FILE *const to = fmemopen(header, sizeof header, "w");
    if (to == NULL) return 0;
    reading_csv_header(to, columns_of_all(run));
    (void)fclose(to);
    if (!output_file_begins(&run->options->file, header, strcspn(header, ",") + 1)) return 0;
    if (run->format->begin == NULL) return OTHER_FORMAT;
    return output_file_begins(&run->options->file, header, strlen(header)) ? 0 : OTHER_COLUMNS;
}

/* Before each row: opens the file of its day, and writes the header. */
static void begin_output(run_t *run, uint64_t utc_us)
{
    const format_t *const format = run->format;
    const bool is_first = run->options->file.path == NULL && !run->has_begun;
    run->has_begun = true;
    errno = 0;
    const output_file_turn_t turn = output_file_turn(&run->options->file, utc_us);
    if (turn == OUTPUT_FILE_FAILED) fail(run, errno);
    if (turn == OUTPUT_FILE_FAILED || run->options->no_header) return;
    const int refusal = turn == OUTPUT_FILE_FILLED ? check_header(run) : 0;
    if (refusal != 0) fail(run, refusal);
    if (format->begin == NULL || (turn != OUTPUT_FILE_EMPTY && !is_first)) return;
    format->begin(stdout, columns_of_all(run));
    flush(run);
}

/* The reader of a pipe gets whole rows. */
static void write_row(run_t *run, const reading_t *reading)
{
    begin_output(run, reading->utc_us);
    if (run->output_error != 0) return;
    errno = 0;
    run->format->write(stdout, reading, columns_of_all(run));
    flush(run);
}

/* ---- the sink ---- */

static void print_failure(const run_t *run, const reading_t *reading)
{
    const sensor_t *const sensor = reading->sensor;
    const bool is_port = reading->status == FATHOM_ERR_PORT;
    const bool is_named = sensor->is_named && !is_port;
    if (reading->evidence->is_told || (run->options->quiet && (!is_port || reading->evidence->waits))) return;
    (void)fprintf(stderr, "fathom: %s%sattempt %" PRIu64 ": ", is_named ? sensor->name : "",
                  is_named ? ": " : "", sensor->counters.attempts + 1);
    advice_print(stderr, reading->evidence);
    (void)fputs("\n", stderr);
}

static void on_reading(void *ctx, const reading_t *reading)
{
    run_t *const run = ctx;
    const bool has_row =
        reading->failure == NULL || (run->format->has_failures && !reading->sensor->processing.has_alarm);
    if (reading->evidence != NULL) print_failure(run, reading);
    if (run->output_error != 0 || run->has_alarm) return;
    if (has_row) write_row(run, reading);
    if (!reading->result->is_on || !run->options->until_alarm) return;
    run->has_alarm = true;
    loop_stop(&run->loop);
}

/* What ends the command is printed also with --quiet. */
static void on_notice(void *ctx, const notice_t *notice)
{
    const run_t *const run = ctx;
    if (run->options->quiet && notice->kind != NOTICE_GIVEN_UP) return;
    if (notice->sensor != NULL)
        (void)fprintf(stderr, "fathom: %s: %s\n", notice->sensor->name, notice->text);
    else
        (void)fprintf(stderr, "fathom: %s\n", notice->text);
}

static void print_stats(run_t *run)
{
    const bool is_json = run->format->is_json;
    const site_t *const site = &run->loop.site;
    account_t account;
    loop_account(&run->loop, &account);
    (is_json ? stats_print_json : stats_print)(&account, stderr);
    for (size_t i = 0; i != site->sensor_count && !is_json; i++)
        results_print_dropped(site->sensors[i], stderr);
    for (size_t i = 0; i != site->sensor_count; i++) {
        sensor_t *const sensor = site->sensors[i];
        if (sensor->mode->has_pulses)
            (is_json ? pulses_print_json : pulses_print)(&sensor->pulses, sensor->name, stderr);
    }
}

static uint32_t tick(void *ctx)
{
    run_t *const run = ctx;
    const uint32_t every_us = run->options->stats_us;
    const uint64_t now_us = loop_time_us(&run->loop);
    if (every_us == 0) return FATHOM_NO_DEADLINE;
    if (now_us >= run->stats_us) {
        print_stats(run);
        run->stats_us += every_us;
        if (run->stats_us < now_us) run->stats_us = now_us + every_us;
    }
    return (uint32_t)(run->stats_us - now_us);
}

/* ---- start and end ---- */

static void print_output_error(const run_t *run)
{
    const char *const path = run->options->file.path;
    if (run->output_error == OTHER_COLUMNS)
        (void)fprintf(
            stderr,
            "fathom: %s has a header with other columns. Choose another --output, or append the rows with "
            "--no-header.\n",
            run->options->file.name);
    else if (run->output_error == OTHER_FORMAT)
        (void)fprintf(stderr,
                      "fathom: %s has the header of a CSV file. Append to it with --format csv, or choose "
                      "another --output.\n",
                      run->options->file.name);
    else if (run->output_error != 0)
        (void)fprintf(stderr, "fathom: the readings cannot be written%s%s: %s\n", path != NULL ? " to " : "",
                      path != NULL ? path : "", strerror(run->output_error));
}

static int finish(run_t *run)
{
    const host_t *const host = run->loop.host;
    /* A signal that ends the command may have interrupted a write. */
    if (run->output_error == EINTR && host->has_ended(host->ctx)) run->output_error = 0;
    /* The reader of a pipe has seen enough, as head does: this needs no message. */
    if (run->output_error == EPIPE || host->is_output_gone(host->ctx)) return STATUS_FAILED;
    print_output_error(run);
    if (run->options->stats) print_stats(run);
    return !loop_is_good(&run->loop) || run->output_error != 0 ? STATUS_FAILED : STATUS_OK;
}

static int read_site(run_t *run)
{
    loop_t *const loop = &run->loop;
    const host_t *const host = loop->host;
    int status = STATUS_FAILED;
    if (!host->begin(host->ctx)) return STATUS_FAILED;
    run->stats_us = run->options->stats_us;
    if (run->options->file.path != NULL) begin_output(run, host->utc_us(host->ctx));
    if (run->output_error != 0) return finish(run);
    if (loop_open(loop)) {
        begin_output(run, host->utc_us(host->ctx));
        loop_run(loop);
        status = finish(run);
    }
    loop_close(loop);
    /* The alarm that a program waits for counts more than a failure. */
    return run->has_alarm ? STATUS_ALARM : status;
}

/* Returns the format that the ending of a file's name means, or text. */
static uint8_t format_of(const char *path)
{
    const char *const dot = path != NULL ? strrchr(path, '.') : NULL;
    if (dot == NULL) return FORMAT_TEXT;
    if (strcmp(dot, ".csv") == 0) return FORMAT_CSV;
    return strcmp(dot, ".json") == 0 || strcmp(dot, ".jsonl") == 0 ? FORMAT_JSON : FORMAT_TEXT;
}

static bool set_up(run_t *run, const arguments_t *arguments)
{
    const origin_t origin = {.command = arguments->command->name};
    read_options_t *const options = arguments->settings;
    site_t *const site = &run->loop.site;
    run->options = options;
    if (!arguments_have(arguments, "format")) options->format = format_of(options->file.path);
    run->format = &read_formats[options->format];
    site->count = options->count;
    if (options->no_header && run->format->begin == NULL)
        return reject(&origin, "--no-header has no effect without --format csv.");
    if (!sensors_read(site, arguments, &options->sensors, arguments->count, options->quiet) ||
        !results_finish(&options->results, options->sensors.reader.period_us, &origin))
        return false;
    for (size_t i = 0; i != site->sensor_count; i++)
        results_config_copy(&site->sensors[i]->processing, &options->results);
    return true;
}

static int start(const host_t *host, const arguments_t *arguments)
{
    static const sink_t sink = {on_reading, on_notice, tick};
    run_t run = {.output_error = 0};
    loop_init(&run.loop, host, &sink, &run);
    const int status = set_up(&run, arguments) ? read_site(&run) : STATUS_USAGE;
    loop_deinit(&run.loop);
    return status;
}

const command_t read_command = {
    .name = "read",
    .summary = "Read the distance from one or more sensors until interrupted",
    .usage = "[NAME=]SENSOR[:ADDRESS][:MODE][@PORT]... [OPTIONS]",
    .tables = read_tables,
    .common = "port count interval format output",
    .examples = "  fathom read a16 --port /dev/ttyUSB0\n"
                "  fathom read hps167s:7 -p /dev/ttyUSB0 --format csv --output log.csv\n"
                "  fathom read tank=a16@/dev/ttyUSB0 gate=hps167s:7@tcp:10.0.0.7\n",
    .status = "Exit status: 0 success, 1 an attempt or the port failed, 2 wrong usage, 3 alarm.\n",
    .topics = "sensors, ports, pins, values, output, level, alarm, log",
    .operands = OPERANDS_SENSORS,
    .settings_size = sizeof(read_options_t),
    .start = start,
};
