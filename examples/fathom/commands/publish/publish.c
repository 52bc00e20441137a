/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): SOCK_CLOEXEC */
#include <inttypes.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "cli/command.h"
#include "cli/config.h"
#include "commands/commands.h"
#include "commands/publish/claim.h"
#include "mqtt/publisher.h"

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
    claim_t claim;
    char status[256];     /* that the service manager has, */
    uint64_t reported_us; /* since when */
    uint32_t watchdog_us; /* from one message to its watchdog to the next; 0: it has none */
    /* A file that was read again, while requests on the lines that change are pending. */
    publish_settings_t next_settings;
    site_t next;
    uint64_t changing_us; /* since when; 0: there is none */
} publish;

/* ---- the service manager ---- */

/* Sends a datagram of sd_notify(3). Without a service manager nothing is sent. */
__attribute__((format(printf, 1, 2))) static void notify(const char *format, ...)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    const char *const path = environment("NOTIFY_SOCKET");
    const size_t length = strlen(path);
    va_list arguments;
    if ((path[0] != '/' && path[0] != '@') || length >= sizeof address.sun_path) return;
    memcpy(address.sun_path, path, length);
    if (path[0] == '@') address.sun_path[0] = '\0'; /* an abstract name */
    const socklen_t size = (socklen_t)(offsetof(struct sockaddr_un, sun_path) + length);
    const int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (fd < 0) return;
    va_start(arguments, format);
    if (connect(fd, (const struct sockaddr *)&address, size) == 0) (void)vdprintf(fd, format, arguments);
    va_end(arguments);
    (void)close(fd);
}

/* Half of the time that the watchdog waits for, as sd_watchdog_enabled(3) advises. */
static uint32_t watchdog_us(void)
{
    const char *const pid = environment("WATCHDOG_PID");
    const unsigned long long us = strtoull(environment("WATCHDOG_USEC"), NULL, 10) / 2;
    const bool is_ours = pid[0] == '\0' || strtol(pid, NULL, 10) == (long)getpid();
    return is_ours && us < FATHOM_NO_DEADLINE ? (uint32_t)us : 0;
}

/* Sends the state if it has changed, and to a watchdog in any case. Returns the time until the next call in us. */
static uint32_t report_status(uint64_t now_us)
{
    enum { STATUS_US = 1000000 };
    const bool is_watched = publish.watchdog_us != 0;
    const uint32_t period_us =
        is_watched && publish.watchdog_us < STATUS_US ? publish.watchdog_us : STATUS_US;
    if (publish.reported_us == 0 || now_us - publish.reported_us >= period_us) {
        char status[sizeof publish.status];
        publish.reported_us = now_us;
        claim_tick(&publish.claim);
        publisher_status(&publish.publisher, status, sizeof status);
        if (is_watched || strcmp(status, publish.status) != 0)
            notify("STATUS=%s%s", status, is_watched ? "\nWATCHDOG=1" : "");
        (void)strcpy(publish.status, status);
    }
    return (uint32_t)(publish.reported_us + period_us - now_us);
}

/* ---- the sink ---- */

/* Each failure is published. Only those that make a sensor unavailable are printed: it may be away for weeks. */
static void on_reading(void *ctx, const reading_t *reading)
{
    const bool is_newly_away = publisher_reading(&publish.publisher, reading);
    const bool is_port = reading->status == FATHOM_ERR_PORT;
    (void)ctx;
    if (!is_newly_away || reading->evidence == NULL || reading->evidence->is_told) return;
    (void)fprintf(stderr, "fathom: %s%s", is_port ? "" : reading->sensor->name, is_port ? "" : ": ");
    advice_print(stderr, reading->evidence);
    (void)fputs("\n", stderr);
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
    notify("RELOADING=1\nMONOTONIC_USEC=%" PRIu64, now_us);
    site_free(&publish.next); /* of an earlier file that is out of date */
    publish.changing_us = now_us;
    if (config_load(&publish.next_settings, &publish.next, command, publish.settings.path)) {
        if (claim_site(&publish.claim, &publish.next_settings)) return;
        site_free(&publish.next);
    }
    publish.changing_us = 0;
    (void)fprintf(stderr, "fathom: nothing has changed.\n");
    notify("READY=1");
}

/* Waits for pending requests, but not for longer than PATIENCE_US. */
static void change(uint64_t now_us)
{
    enum { PATIENCE_US = 2000000 };
    site_t old;
    if (publish.changing_us == 0 ||
        !loop_set_site(&publish.loop, &publish.next, now_us - publish.changing_us > PATIENCE_US, &old))
        return;
    publish.changing_us = 0;
    const bool is_other = has_other_broker(&publish.settings, &publish.next_settings);
    publish.settings = publish.next_settings;
    publisher_change(&publish.publisher, &publish.loop.site, is_other);
    site_free(&old);
    (void)fprintf(stderr, "fathom: %s was read again.\n", publish.settings.path);
    notify("READY=1");
}

static uint32_t tick(void *ctx)
{
    enum { AGAIN_US = 5000 };
    const uint64_t now_us = loop_now_us(&publish.loop);
    (void)ctx;
    if (host_had_signal()) load_again(now_us);
    change(now_us);
    const uint32_t publisher_us = publisher_tick(&publish.publisher);
    const uint32_t report_us = report_status(now_us);
    const uint32_t sleep_us = publisher_us < report_us ? publisher_us : report_us;
    return publish.changing_us != 0 && sleep_us > AGAIN_US ? AGAIN_US : sleep_us;
}

/* ---- start and end ---- */

/* "tank       a16:1:modbus@/dev/ttyUSB0, 500 ms, median 5, level" */
static void explain_sensor(const sensor_t *sensor)
{
    const results_config_t *const processing = &sensor->processing;
    (void)printf("%-10s %s", sensor->name, sensor->model->name);
    if (sensor->mode->has_address) (void)printf(":%u", sensor->address);
    (void)printf(":%s@%s, %" PRIu32 " ms", sensor->mode->name, sensor->port->path,
                 sensor->settings.period_us / 1000);
    if (processing->median != 0) (void)printf(", median %u", processing->median);
    if (processing->has_level) (void)printf(", level");
    if (processing->has_alarm)
        (void)printf(", alarm %s%u/%u", processing->alarm.when == FATHOM_NEAR ? "near<" : "far>",
                     processing->alarm.on_mm, processing->alarm.off_mm);
    (void)printf("\n");
}

/* Prints a table of the sensors, and the topics under which they are published. */
static int explain(void)
{
    const publish_settings_t *const settings = &publish.settings;
    const broker_settings_t *const broker = &settings->broker;
    const sensor_t *sensor = NULL;
    (void)printf("broker     %s port %u%s\n", broker->host, broker->port, broker->has_tls ? ", TLS" : "");
    (void)printf("client     %s%s%s\n", broker->client_id, broker->user[0] != '\0' ? ", user " : "",
                 broker->user);
    (void)printf("topics     %s/%s/%s\n", settings->prefix, settings->site,
                 settings->site_line == 0 ? ", from the name of this host" : "");
    (void)printf("           Only one computer may have this client id and these topics.\n");
    (void)printf("queue      %" PRIu32 " messages, %" PRIu32 " bytes\n", settings->queue_messages,
                 settings->queue_bytes);
    (void)printf("discovery  %s\n", settings->discovery[0] != '\0' ? settings->discovery : "off");
    for (const topic_t *topic = publish.publisher.topics; topic != NULL; topic = topic->next) {
        if (topic->sensor != sensor) explain_sensor(topic->sensor);
        sensor = topic->sensor;
        if (!topic_is_entity(topic->kind)) (void)printf("           %s\n", topic->name);
    }
    return is_output_written() ? STATUS_OK : STATUS_FAILED;
}

static int publish_site(const host_t *host)
{
    loop_t *const loop = &publish.loop;
    if (!host->begin(host->ctx)) return STATUS_FAILED;
    host_watch_signal(SIGHUP);
    publish.watchdog_us = watchdog_us();
    if (!claim_site(&publish.claim, &publish.settings)) return STATUS_FAILED;
    const bool is_open = loop_open(loop);
    if (is_open) {
        notify("READY=1");
        loop_check_clock(loop);
        loop_run(loop);
        notify("STOPPING=1");
    }
    publisher_end(&publish.publisher);
    loop_close(loop);
    claim_end(&publish.claim);
    site_free(&publish.next);
    return is_open && host->has_ended(host->ctx) ? STATUS_OK : STATUS_FAILED;
}

static int start(const host_t *host, const arguments_t *arguments)
{
    static const sink_t sink = {on_reading, notice_print, tick};
    const publish_options_t *const options = arguments->settings;
    const origin_t *const origin = &arguments->origin;
    loop_t *const loop = &publish.loop;
    if (arguments->count == 0)
        (void)reject(origin, "FILE is missing, such as /etc/fathom/site.yaml.");
    else if (arguments->count != 1)
        (void)reject(origin, "%d files are named. Name one.", arguments->count);
    if (arguments->count != 1) return STATUS_USAGE;
    memset(&publish, 0, sizeof publish);
    loop_init(loop, host, &sink, NULL);
    if (!config_load(&publish.settings, &loop->site, command, arguments->words[0])) return STATUS_USAGE;
    publisher_init(&publish.publisher, host, &loop->sources, &publish.settings, &loop->site, loop->start_us);
    const int status = options->check ? explain() : publish_site(host);
    publisher_deinit(&publish.publisher);
    loop_deinit(loop);
    return status;
}

const command_t publish_command = {
    .name = "publish",
    .summary = "Publish the readings of a site to an MQTT broker",
    .usage = "FILE [OPTIONS]",
    .about = "FILE is a YAML file with the broker, the lines and their sensors. The command\n"
             "runs until a signal ends it. It writes to no sensor, and obeys no message.\n"
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
