/* SPDX-License-Identifier: MIT */
#include "ports/port.h"

#include <inttypes.h>
#include <poll.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>

#include "output/words.h"
#include "ports/holder.h"

/* ---- paths ---- */

static const char tcp_prefix[] = "tcp:";
static const char raw_prefix[] = "rtu-tcp:";

port_kind_t port_kind(const char *path)
{
    if (strncmp(path, tcp_prefix, strlen(tcp_prefix)) == 0) return PORT_GATEWAY;
    if (strncmp(path, raw_prefix, strlen(raw_prefix)) == 0) return PORT_RAW;
    return strncmp(last_part(path), "gpiochip", strlen("gpiochip")) == 0 ? PORT_PINS : PORT_SERIAL;
}

bool port_has_settings(port_kind_t kind) { return kind == PORT_SERIAL; }

bool port_has_bytes(port_kind_t kind) { return kind == PORT_SERIAL || kind == PORT_RAW; }

bool port_is_same(const char *one, const char *other)
{
    struct stat first;
    struct stat second;
    if (strcmp(one, other) == 0) return true;
    return stat(one, &first) == 0 && stat(other, &second) == 0 && first.st_dev == second.st_dev &&
           first.st_ino == second.st_ino;
}

const char *tcp_parse(const char *path, tcp_address_t *address)
{
    const char *const usual_port = "502"; /* MODBUS Messaging on TCP/IP V1.0b, 4.2.1 */
    const bool is_raw = port_kind(path) == PORT_RAW;
    const char *host = path + strlen(is_raw ? raw_prefix : tcp_prefix);
    const char *const colon = strchr(host, ':');
    const char *end = colon != NULL ? colon : host + strlen(host);
    const char *service = end;
    uint32_t number = 0;
    if (*host == '[') {
        end = strchr(++host, ']');
        if (end == NULL) return "the bracket behind the IPv6 address is missing";
        service = end + 1;
    } else if (colon != NULL && strchr(colon + 1, ':') != NULL) {
        return "an IPv6 address stands in brackets, such as in tcp:[fd00::20]:502";
    }
    if (end == host) return "the host is missing, such as in tcp:192.168.1.20";
    if ((size_t)(end - host) >= sizeof address->host) return "the host's name is too long";
    (void)snprintf(address->host, sizeof address->host, "%.*s", (int)(end - host), host);
    if (*service == '\0' && is_raw)
        return "the port is missing, such as in rtu-tcp:192.168.1.20:8899. Each make of converter has "
               "another one";
    if (*service == '\0')
        service = usual_port;
    else if (*service++ != ':' || !number_parse(service, 1, UINT16_MAX, &number) ||
             strlen(service) >= sizeof address->service)
        return "the port is a number from 1 to 65535, such as in tcp:192.168.1.20:502";
    (void)strcpy(address->service, service);
    return NULL;
}

/* ---- keys ---- */

static int32_t pin(const port_keys_t *keys, port_key_t key)
{
    return keys->has[key] ? (int32_t)(keys->value[key] & UINT16_MAX) : -1;
}

void port_options_take(port_options_t *port, const port_keys_t *defaults)
{
    port_keys_t *const keys = &port->keys;
    port->kind = port_kind(port->path);
    for (int key = 0; port->kind == PORT_SERIAL && key != PORT_KEYS; key++) {
        if (keys->has[key] || !defaults->has[key]) continue;
        keys->has[key] = true;
        keys->value[key] = defaults->value[key];
    }
    port->pins = (pin_options_t){.trigger = pin(keys, KEY_TRIGGER),
                                 .chip = keys->has[KEY_TRIGGER] ? (keys->value[KEY_TRIGGER] >> 16) + 1 : 0,
                                 .echo = pin(keys, KEY_PULSE),
                                 .in = pin(keys, KEY_IN),
                                 .bias = (uint8_t)keys->value[KEY_BIAS],
                                 .near = (uint8_t)keys->value[KEY_NEAR]};
}

/* Two stop bits take the place of the parity bit: a character has 11 bits either way (HPS-167S 2.2.2). */
void port_options_line(const port_options_t *port, fathom_line_settings_t *line)
{
    const port_keys_t *const keys = &port->keys;
    if (keys->has[KEY_BAUD]) line->baud = keys->value[KEY_BAUD];
    if (keys->has[KEY_STOP_BITS]) line->stop_bits = (uint8_t)keys->value[KEY_STOP_BITS];
    if (keys->value[KEY_STOP_BITS] == 2) line->parity = FATHOM_PARITY_NONE;
    if (keys->has[KEY_PARITY]) line->parity = (uint8_t)keys->value[KEY_PARITY];
}

/* ---- the settings of a line in words ---- */

const char *parity_name(uint8_t parity)
{
    static const char *const names[] = {
        [FATHOM_PARITY_NONE] = "none", [FATHOM_PARITY_EVEN] = "even", [FATHOM_PARITY_ODD] = "odd"};
    return names[parity];
}

const char *line_text(const fathom_line_settings_t *settings, char text[LINE_TEXT])
{
    static const char parities[] = "NEO";
    (void)snprintf(text, LINE_TEXT, "%" PRIu32 " 8%c%u", settings->baud, parities[settings->parity],
                   settings->stop_bits);
    return text;
}

/* ---- errors ---- */

/* A user who set FATHOM_PORT long ago needs to know why it is this port. */
fathom_status_t port_fail(port_t *port, port_error_t error, const char *format, ...)
{
    const bool is_named = error != PORT_LOST && strcmp(environment("FATHOM_PORT"), port->options.path) == 0;
    char text[sizeof port->error_text - 64];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    (void)snprintf(port->error_text, sizeof port->error_text, "%s%s", text,
                   is_named ? " (FATHOM_PORT in the environment names this port)" : "");
    port->error = error;
    return FATHOM_ERR_PORT;
}

static fathom_status_t fail_by(port_t *port, bool is_lost, bool is_absent, const char *text)
{
    return port_fail(port, is_lost ? PORT_LOST : is_absent ? PORT_ABSENT : PORT_FAILED, "%s", text);
}

/* ---- lines of a GPIO chip ---- */

static fathom_status_t fail_pins(port_t *port, const fathom_gpio_t *line)
{
    return fail_by(port, line->error == FATHOM_GPIO_ERR_LOST, line->error == FATHOM_GPIO_ERR_NOT_FOUND,
                   line->text);
}

static fathom_status_t open_pins(port_t *port, const char *chip)
{
    const host_t *const host = port->host;
    const fathom_gpio_t *line = port->pins.lines;
    if (host->open_pins(host->ctx, chip, &port->options.pins, &port->pins)) return FATHOM_OK;
    while (line->error == FATHOM_GPIO_OK && line != &port->pins.lines[PINS_LINES - 1]) line++;
    return fail_pins(port, line);
}

static fathom_status_t open_chip(port_t *port)
{
    const fathom_status_t status = open_pins(port, port->options.path);
    port->fd = port->pins.fd;
    return status;
}

static fathom_status_t poll_pins(port_t *port)
{
    for (size_t i = 0; i != PINS_LINES; i++)
        if (port->pins.lines[i].is_lost) return fail_pins(port, &port->pins.lines[i]);
    return FATHOM_OK;
}

static void close_pins(port_t *port) { port->host->close_pins(port->host->ctx, &port->pins); }

/* ---- a tty ---- */

static fathom_status_t fail_serial(port_t *port)
{
    const fathom_posix_status_t error = fathom_posix_error(&port->serial);
    holder_t holder = {.program = 0};
    if (error == FATHOM_POSIX_ERR_IN_USE) holder_find(&holder, &port->serial, port->name);
    if (holder.program != 0)
        return port_fail(port, PORT_FAILED, "%s: in use by another program: %s. %s, then try again",
                         port->name, holder.who, holder.stop);
    return fail_by(port, error == FATHOM_POSIX_ERR_LOST, error == FATHOM_POSIX_ERR_NOT_FOUND,
                   fathom_posix_error_text(&port->serial));
}

static bool has_trigger(const port_t *port) { return port->options.pins.chip != 0; }

static void close_serial(port_t *port)
{
    if (has_trigger(port)) close_pins(port);
    port->host->close(port->host->ctx, &port->serial);
}

/* The port is open: sets up what else belongs to it. */
static fathom_status_t set_up_serial(port_t *port)
{
    char chip[sizeof "gpiochip4294967295"];
    if (!adapter_open(&port->adapter))
        return port_fail(port, PORT_ABSENT, "%s: another adapter took this path", port->name);
    if (port->options.keys.value[KEY_RS485] != 0 &&
        fathom_posix_set_rs485(&port->serial, &(fathom_posix_rs485_t){0}) != FATHOM_POSIX_OK)
        return fail_serial(port);
    (void)snprintf(chip, sizeof chip, "gpiochip%" PRIu32, port->options.pins.chip - 1);
    return has_trigger(port) ? open_pins(port, chip) : FATHOM_OK;
}

/* A tty of Bluetooth: Documentation/admin-guide/devices.txt of Linux. */
static bool is_rfcomm(const port_t *port)
{
    enum { RFCOMM_MAJOR = 216 };
    struct stat status;
    return stat(port->name, &status) == 0 && S_ISCHR(status.st_mode) && major(status.st_rdev) == RFCOMM_MAJOR;
}

bool port_has_pieces(const port_t *port)
{
    return !port->has_wire || port->options.keys.value[KEY_PIECES] != 0 || is_rfcomm(port);
}

uint16_t port_stream_gap_us(const port_t *port)
{
    return port_has_pieces(port) ? PORT_PIECES_GAP_US : PORT_STREAM_GAP_US;
}

void port_set_line(port_t *port)
{
    port->parts.silence_us = fathom_silence_us(&port->options.line);
    port->parts.gap_us = port_has_pieces(port) ? FATHOM_LINE_NO_GAP : PORT_RESPONSE_GAP_US;
    port->parts.echo = (uint8_t)port->options.keys.value[KEY_ECHO];
    port->parts.senders = &fathom_line_senders;
    port->parts.masters = &fathom_line_masters;
}

static fathom_status_t open_serial(port_t *port)
{
    const port_options_t *const options = &port->options;
    const host_t *const host = port->host;
    const char *const reason = adapter_find(&port->adapter, options->path);
    if (port->adapter.path[0] != '\0') port->name = port->adapter.path;
    if (reason != NULL && reason[0] != '\0')
        return port_fail(port, PORT_FAILED, "%s: %s", port->name, reason);
    if (reason != NULL) return port_fail(port, PORT_ABSENT, "%s: the adapter is not plugged in", port->name);
    if (!host->open(host->ctx, port->name, &options->line, &port->serial, &port->inner))
        return fail_serial(port);
    if (set_up_serial(port) != FATHOM_OK) {
        close_serial(port);
        return FATHOM_ERR_PORT;
    }
    port->has_wire = !port->serial.is_pty;
    port->counts_errors = fathom_posix_line_errors(&port->serial, &port->errors) == FATHOM_POSIX_OK;
    port_set_line(port);
    return FATHOM_OK;
}

static fathom_status_t poll_serial(port_t *port)
{
    const char *const doubt = adapter_doubt(&port->adapter);
    if (doubt != NULL) return port_fail(port, PORT_LOST, "%s: %s", port->name, doubt);
    if (fathom_posix_error(&port->serial) == FATHOM_POSIX_ERR_LOST) return fail_serial(port);
    return has_trigger(port) ? poll_pins(port) : FATHOM_OK;
}

/* ---- the listener, between the line and the driver ---- */

static int listen_read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    port_t *const port = ctx;
    listener_t *const listener = port->listener.now != NULL ? port->listener.now : &port->listener;
    const int n = port->inner.read(port->inner.ctx, bytes, capacity, rx);
    if (n < 0) (void)port->driver->poll(port);
    if (port->driver->note_read != NULL) port->driver->note_read(port);
    if (n > 0 && (rx->flags & FATHOM_RX_NO_RESPONSE) == 0)
        listener_received(listener, bytes, (uint32_t)n, port->clock.now_us(port));
    return n;
}

static int listen_write(void *ctx, const uint8_t *bytes, size_t length)
{
    port_t *const port = ctx;
    listener_t *const own = &port->listener;
    const uint32_t asked_us = port->clock.now_us(port); /* a response may be there before the write returns */
    const int n = port->inner.write(port->inner.ctx, bytes, length);
    if (n < 0) (void)port->driver->poll(port);
    if (n <= 0 || length > LISTENER_REQUEST) return n;
    if (port->driver->note_sent != NULL) port->driver->note_sent(port);
    if (own->whose != NULL) own->now = own->whose(own->ctx);
    listener_sent(own->now != NULL ? own->now : own, bytes, (uint8_t)length, asked_us);
    return n;
}

static bool listen_sent(void *ctx)
{
    const port_t *const port = ctx;
    return port->inner.sent(port->inner.ctx);
}

static int listen_set_line(void *ctx, const fathom_line_settings_t *settings)
{
    const port_t *const port = ctx;
    return port->inner.set_line(port->inner.ctx, settings);
}

static int listen_set_break(void *ctx, bool on)
{
    const port_t *const port = ctx;
    return port->inner.set_break(port->inner.ctx, on);
}

static uint32_t listen_leaves_in_us(void *ctx)
{
    const port_t *const port = ctx;
    return port->inner.leaves_in_us(port->inner.ctx);
}

static void start_listener(port_t *port)
{
    const fathom_uart_t *const inner = &port->inner;
    port->uart = (fathom_uart_t){.read = listen_read,
                                 .write = listen_write,
                                 .sent = listen_sent,
                                 .set_line = inner->set_line != NULL ? listen_set_line : NULL,
                                 .set_break = inner->set_break != NULL ? listen_set_break : NULL,
                                 .leaves_in_us = inner->leaves_in_us != NULL ? listen_leaves_in_us : NULL,
                                 .ctx = port};
}

/* ---- opening ---- */

static uint32_t now_us(void *ctx)
{
    const port_t *const port = ctx;
    return (uint32_t)port->host->now_us(port->host->ctx);
}

static void start_line(port_t *port)
{
    if (port->source != NULL) {
        port->inner = fathom_loop_uart(port->source, &port->inner);
        port->source->reads_all = port->kind == PORT_SERIAL && port_fd(port) >= 0;
    }
    start_listener(port);
    port->parts.uart = &port->uart;
    port->parts.clock = &port->clock;
    port->parts.frame = port->frame;
    port->parts.frame_size = sizeof port->frame;
    port->parts.find_echo = fathom_line_find_echo;
    port->parts.marks = fathom_line_marks;
    port->parts.count = fathom_line_count;
    port->parts.counters = port->counters;
    (void)fathom_line_init(&port->line, &port->parts); /* all of it is there */
    if (port->driver->start_line != NULL) port->driver->start_line(port);
    port->modbus = fathom_modbus_client_with_zero(&port->line);
}

/* After each call of the driver that opens or connects. */
static fathom_status_t note_opening(port_t *port, fathom_status_t status)
{
    port->is_connecting = status == FATHOM_PENDING;
    if (status == FATHOM_ERR_PORT) port->failures = port->error == PORT_ABSENT ? 0 : port->failures + 1;
    if (status != FATHOM_OK) return status;
    port->failures = 0;
    port->listener.now = NULL;
    port->listener.request_length = 0;
    listener_forget(&port->listener);
    if (port->kind != PORT_PINS) start_line(port);
    return status;
}

fathom_status_t port_open(port_t *port, const host_t *host, const port_options_t *options,
                          fathom_loop_source_t *source)
{
    static const port_driver_t serial = {.open = open_serial, .poll = poll_serial, .close = close_serial};
    static const port_driver_t chip = {.open = open_chip, .poll = poll_pins, .close = close_pins};
    static const port_driver_t *const drivers[] = {
        [PORT_SERIAL] = &serial, [PORT_GATEWAY] = &port_tcp, [PORT_RAW] = &port_tcp, [PORT_PINS] = &chip};
    if (port->options.path == NULL || strcmp(port->options.path, options->path) != 0)
        memset(&port->adapter, 0, sizeof port->adapter);
    port->host = host;
    port->options = *options;
    port->name = options->path;
    port->kind = port_kind(options->path);
    port->driver = drivers[port->kind];
    port->source = source;
    port->clock = (fathom_clock_t){now_us, port};
    port->error = PORT_OK;
    port->error_text[0] = '\0';
    port->has_wire = true;
    port->counts_errors = false;
    port->gateway = (gateway_t){0};
    port->fd = -1;
    port->events = POLLIN;
    return note_opening(port, port->driver->open(port));
}

bool port_open_now(port_t *port, const host_t *host, const port_options_t *options)
{
    enum { LOOK_US = 500000 };
    fathom_status_t status = port_open(port, host, options, NULL);
    while (status == FATHOM_PENDING) {
        if (port_wait(port, LOOK_US) == FATHOM_OK) {
            status = port_poll(port);
            continue;
        }
        port_close(port);
        status = port_fail(port, PORT_FAILED,
                           "%s: the command was ended before the connection was established", port->name);
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

int port_fd(const port_t *port)
{
    return port->kind == PORT_SERIAL ? fathom_posix_fd(&port->serial) : port->fd;
}

short port_events(const port_t *port)
{
    return port->kind == PORT_SERIAL ? fathom_posix_poll_events(&port->serial) : port->events;
}

uint32_t port_due_us(const port_t *port)
{
    return port->driver->due_us != NULL ? port->driver->due_us(port) : FATHOM_NO_DEADLINE;
}

/* ---- waiting ---- */

static bool has_ended(const port_t *port)
{
    const host_t *const host = port->host;
    return host->has_ended(host->ctx) || (port->watches_output && host->is_output_gone(host->ctx));
}

fathom_status_t port_wait(port_t *port, uint32_t max_us)
{
    const host_t *const host = port->host;
    const uint32_t due_us = port_due_us(port);
    if (port->error == PORT_LOST) return FATHOM_ERR_PORT;
    if (due_us < max_us) max_us = due_us;
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
