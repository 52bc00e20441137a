/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): open_memstream, dup2 */
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/command.h"
#include "cli/rows.h"
#include "commands/commands.h"
#include "reading/fields.h"

/* ---- options ---- */

enum { MOST_PATH = 512 };

/* In the order of the words of --format. */
enum { FORMAT_TEXT, FORMAT_JSON, FORMAT_CSV };

typedef struct {
    sensor_settings_t sensors;
    results_config_t results;
    const char *path;  /* of the output; NULL: the standard output */
    uint32_t count;    /* attempts of each sensor; 0: endless */
    uint32_t stats_us; /* from one print of all counters to the next; 0: at the end only */
    uint8_t format;    /* FORMAT_... */
    bool is_by_day;    /* "log.csv" is "log-2026-11-23.csv" */
    bool stats;        /* print all counters */
    bool until_alarm;  /* stop when an alarm is on */
    bool quiet;        /* print only fatal errors and counters */
    bool no_header;    /* of csv */
} read_options_t;

static bool parse_path(const char *text, void *member)
{
    *(const char **)member = text;
    return text[0] != '\0' && strlen(text) <= MOST_PATH;
}

static const option_t rows[] = {
    {"count", "N", "Stop after N attempts per sensor", KIND_NUMBER, GROUP_OUTPUT, .min = 1, .max = 1000000000,
     AT(read_options_t, count)},
    {"format", "FORMAT", "Print text, json or csv (default: the ending of FILE, or text)", KIND_CHOICE,
     GROUP_OUTPUT, .words = "text json csv", AT(read_options_t, format)},
    {"output", "FILE", "Append to FILE instead of standard output", KIND_CUSTOM, GROUP_OUTPUT,
     .takes = "the name of a file", .parse = parse_path, .is_path = true, AT(read_options_t, path)},
    {"rotate", "day", "Start a new FILE-YYYY-MM-DD every day (UTC)", KIND_CHOICE, GROUP_OUTPUT,
     .words = "day", .min = 1, AT(read_options_t, is_by_day), .needs = "output"},
    {"no-header", .help = "Omit the header line of csv", .group = GROUP_OUTPUT,
     AT(read_options_t, no_header)},
    {"stats", "[S]", "Print the counters at the end, or every S seconds", KIND_NUMBER, GROUP_OUTPUT, .min = 1,
     .max = 4000, .scale = 1000000, .otherwise = "", AT(read_options_t, stats_us),
     HAS(read_options_t, stats)},
    {"quiet", .help = "Suppress messages except fatal errors and --stats", .group = GROUP_OUTPUT,
     AT(read_options_t, quiet)},
    {"until-alarm", .help = "Stop with status 3 when an alarm is on", .group = GROUP_PROCESSING,
     AT(read_options_t, until_alarm), .needs = "alarm"},
    {.name = NULL},
};

#define SENSORS(member) offsetof(read_options_t, sensors.member)
static const option_table_t tables[] = {
    {word_rows, SENSORS(defaults)},
    {interval_rows, SENSORS(reader)},
    {request_rows, SENSORS(reader)},
    {reading_rows, SENSORS(reader)},
    {port_rows, SENSORS(defaults)},
    {reconnect_rows, SENSORS(run)},
    {rows, 0},
    {result_rows, offsetof(read_options_t, results)},
    {NULL, 0},
};

/* ---- text, for people ---- */

/* Prints the status of a reading that has no distance, and why a pulse or a value is none. */
static void print_status(const reading_t *reading)
{
    const fathom_sample_t *const sample = &reading->result->sample;
    const model_mode_t *const mode = reading->sensor->mode;
    const bool has_meanings = (mode->takes & READER_TAKES_MEANINGS) != 0;
    (void)printf("%s%s", reading_status(reading), sample->interference ? " (interference)" : "");
    if (sample->kind == FATHOM_UNKNOWN && mode->has_pulses)
        (void)printf(": all pulses are too short for the sensor; the longest has %" PRIu32 " us",
                     sample->raw);
    else if (sample->kind == FATHOM_UNKNOWN)
        (void)printf(": the value %" PRIu32 "%s", sample->raw,
                     has_meanings ? " has no known meaning (--means)" : "");
    else if (sample->kind == FATHOM_FAULT && !mode->has_pulses)
        (void)printf(": the sensor reports a fault");
    else if (sample->kind == FATHOM_FAULT && sample->raw == 0)
        (void)printf(": the line stays high; check the wire of echo");
    else if (sample->kind == FATHOM_FAULT)
        (void)printf(": a pulse of %" PRIu32 " us is too long for the sensor", sample->raw);
}

static void print_change(const reading_t *reading)
{
    const result_t *const result = reading->result;
    (void)printf(": alarm %s", alarm_word(result->alarm));
    if (result->alarm != FATHOM_ALARM_ON && result->alarm != FATHOM_ALARM_OFF) {
        (void)printf(" (%s)", result->is_on ? "on" : "off");
        return;
    }
    (void)printf(", ");
    if (result->sample.kind == FATHOM_TARGET)
        (void)printf("%u mm", result->sample.distance_mm);
    else
        print_status(reading);
}

static void print_sample(const reading_t *reading)
{
    const fathom_sample_t *const sample = &reading->result->sample;
    const reader_facts_t facts = reader_facts(reading->sensor->reader);
    const unsigned mm = sample->distance_mm;
    (void)printf("  ");
    if (sample->kind == FATHOM_TARGET)
        (void)printf("%6u mm  %3u.%03u m", mm, mm / 1000, mm % 1000);
    else
        print_status(reading);
    if (reading->sensor->model->has_optics && sample->kind != FATHOM_FAULT)
        (void)printf("  magnitude %" PRIu32 ".%04" PRIu32 "  ambient %u  precision %u",
                     sample->magnitude / 10000, sample->magnitude % 10000, sample->ambient,
                     sample->precision);
    if (facts.has_temperature) (void)printf("  %.1f degC", facts.temperature_dc / 10.0);
}

static void print_text(const reading_t *reading)
{
    const sensor_t *const sensor = reading->sensor;
    const result_t *const result = reading->result;
    (void)printf("%6" PRIu64 ".%03" PRIu64 " s  %s", reading->time_us / 1000000,
                 reading->time_us / 1000 % 1000, sensor->is_named ? sensor->name : sensor->model->name);
    if (sensor->model->probes > 1 && reading_has_probe(reading))
        (void)printf(" probe %u", result->sample.probe);
    if (result->alarm != 0)
        print_change(reading);
    else
        print_sample(reading);
    if (result->has_level)
        (void)printf("  level %" PRId32 " mm  %u per mille  volume %" PRIu32, result->level.level_mm,
                     result->level.per_mille, result->level.volume);
    (void)printf("\n");
}

/* ---- a run, and its output ---- */

typedef struct {
    read_options_t *options;
    loop_t loop;
    uint64_t stats_us;        /* when all counters are printed next */
    unsigned columns;         /* of the csv */
    bool has_begun;           /* the output */
    char name[2 * MOST_PATH]; /* of the open file */
    uint64_t day;             /* of the open file, if there is one for each day */
    int output_error;         /* errno, or UNSUITED */
    const char *unsuited;     /* why the rows do not suit the open file */
    bool has_alarm;           /* an alarm is on, and ends the command */
} run_t;
enum { UNSUITED = -1 };

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

/* The day stands before the last dot of the name, or at its end. */
static void name_file(run_t *run, uint64_t utc_us)
{
    enum { DAY = 10 }; /* "2026-11-23" of what utc_text makes */
    const char *const path = run->options->path;
    const char *const base = last_part(path);
    const char *const dot = strrchr(base, '.');
    const int stem = (int)(dot != NULL && dot != base ? (size_t)(dot - path) : strlen(path));
    char utc[UTC_TEXT] = "";
    if (run->options->is_by_day) (void)utc_text(utc_us, utc);
    (void)snprintf(run->name, sizeof run->name, "%.*s%s%.*s%s", stem, path, utc[0] != '\0' ? "-" : "",
                   (int)DAY, utc, path + stem);
}

/* Puts the file in the place of the standard output. Returns its length, 0 for a pipe, or -1 with errno. */
static off_t open_file(const char *name)
{
    const int fd = open(name, O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0666);
    if (fd < 0) return -1;
    const off_t length = lseek(fd, 0, SEEK_END);
    const bool is_done = dup2(fd, STDOUT_FILENO) == STDOUT_FILENO;
    const int error = errno;
    (void)close(fd);
    errno = error;
    if (!is_done) return -1;
    return length < 0 ? 0 : length;
}

/* Without a header (--no-header, or an emptied file) all rows suit. */
static void check_header(run_t *run)
{
    char *header = NULL;
    char *line = NULL;
    size_t size = 0;
    size_t capacity = 0;
    FILE *const to = open_memstream(&header, &size);
    FILE *const from = fopen(run->name, "r");
    if (to != NULL) {
        reading_csv_header(to, run->columns);
        (void)fclose(to);
    }
    if (header != NULL && from != NULL && getline(&line, &capacity, from) > 0 &&
        strncmp(line, header, strcspn(header, ",") + 1) == 0) {
        if (run->options->format != FORMAT_CSV)
            run->unsuited =
                "has the header of a CSV file. Append to it with --format csv, or choose another --output.";
        else if (strcmp(line, header) != 0)
            run->unsuited =
                "has a header with other columns. Choose another --output, or append the rows with "
                "--no-header.";
    }
    if (run->unsuited != NULL) fail(run, UNSUITED);
    if (from != NULL) (void)fclose(from);
    free(header);
    free(line);
}

/* Opens the file of this day if it is not open, and writes the header. */
static void begin_output(run_t *run, uint64_t utc_us)
{
    const read_options_t *const options = run->options;
    const uint64_t day = options->is_by_day ? utc_us / (24 * 3600 * UINT64_C(1000000)) : 0;
    off_t length = 0;
    if (run->has_begun && run->day == day) return;
    run->has_begun = true;
    run->day = day;
    errno = 0;
    if (options->path != NULL) {
        name_file(run, utc_us);
        length = open_file(run->name);
        if (length < 0) fail(run, errno);
    }
    if (length < 0 || options->no_header) return;
    if (length != 0) check_header(run);
    if (options->format != FORMAT_CSV || length != 0) return;
    reading_csv_header(stdout, run->columns);
    flush(run);
}

/* The reader of a pipe gets whole rows. */
static void write_row(run_t *run, const reading_t *reading)
{
    begin_output(run, reading->utc_us);
    if (run->output_error != 0) return;
    errno = 0;
    if (run->options->format == FORMAT_CSV)
        reading_csv(stdout, reading, run->columns);
    else if (run->options->format == FORMAT_JSON)
        reading_json_line(stdout, reading);
    else
        print_text(reading);
    flush(run);
}

/* ---- the sink ---- */

static void print_failure(const run_t *run, const reading_t *reading)
{
    sensor_t *const sensor = reading->sensor;
    const bool is_port = reading->status == FATHOM_ERR_PORT;
    const bool is_named = sensor->is_named && !is_port;
    if (reading->evidence->is_told || (run->options->quiet && (!is_port || reading->evidence->waits))) return;
    (void)fprintf(stderr, "fathom: %s%sattempt %" PRIu64 ": ", is_named ? sensor->name : "",
                  is_named ? ": " : "", sensor->counters.attempts + 1);
    advice_print_new(stderr, reading->evidence, &sensor->reported);
    (void)fputs("\n", stderr);
}

/* json and csv have a row for each attempt, also for one that has failed. */
static void on_reading(void *ctx, const reading_t *reading)
{
    run_t *const run = ctx;
    const bool has_failures = run->options->format != FORMAT_TEXT && !reading->sensor->processing.has_alarm;
    if (reading->evidence != NULL) print_failure(run, reading);
    if (run->output_error != 0 || run->has_alarm) return;
    if (reading->failure == NULL || has_failures) write_row(run, reading);
    if (!reading->result->is_on || !run->options->until_alarm) return;
    run->has_alarm = true;
    loop_stop(&run->loop);
}

/* What ends the command is printed also with --quiet. */
static void on_notice(void *ctx, const notice_t *notice)
{
    const run_t *const run = ctx;
    if (!run->options->quiet || notice->kind == NOTICE_GIVEN_UP) notice_print(ctx, notice);
}

static void print_stats(run_t *run)
{
    account_t account;
    loop_account(&run->loop, &account);
    if (run->options->format == FORMAT_JSON)
        stats_print_json(&account, stderr);
    else
        stats_print(&account, stderr);
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

static int finish(run_t *run)
{
    const host_t *const host = run->loop.host;
    const char *const path = run->options->path;
    /* A signal that ends the command may have interrupted a write. */
    if (run->output_error == EINTR && host->has_ended(host->ctx)) run->output_error = 0;
    /* The reader of a pipe has seen enough, as head does: this needs no message. */
    if (run->output_error == EPIPE || host->is_output_gone(host->ctx)) return STATUS_FAILED;
    if (run->output_error == UNSUITED)
        (void)fprintf(stderr, "fathom: %s %s\n", run->name, run->unsuited);
    else if (run->output_error != 0)
        (void)fprintf(stderr, "fathom: the readings cannot be written%s%s: %s\n", path != NULL ? " to " : "",
                      path != NULL ? path : "", strerror(run->output_error));
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
    if (run->options->path != NULL) begin_output(run, host->utc_us(host->ctx));
    if (run->output_error != 0) return finish(run);
    if (loop_open(loop)) {
        begin_output(run, host->utc_us(host->ctx));
        if (run->options->format != FORMAT_TEXT) loop_check_clock(loop);
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
    read_options_t *const options = run->options;
    site_t *const site = &run->loop.site;
    if (!arguments_have(arguments, "format")) options->format = format_of(options->path);
    site->count = options->count;
    if (options->no_header && options->format != FORMAT_CSV)
        return reject(&origin, "--no-header has no effect without --format csv.");
    if (!sensors_read(site, arguments, &options->sensors, arguments->count, options->quiet) ||
        !results_finish(&options->results, options->sensors.reader.period_us, &origin))
        return false;
    for (size_t i = 0; i != site->sensor_count; i++) {
        results_config_copy(&site->sensors[i]->processing, &options->results);
        run->columns |= sensor_columns(site->sensors[i]);
    }
    return true;
}

static int start(const host_t *host, const arguments_t *arguments)
{
    static const sink_t sink = {on_reading, on_notice, tick};
    run_t run = {.options = arguments->settings};
    loop_init(&run.loop, host, &sink, &run);
    const int status = set_up(&run, arguments) ? read_site(&run) : STATUS_USAGE;
    loop_deinit(&run.loop);
    return status;
}

const command_t read_command = {
    .name = "read",
    .summary = "Read the distance from one or more sensors until interrupted",
    .usage = "[NAME=]SENSOR[:ADDRESS][:MODE][@PORT]... [OPTIONS]",
    .tables = tables,
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
