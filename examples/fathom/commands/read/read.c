/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): fmemopen */
#include <errno.h>
#include <inttypes.h>
#include <string.h>

#include "cli/complete.h"
#include "commands/commands.h"
#include "commands/read/output.h"
#include "commands/read/read_options.h"
#include "diagnosis/status_word.h"
#include "reading/poll_loop.h"
#include "reading/results.h"

/* In place of an errno: the file has rows, and its header is another one. */
enum { OTHER_COLUMNS = -1 };

typedef struct {
    read_options_t *options;
    const format_t *format;
    poll_loop_t loop;
    results_t results;
    uint64_t stats_us; /* when all counters are told next */
    int output_error;  /* errno; or OTHER_COLUMNS */
    bool has_begun;    /* the output */
    bool is_alarmed;   /* a change was told after which an alarm is on */
} reading_run_t;

static void flush(reading_run_t *run)
{
    const int error = output_flush();
    if (error != 0) run->output_error = error;
}

/* Is it named in text? Not the only one, unless the user has named it. */
static bool has_name(const reading_run_t *run, const station_t *station)
{
    return run->loop.options.station_count > 1 || station->has_own_name;
}

/* Those of one sensor, and of all. */
static uint8_t own_columns(const reading_run_t *run, const station_t *station)
{
    const results_config_t *const results = &run->options->results;
    const uint8_t level = results->has_level ? COLUMNS_LEVEL : 0;
    const uint8_t row = COLUMNS_ROW | COLUMNS_DISTANCE | level;
    if (results->has_alarm) return COLUMNS_ALARM | row;
    const bool has_temperature =
        station->settings.temperature_us != 0 && (station->mode->takes & READER_TAKES_TEMPERATURE) != 0;
    return (uint8_t)(COLUMNS_READING | row | (station->model->has_optics ? COLUMNS_OPTICS : 0) |
                     (has_temperature ? COLUMNS_TEMPERATURE : 0));
}

static uint8_t all_columns(const reading_run_t *run)
{
    const sensor_options_t *const options = &run->loop.options;
    uint8_t columns = 0;
    for (size_t i = 0; i != options->station_count; i++) columns |= own_columns(run, options->stations[i]);
    return columns;
}

/* Has what is added to a header, and another one? Where it was emptied meanwhile, or --no-header was given, it has none. */
static bool has_other_columns(const reading_run_t *run)
{
    enum { HEADER = 512 };
    char header[HEADER] = "";
    FILE *const to = fmemopen(header, sizeof header, "w");
    if (to == NULL) return false;
    run->format->begin(to, all_columns(run));
    (void)fclose(to);
    return output_file_begins(&run->options->file, header, strcspn(header, ",") + 1) &&
           !output_file_begins(&run->options->file, header, strlen(header));
}

/* Before each row: what is to be written first. The alarms have some while the port is still waited for. */
static void begin_output(reading_run_t *run, uint64_t utc_us)
{
    const format_t *const format = run->format;
    const bool is_first = run->options->file.path == NULL && !run->has_begun;
    run->has_begun = true;
    errno = 0;
    const output_file_turn_t turn = output_file_turn(&run->options->file, utc_us);
    if (turn == OUTPUT_FILE_FAILED) run->output_error = errno;
    if (turn == OUTPUT_FILE_FAILED || format->begin == NULL || run->options->no_header) return;
    if (turn == OUTPUT_FILE_FILLED && has_other_columns(run)) run->output_error = OTHER_COLUMNS;
    if (turn != OUTPUT_FILE_EMPTY && !is_first) return;
    format->begin(stdout, all_columns(run));
    flush(run);
}

/* A row, handed over whole. */
static void write_row(reading_run_t *run, const station_t *station, const result_t *result,
                      const char *failure)
{
    const host_t *const host = run->loop.host;
    const uint64_t time_us = poll_loop_sample_us(&run->loop, &result->sample);
    const reading_t reading = {
        .model = station->model,
        .mode = station->mode,
        .reader = station->reader,
        .name = station->name,
        .label = has_name(run, station) ? station->name : station->model->name,
        .failure = failure,
        .result = result,
        .sample = &result->sample,
        .time_us = time_us,
        .utc_us = host->utc_us(host->ctx) - (poll_loop_time_us(&run->loop) - time_us),
        .own = own_columns(run, station),
        .columns = all_columns(run),
    };
    begin_output(run, reading.utc_us);
    if (run->output_error != 0) return;
    errno = 0;
    run->format->write(stdout, &reading);
    flush(run);
}

static bool write_result(void *ctx, const station_t *station, const result_t *result)
{
    reading_run_t *const run = ctx;
    write_row(run, station, result, NULL);
    if (result->is_on) run->is_alarmed = true;
    return run->output_error == 0;
}

/* probe: 0 where it is not one alone. Changes of an alarm are written by themselves. */
static void write_failure_row(reading_run_t *run, const station_t *station, size_t kind, uint8_t probe)
{
    char word[COUNTERS_MEMBER];
    const result_t result = {.sample = {.time_us = (uint32_t)run->loop.host->now_us(run->loop.host->ctx),
                                        .kind = FATHOM_UNKNOWN,
                                        .address = station->address,
                                        .probe = station->model->probes == 1 ? 1 : probe}};
    if (run->options->results.has_alarm || !run->format->has_failures) return;
    write_row(run, station, &result, status_word_of_failure(kind, word));
}

static bool take_sample(void *ctx, const station_t *station, const fathom_sample_t *sample)
{
    return results_sample(&((reading_run_t *)ctx)->results, station, sample);
}

static void tell_failure(const reading_run_t *run, const failure_t *failure, const station_t *station)
{
    const bool is_port = failure->status == FATHOM_ERR_PORT;
    const bool is_named = has_name(run, station) && !is_port;
    if (failure->is_told || (run->options->quiet && (!is_port || failure->waits))) return;
    (void)fprintf(stderr, "fathom: %s%sattempt %" PRIu64 ": ", is_named ? station->name : "",
                  is_named ? ": " : "", station->counters.attempts + 1);
    advice_print(stderr, failure);
    (void)fputs("\n", stderr);
}

static void take_failure(void *ctx, const failure_t *failure, const station_t *station)
{
    reading_run_t *const run = ctx;
    const fathom_status_t status = failure->status;
    const uint8_t probe = status == FATHOM_ERR_MALFORMED ? reader_facts(station->reader).refused_probe : 0;
    tell_failure(run, failure, station);
    write_failure_row(run, station, counters_failure_kind(status, station->reader), probe);
    results_failure(&run->results, station, status);
}

static void take_absence(void *ctx, const station_t *station)
{
    write_failure_row(ctx, station, (size_t)-FATHOM_ERR_PORT, 0);
}

static void write_remark(void *ctx, const station_t *station, const char *text)
{
    const reading_run_t *const run = ctx;
    if (!run->options->quiet) (void)fprintf(stderr, "fathom: %s: %s\n", station->name, text);
}

/* What ends the command is said by a quiet one too. */
static void write_port(void *ctx, const char *text, poll_port_state_t state)
{
    const reading_run_t *const run = ctx;
    if (state == POLL_PORT_GIVEN_UP || !run->options->quiet) (void)fprintf(stderr, "fathom: %s\n", text);
}

static void get_account(reading_run_t *run, account_t *account)
{
    poll_loop_account(&run->loop, account);
    account->has_median = run->options->results.median != 0;
    account->dropped_spikes = results_dropped(&run->results);
}

static void tell_stats(reading_run_t *run, const account_t *account)
{
    const bool is_json = run->format->is_json;
    if (is_json)
        counters_print_json(account, stderr);
    else
        counters_print_all(account, stderr);
    if (!is_json) results_print_dropped(&run->results, stderr);
    for (size_t i = 0; i != run->loop.options.station_count; i++) {
        station_t *const station = run->loop.options.stations[i];
        if ((station->mode->pins & MODEL_PIN_ECHO) == 0) continue;
        if (is_json)
            pulses_print_json(&station->pulses, station->name, stderr);
        else
            pulses_print(&station->pulses, station->name, stderr);
    }
}

/* Tells the counters when it is time for that. */
static uint32_t tick_stats(reading_run_t *run)
{
    const uint32_t every_us = run->options->stats_us;
    const uint64_t now_us = poll_loop_time_us(&run->loop);
    if (every_us == 0) return FATHOM_NO_DEADLINE;
    if (now_us >= run->stats_us) {
        account_t account;
        get_account(run, &account);
        tell_stats(run, &account);
        run->stats_us += every_us;
        if (run->stats_us < now_us) run->stats_us = now_us + every_us;
    }
    return (uint32_t)(run->stats_us - now_us);
}

static uint32_t tick(void *ctx)
{
    reading_run_t *const run = ctx;
    const uint32_t stats_us = tick_stats(run);
    const uint32_t results_us = results_tick(&run->results);
    return stats_us < results_us ? stats_us : results_us;
}

static bool is_ended_by_alarm(const reading_run_t *run)
{
    return run->options->until_alarm && run->is_alarmed;
}

static bool is_over(const void *ctx)
{
    const reading_run_t *const run = ctx;
    return run->output_error != 0 || is_ended_by_alarm(run);
}

static int finish(reading_run_t *run)
{
    const host_t *const host = run->loop.host;
    const char *const path = run->options->file.path;
    account_t account;
    /* A signal may have cut a write short: then ending was asked for, and is no failure. */
    if (run->output_error == EINTR && host->has_ended(host->ctx)) run->output_error = 0;
    /* The reader of a pipe has seen enough, as head does: no reason for words. */
    if (run->output_error == EPIPE || host->is_output_gone(host->ctx)) return STATUS_FAILED;
    if (run->output_error == OTHER_COLUMNS)
        (void)fprintf(stderr,
                      "fathom: %s has a header with other columns; choose another --output, or --no-header "
                      "adds the rows all the same\n",
                      run->options->file.name);
    else if (run->output_error != 0)
        (void)fprintf(stderr, "fathom: the readings cannot be written%s%s: %s\n", path != NULL ? " to " : "",
                      path != NULL ? path : "", strerror(run->output_error));
    get_account(run, &account);
    if (run->options->stats) tell_stats(run, &account);
    return !poll_loop_is_good(&run->loop) || run->output_error != 0 ? STATUS_FAILED : STATUS_OK;
}

/* What a program waits for comes before what has failed. */
static int exit_status(const reading_run_t *run, int status)
{
    return is_ended_by_alarm(run) ? STATUS_ALARM : status;
}

static bool set_up(reading_run_t *run, const arguments_t *arguments)
{
    const origin_t origin = {.command = arguments->command->name};
    read_options_t *const options = arguments->settings;
    sensor_options_t *const sensors = &run->loop.options;
    run->options = options;
    run->format = &read_formats[options->format];
    run->stats_us = options->stats_us;
    sensors->count = options->count;
    if (options->no_header && run->format->begin == NULL)
        return reject(&origin, "--no-header has no effect without --format csv.");
    return sensors_read(sensors, arguments, &options->sensors, arguments->count, options->quiet) &&
           results_finish(&options->results, options->sensors.reader.period_us, &origin);
}

static int start(const host_t *host, const arguments_t *arguments)
{
    static const poll_loop_user_t user = {take_sample, take_failure, take_absence, write_remark,
                                          write_port,  tick,         is_over};
    static reading_run_t run; /* too large for a small stack */
    poll_loop_t *const loop = &run.loop;
    run.output_error = 0;
    run.has_begun = run.is_alarmed = false;
    poll_loop_begin(loop, host, &user, &run);
    if (!set_up(&run, arguments)) return STATUS_USAGE;
    if (!host->begin(host->ctx)) return STATUS_FAILED;
    results_begin(&run.results, loop, write_result, &run);
    for (size_t i = 0; i != loop->options.station_count; i++)
        results_add(&run.results, loop->options.stations[i], &run.options->results);
    if (run.options->file.path != NULL) begin_output(&run, host->utc_us(host->ctx));
    if (run.output_error != 0) return finish(&run);
    int status = STATUS_FAILED;
    if (poll_loop_open(loop)) {
        begin_output(&run, host->utc_us(host->ctx));
        poll_loop_run(loop);
        status = finish(&run);
    }
    poll_loop_close(loop);
    return exit_status(&run, status);
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
    .topics = "sensors, ports, pins, values, output, level, alarm",
    .operands = operands_sensors,
    .settings_size = sizeof(read_options_t),
    .start = start,
};
