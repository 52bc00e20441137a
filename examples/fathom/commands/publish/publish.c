/* SPDX-License-Identifier: MIT */
#include <signal.h>
#include <string.h>

#include "cli/command.h"
#include "cli/config.h"
#include "commands/commands.h"
#include "commands/publish/explain.h"
#include "mqtt/notify.h"
#include "mqtt/publisher.h"
#include "ports/host.h"
#include "reading/loop.h"

static const char command[] = "publish";

typedef struct {
    bool check;
} publish_options_t;

static const option_t rows[] = {
    {"check", .help = "Print the sensors and topics of FILE, and open nothing", .group = GROUP_COMMAND,
     AT(publish_options_t, check)},
    {.name = NULL},
};

static const option_table_t tables[] = {{rows, 0}, {NULL, 0}};

/* Static: a thread that connects may outlive the command. */
static struct {
    publish_settings_t settings;
    loop_t loop;
    publisher_t publisher;
    notify_t notify;
    uint64_t status_us; /* when the state was reported last */
    /* A file that was read again, while requests on the lines that change are pending. */
    publish_settings_t next_settings;
    site_t next;
    bool is_changing;
    uint64_t since_us;
} publish;

/* ---- the sink ---- */

/* Each failure is published. Only those that make a sensor unavailable are printed: it may be away for weeks. */
static void on_reading(void *ctx, const reading_t *reading)
{
    (void)ctx;
    if (!publisher_reading(&publish.publisher, reading) || reading->evidence == NULL ||
        reading->evidence->is_told)
        return;
    if (reading->status == FATHOM_ERR_PORT)
        (void)fputs("fathom: ", stderr);
    else
        (void)fprintf(stderr, "fathom: %s: ", reading->sensor->name);
    advice_print(stderr, reading->evidence);
    (void)fputs("\n", stderr);
}

static void on_notice(void *ctx, const notice_t *notice)
{
    (void)ctx;
    notice_print(notice);
}

static void report_status(uint64_t now_us)
{
    enum { STATUS_US = 1000000 };
    char text[NOTIFY_TEXT];
    if (publish.notify.fd < 0 || (publish.status_us != 0 && now_us - publish.status_us < STATUS_US)) return;
    publish.status_us = now_us;
    publisher_status(&publish.publisher, text, sizeof text);
    notify_status(&publish.notify, text);
}

/* ---- reading the file again ---- */

/* With TLS the client is always another one, since the files may have changed. */
static bool has_other_broker(const publish_settings_t *one, const publish_settings_t *other)
{
    const broker_settings_t *const broker = &one->broker;
    const broker_settings_t *const that = &other->broker;
    return broker->has_tls || that->has_tls || broker->port != that->port ||
           broker->keep_alive_s != that->keep_alive_s || strcmp(broker->host, that->host) != 0 ||
           strcmp(broker->client_id, that->client_id) != 0 || strcmp(broker->user, that->user) != 0 ||
           strcmp(broker->password_file, that->password_file) != 0 || strcmp(one->site, other->site) != 0 ||
           strcmp(one->prefix, other->prefix) != 0;
}

static void load_again(uint64_t now_us)
{
    char path[SETTINGS_PATH];
    (void)snprintf(path, sizeof path, "%s", publish.settings.path);
    notify_reloading(&publish.notify, now_us);
    site_free(&publish.next); /* of an earlier file that is out of date */
    publish.is_changing = config_load(&publish.next_settings, &publish.next, command, path);
    publish.since_us = now_us;
    if (publish.is_changing) return;
    (void)fprintf(stderr, "fathom: nothing has changed.\n");
    notify_ready(&publish.notify);
}

/* Waits for pending requests, but not for longer than PATIENCE_US. */
static void change(uint64_t now_us)
{
    enum { PATIENCE_US = 2000000 };
    site_t old;
    if (!publish.is_changing ||
        !loop_set_site(&publish.loop, &publish.next, now_us - publish.since_us > PATIENCE_US, &old))
        return;
    publish.is_changing = false;
    const bool is_other = has_other_broker(&publish.settings, &publish.next_settings);
    publish.settings = publish.next_settings;
    if (!publisher_change(&publish.publisher, &publish.loop.site, is_other)) loop_stop(&publish.loop);
    site_free(&old);
    (void)fprintf(stderr, "fathom: %s was read again.\n", publish.settings.path);
    notify_ready(&publish.notify);
}

static uint32_t tick(void *ctx)
{
    enum { AGAIN_US = 5000 };
    const uint64_t now_us = loop_now_us(&publish.loop);
    uint32_t sleep_us = notify_tick(&publish.notify, now_us);
    (void)ctx;
    if (host_had_signal()) load_again(now_us);
    change(now_us);
    const uint32_t publisher_us = publisher_tick(&publish.publisher);
    report_status(now_us);
    if (publish.is_changing && sleep_us > AGAIN_US) sleep_us = AGAIN_US;
    return publisher_us < sleep_us ? publisher_us : sleep_us;
}

/* ---- start and end ---- */

static int publish_site(const host_t *host)
{
    loop_t *const loop = &publish.loop;
    publisher_t *const publisher = &publish.publisher;
    int status = STATUS_FAILED;
    notify_init(&publish.notify);
    if (!host->begin(host->ctx) ||
        !publisher_init(publisher, host, &publish.settings, &loop->site, loop->start_us))
        return STATUS_FAILED;
    host_watch_signal(SIGHUP);
    if (loop_open(loop) && publisher_connect(publisher, &loop->sources)) {
        notify_ready(&publish.notify);
        loop_run(loop);
        notify_stopping(&publish.notify);
        if (host->has_ended(host->ctx)) status = STATUS_OK;
    }
    publisher_deinit(publisher);
    loop_close(loop);
    notify_deinit(&publish.notify);
    return status;
}

static int start(const host_t *host, const arguments_t *arguments)
{
    static const sink_t sink = {on_reading, on_notice, tick};
    const publish_options_t *const options = arguments->settings;
    const origin_t origin = {.command = command};
    loop_t *const loop = &publish.loop;
    int status = STATUS_OK;
    if (arguments->count == 0) {
        (void)reject(&origin, "FILE is missing, such as /etc/fathom/site.yaml.");
        return STATUS_USAGE;
    }
    if (arguments->count != 1) {
        (void)reject(&origin, "%d files are named. Name one.", arguments->count);
        return STATUS_USAGE;
    }
    loop_init(loop, host, &sink, NULL);
    if (!config_load(&publish.settings, &loop->site, command, arguments->words[0])) return STATUS_USAGE;
    if (options->check) {
        explain(&publish.settings, &loop->site, stdout);
        if (fflush(stdout) != 0) status = STATUS_FAILED;
    } else {
        status = publish_site(host);
    }
    loop_deinit(loop);
    site_free(&publish.next);
    publish.is_changing = false;
    return status;
}

const command_t publish_command = {
    .name = "publish",
    .summary = "Publish the readings of a site to an MQTT broker",
    .usage = "FILE [OPTIONS]",
    .about = "FILE is a YAML file with the broker, the lines and their sensors. The command\n"
             "runs until a signal ends it. It writes to no sensor, and subscribes to nothing.\n"
             "SIGHUP reads FILE again: lines that have not changed are read on.\n",
    .tables = tables,
    .common = "check",
    .examples = "  fathom publish --check site.yaml\n"
                "  fathom publish site.yaml\n"
                "  fathom publish site.yaml 2>> publish.log\n",
    .status = "Exit status: 0 a signal ended it, 1 it could not start, 2 wrong usage or FILE.\n",
    .topics = "config, publishing, delivery, boxes, service",
    .operands = OPERANDS_FILE,
    .settings_size = sizeof(publish_options_t),
    .start = start,
};
