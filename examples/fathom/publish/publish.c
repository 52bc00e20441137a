/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "commands.h"
#include "publish/explain.h"
#include "publish/publisher.h"
#include "shared/options.h"
#include "stations/poll_loop.h"
#include "stations/status_word.h"

static const char command[] = "publish";

enum { CHECK, HELP, OPTIONS };

static const struct option table[OPTIONS + 1] = {
    [CHECK] = {"check", no_argument, NULL, 256},
    [HELP] = {"help", no_argument, NULL, 256},
};

typedef struct {
    config_t config;
    config_results_t results_configs;
    results_t results;
    poll_loop_t loop;
    publisher_t publisher;
} publish_t;

static bool take_sample(void *ctx, const station_t *station, const fathom_sample_t *sample)
{
    return results_sample(&((publish_t *)ctx)->results, station, sample);
}

static bool take_result(void *ctx, const station_t *station, const result_t *result)
{
    publish_t *const publish = ctx;
    const poll_loop_t *const loop = &publish->loop;
    publisher_result(&publish->publisher, station, result,
                     loop->start_us + poll_loop_sample_us(loop, &result->sample));
    return true;
}

/* Only what makes a sensor unavailable: each failure is a state, and a sensor may be away for weeks. */
static void tell_failure(const failure_t *failure, const station_t *station)
{
    if (failure->status == FATHOM_ERR_PORT)
        (void)fputs("fathom: ", stderr);
    else
        (void)fprintf(stderr, "fathom: %s: ", station->name);
    advice_print(stderr, failure);
    (void)fputs("\n", stderr);
}

static void take_failure(void *ctx, const failure_t *failure, const station_t *station)
{
    publish_t *const publish = ctx;
    const fathom_status_t status = failure->status;
    const uint8_t probe = status == FATHOM_ERR_MALFORMED ? reader_refused_probe(&station->reader) : 0;
    char word[COUNTERS_MEMBER];
    (void)status_word_of_failure(counters_failure_kind(status, &station->reader), word);
    if (publisher_failure(&publish->publisher, station, word, probe,
                          status == FATHOM_ERR_PORT || status == FATHOM_ERR_STALE) &&
        !failure->is_told)
        tell_failure(failure, station);
    results_failure(&publish->results, station, status);
}

static void take_absence(void *ctx, const station_t *station)
{
    publish_t *const publish = ctx;
    char word[COUNTERS_MEMBER];
    publisher_failure(&publish->publisher, station, status_word_of_failure((size_t)-FATHOM_ERR_PORT, word), 0,
                      true);
}

static void tell_remark(void *ctx, const station_t *station, const char *text)
{
    (void)ctx;
    (void)fprintf(stderr, "fathom: %s: %s\n", station->name, text);
}

static void tell_port(void *ctx, const char *text, poll_port_state_t state)
{
    (void)ctx;
    (void)state;
    (void)fprintf(stderr, "fathom: %s\n", text);
}

static uint32_t tick(void *ctx)
{
    publish_t *const publish = ctx;
    const uint32_t results_us = results_tick(&publish->results);
    const uint32_t publisher_us = publisher_tick(&publish->publisher);
    return results_us < publisher_us ? results_us : publisher_us;
}

static bool is_over(const void *ctx)
{
    (void)ctx;
    return false;
}

static void help(FILE *to)
{
    (void)fputs(
        "fathom publish reads all sensors of a site and publishes what they say to an MQTT broker.\n\n"
        "usage: fathom publish [--check] FILE\n\n",
        to);
    config_keys_help(to);
}

static bool begin(publish_t *publish, const host_t *host)
{
    poll_loop_t *const loop = &publish->loop;
    loop->options = publish->config.sensors;
    if (!host->begin(host->ctx) ||
        !publisher_begin(&publish->publisher, host, &publish->config, publish->results_configs))
        return false;
    results_begin(&publish->results, loop, take_result, publish);
    for (size_t i = 0; i != loop->options.station_count; i++) {
        const station_t *const station = loop->options.stations[i];
        results_add(&publish->results, station, &publish->results_configs[station->slot]);
        if (!publisher_add(&publish->publisher, station)) return false;
    }
    return true;
}

static int publish_all(publish_t *publish, const host_t *host)
{
    poll_loop_t *const loop = &publish->loop;
    int status = STATUS_FAILED;
    if (!begin(publish, host)) return STATUS_FAILED;
    if (poll_loop_open(loop) && publisher_connect(&publish->publisher, &loop->sources)) {
        poll_loop_run(loop);
        if (host->has_ended(host->ctx)) status = STATUS_OK;
    }
    publisher_end(&publish->publisher);
    poll_loop_close(loop);
    return status;
}

static int run(const host_t *host, int argc, char **argv)
{
    static const poll_loop_user_t user = {take_sample, take_failure, take_absence, tell_remark,
                                          tell_port,   tick,         is_over};
    static publish_t publish; /* too large for any stack */
    const char *values[OPTIONS] = {NULL};
    const int rest = options_parse(command, argc, argv, table, values);
    if (rest < 0) return STATUS_USAGE;
    if (values[HELP] != NULL) return command_help(&publish_command);
    if (argc - rest != 1)
        return usage_error(command, "which configuration file? One, such as /etc/fathom/site.yaml");
    publish.config.sensors.beside = NULL;
    if (!config_load(&publish.config, publish.results_configs, command, argv[rest])) return STATUS_USAGE;
    int status = STATUS_OK;
    if (values[CHECK] != NULL) {
        explain(&publish.config, publish.results_configs, stdout);
        if (fflush(stdout) != 0) status = STATUS_FAILED;
    } else {
        poll_loop_begin(&publish.loop, host, &user, &publish);
        status = publish_all(&publish, host);
    }
    config_free(&publish.config);
    return status;
}

const command_t publish_command = {"publish", "publishes sensors to an MQTT broker", help, run};
