/* SPDX-License-Identifier: MIT */
#include <signal.h>
#include <string.h>

#include "cli/options.h"
#include "commands/commands.h"
#include "commands/publish/explain.h"
#include "commands/publish/reload.h"
#include "diagnosis/status_word.h"
#include "mqtt/notify.h"
#include "mqtt/publisher.h"
#include "ports/host.h"
#include "reading/poll_loop.h"

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
    notify_t notify;
    reload_t reload;
    uint64_t status_us; /* when the status was told last */
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
    const uint8_t probe = status == FATHOM_ERR_MALFORMED ? reader_facts(station->reader).refused_probe : 0;
    char word[COUNTERS_MEMBER];
    (void)status_word_of_failure(counters_failure_kind(status, station->reader), word);
    /* A sensor that sends by itself and is damaged for --timeout has sent no reading, as if it were silent. */
    const bool is_grave = status == FATHOM_ERR_PORT || status == FATHOM_ERR_STALE ||
                          (status == FATHOM_ERR_CHECKSUM && !mode_is_asked(station->mode));
    if (publisher_failure(&publish->publisher, station, word, probe, is_grave) && !failure->is_told)
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

static void tell_status(publish_t *publish, uint64_t now_us)
{
    enum { STATUS_US = 1000000 };
    char text[NOTIFY_TEXT];
    if (publish->notify.fd < 0 || (publish->status_us != 0 && now_us - publish->status_us < STATUS_US))
        return;
    publish->status_us = now_us;
    publisher_status(&publish->publisher, text, sizeof text);
    notify_status(&publish->notify, text);
}

/* What was wrong in the file was told, and the one before goes on. */
static void take_hangup(publish_t *publish, uint64_t now_us)
{
    notify_reloading(&publish->notify, now_us);
    if (reload_begin(&publish->reload, command)) return;
    (void)fprintf(stderr, "fathom: nothing has changed\n");
    notify_ready(&publish->notify);
}

static uint32_t tick(void *ctx)
{
    enum { AGAIN_US = 5000 };
    publish_t *const publish = ctx;
    const uint64_t now_us = publish->loop.host->now_us(publish->loop.host->ctx);
    uint32_t this_us = notify_tick(&publish->notify, now_us);
    if (host_had_signal()) take_hangup(publish, now_us);
    if (reload_tick(&publish->reload)) {
        (void)fprintf(stderr, "fathom: %s was read anew\n", publish->config.path);
        notify_ready(&publish->notify);
    }
    const uint32_t results_us = results_tick(&publish->results);
    const uint32_t publisher_us = publisher_tick(&publish->publisher);
    if (publish->reload.is_waiting && this_us > AGAIN_US) this_us = AGAIN_US;
    if (results_us < this_us) this_us = results_us;
    tell_status(publish, now_us);
    return publisher_us < this_us ? publisher_us : this_us;
}

static bool is_over(const void *ctx)
{
    (void)ctx;
    return false;
}

static void help(FILE *to)
{
    (void)fputs("fathom publish reads all sensors of a site and publishes what they say to an MQTT broker, "
                "until it is "
                "ended.\n"
                "It writes to no device, and subscribes to nothing.\n\n"
                "usage: fathom publish [--check] FILE\n\n"
                "  --check           explains the file, and says what would be published where. Nothing is "
                "opened or sent\n"
                "\nFILE is YAML, of these keys:\n\n",
                to);
    config_keys_help(to);
    (void)fputs(
        "\nThe topics are PREFIX/SITE/status and publisher, and for each sensor PREFIX/SITE/NAME/state, "
        "availability and,\n"
        "where it has them, level and alarm. The manual has what is in them.\n"
        "SIGHUP reads FILE anew: what has not changed is read on. While the broker is away, messages wait in "
        "memory.\n"
        "Exit status: 0 when a signal has ended it, 1 when it could not begin, 2 for wrong usage or a wrong "
        "FILE.\n"
        "\nexamples:\n"
        "  fathom publish --check site.yaml               is it right, and what will be published?\n"
        "  fathom publish site.yaml\n"
        "  fathom publish site.yaml 2>> publish.log       what it has to tell, in a file\n",
        to);
}

static bool begin(publish_t *publish, const host_t *host)
{
    poll_loop_t *const loop = &publish->loop;
    loop->options = publish->config.sensors;
    if (!host->begin(host->ctx) ||
        !publisher_begin(&publish->publisher, host, &publish->config, publish->results_configs))
        return false;
    host_watch_signal(SIGHUP);
    results_begin(&publish->results, loop, take_result, publish);
    publish->reload = (reload_t){.config = &publish->config,
                                 .configs = publish->results_configs,
                                 .results = &publish->results,
                                 .loop = loop,
                                 .publisher = &publish->publisher};
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
    notify_begin(&publish->notify);
    if (!begin(publish, host)) return STATUS_FAILED;
    if (poll_loop_open(loop) && publisher_connect(&publish->publisher, &loop->sources)) {
        notify_ready(&publish->notify);
        poll_loop_run(loop);
        notify_stopping(&publish->notify);
        if (host->has_ended(host->ctx)) status = STATUS_OK;
    }
    publisher_end(&publish->publisher);
    poll_loop_close(loop);
    notify_end(&publish->notify);
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

const command_t publish_command = {
    .name = "publish", .summary = "publishes sensors to an MQTT broker", .help = help, .run = run};
