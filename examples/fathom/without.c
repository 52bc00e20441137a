/* SPDX-License-Identifier: MIT */
/* Stands for the sources whose libraries were not found: it prints what is missing, and what to install. */
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#ifdef FATHOM_WITHOUT_LIBMODBUS
#include "fathom/engine/line.h"
#include "ports/connection.h"

static fathom_status_t open_tcp(port_t *port)
{
    if (port->kind == PORT_RAW) return connection_open(port, &connection_raw);
    return port_fail(
        port, PORT_FAILED,
        "%s: this fathom was built without libmodbus, which tcp: needs; install libmodbus-dev and "
        "build it again",
        port->name);
}

static void start_line(port_t *port) { port->parts.marks = fathom_line_refusals; }

const port_driver_t port_tcp = {.open = open_tcp,
                                .poll = connection_poll,
                                .close = connection_close,
                                .start_line = start_line,
                                .due_us = connection_due_us};
#endif

#ifdef FATHOM_WITHOUT_GPIO
#include "ports/host.h"

bool pins_open(void *ctx, const char *chip, const pin_options_t *wanted, pins_t *pins)
{
    (void)ctx;
    (void)wanted;
    pins->lines[0].error = FATHOM_GPIO_ERR_UNSUPPORTED;
    (void)snprintf(
        pins->lines[0].text, sizeof pins->lines[0].text,
        "%.99s: this fathom was built without linux/gpio.h of Linux 5.10 or later, which pins need", chip);
    return false;
}

/* NOLINTNEXTLINE(readability-non-const-parameter): pins.c writes it */
void pins_close(void *ctx, pins_t *pins)
{
    (void)ctx;
    (void)pins;
}
#endif

#ifdef FATHOM_PUBLISH_LACKS
#include "cli/config.h"
#include "commands/commands.h"

void config_print_keys(FILE *to) { (void)fputs("  (fathom publish is not in this build)\n", to); }

static int start_publish(const host_t *host, const arguments_t *arguments)
{
    static const origin_t origin = {.command = "publish"};
    (void)host;
    (void)arguments;
    (void)reject(&origin, "this fathom was built without " FATHOM_PUBLISH_LACKS
                          ". Install the development files and build it again.");
    return STATUS_USAGE;
}

static const option_t publish_rows[] = {
    {"check", .help = "Print the sensors and topics of FILE, and open nothing", .is_hidden = true, .size = 1},
    {.name = NULL},
};

static const option_table_t publish_tables[] = {{publish_rows, 0}, {NULL, 0}};

const command_t publish_command = {
    .name = "publish",
    .summary = "Publish readings to an MQTT broker (not in this build)",
    .usage = "FILE",
    .about = "This fathom was built without " FATHOM_PUBLISH_LACKS ", which this command needs.\n",
    .tables = publish_tables,
    .settings_size = 1,
    .start = start_publish,
};
#endif

#ifdef FATHOM_WITHOUT_OPENSSL
#include "mqtt/broker.h"

/* libmosquitto's own settings and words. */
static const char authorities[] = "/etc/ssl/certs";

static const char *or_null(const char *text) { return text[0] != '\0' ? text : NULL; }

/* NOLINTNEXTLINE(readability-non-const-parameter): tls.c writes it */
bool tls_set(struct mosquitto *mosq, const broker_settings_t *settings, tls_verdict_t *verdict, char *text,
             size_t capacity)
{
    const char *const ca_file = or_null(settings->ca_file);
    const int result =
        mosquitto_tls_set(mosq, ca_file, ca_file == NULL ? authorities : NULL,
                          or_null(settings->certificate_file), or_null(settings->key_file), NULL);
    (void)verdict;
    (void)snprintf(text, capacity, "%s",
                   result == MOSQ_ERR_INVAL ? "one of the files cannot be read" : mosquitto_strerror(result));
    return result == MOSQ_ERR_SUCCESS;
}
#endif
