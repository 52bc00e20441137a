/* SPDX-License-Identifier: MIT */
#include "ports/port.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- errors ---- */

/* A user who set FATHOM_PORT long ago needs to know why it is this port. */
fathom_status_t port_set_error(port_t *port, port_error_t error, const char *text)
{
    const char *const named = getenv("FATHOM_PORT"); /* NOLINT(concurrency-mt-unsafe): one thread */
    const bool is_named = error != PORT_LOST && named != NULL && strcmp(named, port->settings.path) == 0;
    (void)snprintf(port->text, sizeof port->text, "%.*s%s", (int)sizeof port->text - 64, text,
                   is_named ? " (FATHOM_PORT in the environment names this port)" : "");
    port->error = error;
    return FATHOM_ERR_PORT;
}

fathom_status_t port_fail(port_t *port, port_error_t error, const char *format, ...)
{
    char text[sizeof port->text];
    va_list arguments;
    const int head = snprintf(text, sizeof text / 2, "%.*s: ", (int)(sizeof text / 2 - 3), port_name(port));
    va_start(arguments, format);
    /* NOLINTNEXTLINE(clang-analyzer-valist.Uninitialized): clang-tidy 14 forgets the line above */
    (void)vsnprintf(text + head, sizeof text - (size_t)head, format, arguments);
    va_end(arguments);
    return port_set_error(port, error, text);
}

/* ---- a tty ---- */

static fathom_status_t fail_serial(port_t *port)
{
    const fathom_posix_status_t error = fathom_posix_error(&port->serial);
    return port_set_error(port,
                          error == FATHOM_POSIX_ERR_LOST        ? PORT_LOST
                          : error == FATHOM_POSIX_ERR_NOT_FOUND ? PORT_ABSENT
                                                                : PORT_FAILED,
                          fathom_posix_error_text(&port->serial));
}

static bool has_trigger(const port_t *port) { return port->settings.pins.chip != 0; }

static void close_serial(port_t *port)
{
    if (has_trigger(port)) port->host->close_pins(port->host->ctx, &port->pins);
    adapter_close(&port->adapter);
    port->host->close(port->host->ctx, &port->serial);
}

static fathom_status_t open_serial(port_t *port)
{
    const port_settings_t *const settings = &port->settings;
    const host_t *const host = port->host;
    const char *const reason = adapter_find(&port->adapter, settings->path);
    if (reason != NULL && reason[0] != '\0') return port_fail(port, PORT_FAILED, "%s", reason);
    if (reason != NULL) return port_fail(port, PORT_ABSENT, "the adapter is not plugged in");
    if (!host->open(host->ctx, port_name(port), &settings->line, &port->serial, &port->uart))
        return fail_serial(port);
    if (!adapter_open(&port->adapter)) {
        close_serial(port);
        return port_fail(port, PORT_ABSENT, "another adapter took this path");
    }
    if (settings->rs485 &&
        fathom_posix_set_rs485(&port->serial, &(fathom_posix_rs485_t){0}) != FATHOM_POSIX_OK) {
        (void)fail_serial(port);
        close_serial(port);
        return FATHOM_ERR_PORT;
    }
    if (has_trigger(port)) {
        char chip[sizeof "gpiochip4294967295"];
        (void)snprintf(chip, sizeof chip, "gpiochip%" PRIu32, settings->pins.chip - 1);
        if (port_open_pins(port, chip) != FATHOM_OK) {
            close_serial(port);
            return FATHOM_ERR_PORT;
        }
    }
    port->parts.gap_us = PORT_RESPONSE_GAP_US;
    port->parts.echo = settings->echo;
    port->parts.senders = &fathom_line_senders;
    port->parts.masters = &fathom_line_masters;
    port_set_slowest(port, &settings->line);
    return FATHOM_OK;
}

static fathom_status_t poll_serial(port_t *port)
{
    if (adapter_is_doubtful(&port->adapter))
        return port_fail(port, PORT_LOST, "%s", adapter_find(&port->adapter, port->settings.path));
    if (fathom_posix_error(&port->serial) == FATHOM_POSIX_ERR_LOST) return fail_serial(port);
    return has_trigger(port) ? port_chip.poll(port) : FATHOM_OK;
}

static int serial_fd(const port_t *port) { return fathom_posix_fd(&port->serial); }

static short serial_events(const port_t *port) { return fathom_posix_poll_events(&port->serial); }

const port_driver_t port_serial = {open_serial, poll_serial, close_serial, serial_fd, serial_events};

/* ---- opening ---- */

static uint32_t now_us(void *ctx)
{
    const port_t *const port = ctx;
    return (uint32_t)port->host->now_us(port->host->ctx);
}

void port_set_slowest(port_t *port, const fathom_line_settings_t *settings)
{
    if (port_has_line(port)) port->parts.silence_us = fathom_silence_us(settings);
}

/* The port is open: starts a line on it. */
static void start_line(port_t *port)
{
    fathom_loop_source_t *const source = port->settings.source;
    if (source != NULL) {
        port->uart = fathom_loop_uart(source, &port->uart);
        source->reads_all = port_has_line(port) && port_fd(port) >= 0;
    }
    listener_begin(&port->listener, &port->uart, &port->clock);
    port->parts.uart = &port->uart;
    port->parts.clock = &port->clock;
    port->parts.frame = port->frame;
    port->parts.frame_size = sizeof port->frame;
    port->parts.find_echo = fathom_line_find_echo;
    port->parts.marks = fathom_line_marks;
    port->parts.count = fathom_line_count;
    port->parts.counters = port->counters;
    (void)fathom_line_init(&port->line, &port->parts); /* all of it is there */
    port->modbus = fathom_modbus_client_with_zero(&port->line);
}

/* After each call of the driver that opens or connects. */
static fathom_status_t note_opening(port_t *port, fathom_status_t status)
{
    if (status == FATHOM_ERR_PORT) port->failures = port->error == PORT_ABSENT ? 0 : port->failures + 1;
    if (status == FATHOM_OK) {
        port->failures = 0;
        if (port_has_pins(port))
            listener_begin(&port->listener, &port->uart, &port->clock); /* which hears nothing */
        else
            start_line(port);
    }
    port->is_connecting = status == FATHOM_PENDING;
    return status;
}

fathom_status_t port_open(port_t *port, const host_t *host, const port_settings_t *settings)
{
    if (strcmp(port->path, settings->path) != 0) memset(&port->adapter, 0, sizeof port->adapter);
    port->host = host;
    port->settings = *settings;
    port->settings.path = port->path;
    (void)snprintf(port->path, sizeof port->path, "%s", settings->path);
    port->driver = port_path_has_line(settings->path)   ? &port_serial
                   : port_path_has_pins(settings->path) ? &port_chip
                                                        : &port_tcp;
    port->clock = (fathom_clock_t){now_us, port};
    port->error = PORT_OK;
    port->gateway_exception = 0;
    port->text[0] = '\0';
    if (strlen(settings->path) >= sizeof port->path)
        return port_fail(port, PORT_FAILED, "the path is too long");
    return note_opening(port, port->driver->open(port));
}

bool port_open_now(port_t *port, const host_t *host, const port_settings_t *settings)
{
    enum { LOOK_US = 500000 };
    fathom_status_t status = port_open(port, host, settings);
    while (status == FATHOM_PENDING) {
        if (port_wait(port, LOOK_US) == FATHOM_OK) {
            status = port_poll(port);
            continue;
        }
        port_close(port);
        status = port_fail(port, PORT_FAILED, "the command was ended before the connection was established");
    }
    return status == FATHOM_OK;
}

fathom_status_t port_poll(port_t *port)
{
    const fathom_status_t status = port->driver->poll(port);
    return port->is_connecting ? note_opening(port, status) : status;
}

void port_close(port_t *port)
{
    if (port->driver != NULL && port->driver->close != NULL) port->driver->close(port);
}

int port_fd(const port_t *port) { return port->driver->fd(port); }

short port_events(const port_t *port) { return port->driver->events(port); }

/* ---- waiting ---- */

static bool has_ended(const port_t *port)
{
    const host_t *const host = port->host;
    return host->has_ended(host->ctx) || (port->watches_output && host->is_output_gone(host->ctx));
}

fathom_status_t port_wait(port_t *port, uint32_t max_us)
{
    const host_t *const host = port->host;
    if (port_is_lost(port)) return FATHOM_ERR_PORT;
    if (!has_ended(port))
        host->wait(host->ctx, port_fd(port), port_events(port), max_us, port->watches_output);
    return has_ended(port) ? FATHOM_ERR_CANCELLED : FATHOM_OK; /* so that no request starts after a signal */
}

fathom_status_t port_finish(port_t *port, fathom_transaction_t *transaction)
{
    for (;;) {
        (void)fathom_line_poll(&port->line); /* a lost port ends the transaction */
        if (transaction->status != FATHOM_PENDING) return transaction->status;
        if (port_wait(port, fathom_line_due_us(&port->line)) == FATHOM_ERR_CANCELLED)
            fathom_line_cancel(&port->line, transaction);
        if (transaction->status != FATHOM_PENDING) return transaction->status;
    }
}

fathom_status_t port_listen(port_t *port, uint32_t for_us)
{
    const host_t *const host = port->host;
    const uint64_t end_us = host->now_us(host->ctx) + for_us;
    fathom_status_t status = FATHOM_OK;
    for (uint64_t at_us; status == FATHOM_OK && (at_us = host->now_us(host->ctx)) < end_us;) {
        if (fathom_line_poll(&port->line) < 0) return FATHOM_ERR_PORT;
        status = port_wait(port, (uint32_t)(end_us - at_us));
    }
    return status;
}

/* ---- properties ---- */

/* A read that failed has stored the error in port->serial. */
static bool is_lost_since(const port_t *port)
{
    return port->error == PORT_OK && port->driver == &port_serial &&
           fathom_posix_error(&port->serial) == FATHOM_POSIX_ERR_LOST;
}

bool port_is_lost(const port_t *port) { return port->error == PORT_LOST || is_lost_since(port); }

bool port_is_absent(const port_t *port) { return port->error == PORT_ABSENT; }

const char *port_error(const port_t *port)
{
    return is_lost_since(port) ? fathom_posix_error_text(&port->serial) : port->text;
}

const char *port_name(const port_t *port)
{
    const bool is_found = port->driver == &port_serial && port->adapter.path[0] != '\0';
    return is_found ? port->adapter.path : port->settings.path;
}

bool port_is_overdue(const port_t *port)
{
    enum { TRIES = 3 };
    return port->failures == TRIES;
}

const char *port_advice(port_t *port)
{
    return port->driver == &port_serial ? adapter_advice(&port->adapter) : NULL;
}

bool port_has_line(const port_t *port) { return port->driver == &port_serial; }

bool port_has_gateway(const port_t *port) { return port->driver == &port_tcp; }

bool port_has_pins(const port_t *port) { return port->driver == &port_chip; }

bool port_has_wire(const port_t *port) { return !port->serial.is_pty; }

bool port_can_break(const port_t *port) { return port->uart.set_break != NULL && port_has_wire(port); }

uint8_t port_gateway_exception(const port_t *port) { return port->gateway_exception; }

bool port_line_errors(port_t *port, fathom_posix_line_errors_t *errors)
{
    return port_has_line(port) && fathom_posix_line_errors(&port->serial, errors) == FATHOM_POSIX_OK;
}

unsigned port_latency_ms(const port_t *port)
{
    return port_has_line(port) ? adapter_latency_ms(port_name(port)) : 0;
}

const char *port_line_text(const port_t *port, const fathom_line_settings_t *line, char text[LINE_TEXT])
{
    if (!port_has_gateway(port)) return line_text(line, text);
    (void)snprintf(text, LINE_TEXT, "Modbus TCP");
    return text;
}
