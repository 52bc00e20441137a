/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <inttypes.h>
#include <string.h>

#include "commands.h"
#include "read/read_options.h"
#include "stations/poll_loop.h"

typedef struct {
    read_options_t options;
    poll_loop_t loop;
    uint64_t stats_us; /* when all counters are told next */
    int output_error;  /* errno */
} reading_run_t;

static void flush(reading_run_t *run)
{
    const int error = output_flush();
    if (error != 0) run->output_error = error;
}

static bool is_shared(const reading_run_t *run) { return run->loop.options.station_count > 1; }

/* Those of one sensor, and of all. */
static uint8_t own_columns(const reading_run_t *run, const station_t *station)
{
    const bool has_temperature = run->loop.options.reading.temperature_us != 0 &&
                                 (station->mode->takes & READER_TAKES_TEMPERATURE) != 0;
    return (uint8_t)((station->model->has_optics ? COLUMNS_OPTICS : 0) |
                     (has_temperature ? COLUMNS_TEMPERATURE : 0));
}

static uint8_t all_columns(const reading_run_t *run)
{
    const sensor_options_t *const options = &run->loop.options;
    uint8_t columns = 0;
    for (size_t i = 0; i != options->station_count; i++) columns |= own_columns(run, &options->stations[i]);
    return columns;
}

static bool write_reading(void *ctx, const station_t *station, const fathom_sample_t *sample)
{
    reading_run_t *const run = ctx;
    const host_t *const host = run->loop.host;
    const uint64_t time_us = poll_loop_sample_us(&run->loop, sample);
    const reading_t reading = {
        .model = station->model,
        .mode = station->mode,
        .reader = &station->reader,
        .name = is_shared(run) ? station->name : station->model->name,
        .sample = sample,
        .time_us = time_us,
        .utc_us = host->utc_us(host->ctx) - (poll_loop_time_us(&run->loop) - time_us),
        .own = own_columns(run, station),
        .columns = all_columns(run),
    };
    errno = 0;
    run->options.format->write(stdout, &reading);
    flush(run);
    return run->output_error == 0;
}

static void write_failure(void *ctx, const failure_t *failure, const station_t *station)
{
    const bool has_name = is_shared(ctx) && failure->status != FATHOM_ERR_PORT;
    (void)fprintf(stderr, "fathom: %s%sattempt %" PRIu64 ": ", has_name ? station->name : "",
                  has_name ? ": " : "", station->counters.attempts + 1);
    advice_print(stderr, failure);
    (void)fputs("\n", stderr);
}

static void write_remark(void *ctx, const station_t *station, const char *text)
{
    (void)ctx;
    (void)fprintf(stderr, "fathom: %s: %s\n", station->name, text);
}

static void write_port(void *ctx, const char *text, bool is_there)
{
    (void)ctx;
    (void)is_there;
    (void)fprintf(stderr, "fathom: %s\n", text);
}

static void tell_stats(const reading_run_t *run, const account_t *account)
{
    if (run->options.format->is_json)
        counters_print_json(account, stderr);
    else
        counters_print_all(account, stderr);
}

/* Tells the counters when it is time for that. */
static uint32_t tick(void *ctx)
{
    reading_run_t *const run = ctx;
    const uint32_t every_us = run->options.stats_us;
    const uint64_t now_us = poll_loop_time_us(&run->loop);
    if (every_us == 0) return FATHOM_NO_DEADLINE;
    if (now_us >= run->stats_us) {
        account_t account;
        poll_loop_account(&run->loop, &account);
        tell_stats(run, &account);
        run->stats_us += every_us;
        if (run->stats_us < now_us) run->stats_us = now_us + every_us;
    }
    return (uint32_t)(run->stats_us - now_us);
}

static bool is_over(const void *ctx) { return ((const reading_run_t *)ctx)->output_error != 0; }

static int finish(reading_run_t *run)
{
    const host_t *const host = run->loop.host;
    account_t account;
    /* A signal may have cut a write short: then ending was asked for, and is no failure. */
    if (run->output_error == EINTR && host->has_ended(host->ctx)) run->output_error = 0;
    /* The reader of a pipe has seen enough, as head does: no reason for words. */
    if (run->output_error == EPIPE || host->is_output_gone(host->ctx)) return STATUS_FAILED;
    if (run->output_error != 0)
        (void)fprintf(stderr, "fathom: the readings cannot be written: %s\n", strerror(run->output_error));
    poll_loop_account(&run->loop, &account);
    if (!run->options.stats || run->options.format->is_json) counters_print(&account, stderr);
    if (run->options.stats) tell_stats(run, &account);
    return !poll_loop_is_good(&run->loop) || run->output_error != 0 ? STATUS_FAILED : STATUS_OK;
}

static int run_read(const host_t *host, int argc, char **argv)
{
    static const poll_loop_user_t user = {write_reading, write_failure, write_remark,
                                          write_port,    tick,          is_over};
    static reading_run_t run; /* too large for a small stack */
    poll_loop_t *const loop = &run.loop;
    run.output_error = 0;
    poll_loop_begin(loop, host, &user, &run);
    if (!read_options(&run.options, &loop->options, argc, argv)) return STATUS_USAGE;
    if (run.options.wants_help) return command_help(&read_command);
    if (!host->begin(host->ctx)) return STATUS_FAILED;
    run.stats_us = run.options.stats_us;
    if (!poll_loop_open(loop)) return loop->is_lost ? finish(&run) : STATUS_FAILED;
    errno = 0;
    if (run.options.format->begin != NULL) run.options.format->begin(stdout, all_columns(&run));
    flush(&run);
    const int status = poll_loop_run(loop) ? finish(&run) : STATUS_FAILED;
    poll_loop_close(loop);
    return status;
}

const command_t read_command = {"read", "reads sensors on a serial port", read_help, run_read};
