/* SPDX-License-Identifier: MIT */
#include "ports/tcp.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "fathom_libmodbus.h"
#include "ports/tcp_address.h"

struct tcp {
    fathom_libmodbus_t libmodbus;
    fathom_uart_t inner; /* its HAL, behind ours */
    fathom_clock_t clock;
    modbus_t *modbus; /* NULL: the connection is under way */
    tcp_address_t address;
    uint64_t deadline_us;
    fathom_posix_uart_t *port; /* what stands in for the connection */
};

static void say(fathom_posix_uart_t *port, fathom_posix_status_t error, const char *text)
{
    port->error = error;
    (void)snprintf(port->text, sizeof port->text, "%s: %s", port->path, text);
}

static void lose(const tcp_t *tcp)
{
    static const char alone[] = "; some serve one program at a time: is another one connected?";
    char text[200];
    const char *what = "the server closed the connection";
    const char *advice = alone;
    if (tcp->port->is_lost) return;
    switch (fathom_libmodbus_error(&tcp->libmodbus)) {
    case FATHOM_LIBMODBUS_ERR_NONSENSE:
        what = "what was answered is no Modbus TCP";
        advice = "; check the port (502 is usual), and that it is no server of something else";
        break;
    case FATHOM_LIBMODBUS_ERR_TRUNCATED:
        what = "the system took a part of a request only";
        advice = "";
        break;
    case FATHOM_LIBMODBUS_ERR_SYSTEM:
        what = strerror(tcp->libmodbus.system_error);
        if (tcp->libmodbus.system_error == ECONNRESET || tcp->libmodbus.system_error == EPIPE)
            what = "the server reset the connection";
        else
            advice = "";
        break;
    default:
        break;
    }
    tcp->port->is_lost = true;
    (void)snprintf(text, sizeof text, "%s%s", what, advice);
    say(tcp->port, FATHOM_POSIX_ERR_LOST, text);
}

static int tcp_read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    tcp_t *const tcp = ctx;
    const int n = tcp->inner.read(tcp->inner.ctx, bytes, capacity, rx);
    if (n < 0) lose(tcp);
    return n;
}

static int tcp_write(void *ctx, const uint8_t *bytes, size_t length)
{
    tcp_t *const tcp = ctx;
    const int n = tcp->inner.write(tcp->inner.ctx, bytes, length);
    if (n < 0) lose(tcp);
    if (n > 0) tcp->libmodbus.gateway_exception = 0;
    return n;
}

static bool tcp_sent(void *ctx)
{
    tcp_t *const tcp = ctx;
    return tcp->inner.sent(tcp->inner.ctx);
}

/* The connection stands. False: no memory. */
static bool begin(tcp_t *tcp, fathom_uart_t *uart)
{
    tcp->modbus = modbus_new_tcp_pi(tcp->address.host, tcp->address.service);
    if (tcp->modbus == NULL) return false;
    (void)modbus_set_socket(tcp->modbus, tcp->port->fd);
    tcp->clock = fathom_posix_clock();
    const fathom_libmodbus_config_t config = {.clock = &tcp->clock};
    (void)fathom_libmodbus_init(&tcp->libmodbus, tcp->modbus, &config); /* all of it is there */
    tcp->inner = fathom_libmodbus_uart(&tcp->libmodbus);
    *uart = (fathom_uart_t){.read = tcp_read, .write = tcp_write, .sent = tcp_sent, .ctx = tcp};
    return true;
}

/* With a connection that stands, or, where there is a turn, is under way. NULL: *port has the error. */
static tcp_t *new_tcp(const char *path, const unsigned *turn, fathom_posix_uart_t *port)
{
    tcp_address_t address;
    char text[200];
    bool may_pass = false;
    memset(port, 0, sizeof *port);
    (void)snprintf(port->path, sizeof port->path, "%s", path);
    const char *const wrong = tcp_parse(path, &address);
    if (wrong != NULL) {
        say(port, FATHOM_POSIX_ERR_ARGUMENT, wrong);
        return NULL;
    }
    const int fd = turn == NULL ? tcp_connect(&address, text, sizeof text, &may_pass)
                                : tcp_connect_begin(&address, *turn, text, sizeof text, &may_pass);
    if (fd < 0) {
        say(port, may_pass ? FATHOM_POSIX_ERR_NOT_FOUND : FATHOM_POSIX_ERR_SYSTEM, text);
        return NULL;
    }
    tcp_t *const tcp = calloc(1, sizeof *tcp);
    if (tcp == NULL) {
        (void)close(fd);
        say(port, FATHOM_POSIX_ERR_SYSTEM, strerror(ENOMEM));
        return NULL;
    }
    tcp->address = address;
    tcp->deadline_us = fathom_posix_now_us() + TCP_CONNECT_S * 1000000u;
    tcp->port = port;
    port->fd = fd;
    port->is_open = true;
    return tcp;
}

tcp_t *tcp_open(const char *path, fathom_posix_uart_t *port, fathom_uart_t *uart)
{
    tcp_t *const tcp = new_tcp(path, NULL, port);
    if (tcp == NULL || begin(tcp, uart)) return tcp;
    tcp_close(tcp);
    say(port, FATHOM_POSIX_ERR_SYSTEM, strerror(ENOMEM));
    return NULL;
}

tcp_t *tcp_begin(const char *path, unsigned turn, fathom_posix_uart_t *port)
{
    return new_tcp(path, &turn, port);
}

fathom_status_t tcp_go_on(tcp_t *tcp, fathom_uart_t *uart)
{
    char text[200];
    int error = tcp_connect_look(tcp->port->fd);
    if (error == EINPROGRESS && fathom_posix_now_us() < tcp->deadline_us) return FATHOM_PENDING;
    if (error == EINPROGRESS) error = ETIMEDOUT;
    if (error == 0 && begin(tcp, uart)) return FATHOM_OK;
    tcp_connect_text(error != 0 ? error : ENOMEM, text, sizeof text);
    say(tcp->port, FATHOM_POSIX_ERR_NOT_FOUND, text);
    return FATHOM_ERR_PORT;
}

void tcp_close(tcp_t *tcp)
{
    if (tcp == NULL) return;
    tcp->port->is_open = false;
    if (tcp->modbus == NULL) {
        (void)close(tcp->port->fd);
    } else {
        modbus_close(tcp->modbus);
        modbus_free(tcp->modbus);
    }
    free(tcp);
}

uint8_t tcp_gateway_exception(const tcp_t *tcp) { return tcp->libmodbus.gateway_exception; }
