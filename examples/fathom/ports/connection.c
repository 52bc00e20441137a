/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE 1 /* SOCK_NONBLOCK, getaddrinfo */
#include "ports/connection.h"

#include <errno.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "fathom/codec/dyp_55aa.h"
#include "fathom/codec/modbus_rtu.h"

/*
 * A TCP connection as a driver of port.h: to a Modbus TCP server (tcp.c), or to a converter that passes raw bytes.
 *
 * Many gateways close a connection that is idle, or each connection after a response. This is no failure:
 *
 *     FIRST --connected--> OPEN --ended, no response pending--> CLOSED --next request--> AGAIN --connected--> OPEN
 *                           |                                                             ^
 *                           +--ended within race_us of a read, which is sent again--------+
 *
 *  - A read changes nothing, so it may be sent again. A write is not: the attempt ends without a response.
 *  - What sends by itself sends no request for which to connect, so the driver connects at once.
 *  - The far end may refuse a connection until it has ended the previous one: attempts go on for REFUSED_US.
 *  - MOST_BARREN connections in a row that end before a response are a failure, and so is an attempt that fails.
 *    Pauses grow from one to the next.
 *
 * A host may have several addresses, which are tried one after another.
 */
enum {
    CONNECT_US = 5000000,
    REFUSED_US = 900000, /* the line gives a request up after 1 s (FATHOM_LINE_SEND_US) */
    PAUSE_US = 50000,
    STEADY_US = 1000000,
    MOST_BARREN = 5,
    SILENT_MS = 10000 /* the far end has to acknowledge what was sent */
};

static uint64_t now_us(const port_t *port) { return port->host->now_us(port->host->ctx); }

/* ---- sockets ---- */

static const char *advice_for(const port_t *port, int error)
{
    switch (error) {
    case ECONNREFUSED:
        if (port->kind == PORT_RAW) return "nothing serves this port; check its number in the converter";
        return "nothing serves this port; check it (502 is usual), and that Modbus TCP is switched on there";
    case ETIMEDOUT:
        return "nothing answers at this address; check it, the supply of what should be there, and firewalls";
    case EHOSTUNREACH:
    case ENETUNREACH:
    case EADDRNOTAVAIL:
        return "there is no way to this address; check it, and the network of this machine";
    case ECONNRESET:
        return "the far end ends each connection; some serve one program at a time, so check whether another "
               "one "
               "is connected";
    default:
        return "the connection failed";
    }
}

static fathom_status_t fail(port_t *port, port_error_t how, int error)
{
    return port_fail(port, how, "%s: %s: %s", port->name, strerror(error), advice_for(port, error));
}

static void close_socket(port_t *port)
{
    if (port->fd < 0) return;
    (void)close(port->fd);
    port->fd = -1;
    if (port->source != NULL) fathom_loop_renew(port->source);
}

/* Starts to connect to an address. Returns 0 or the error. */
static int start_connecting(port_t *port, const struct addrinfo *to)
{
    const int on = 1;
    const unsigned silent_ms = SILENT_MS;
    connection_t *const connection = port->connection;
    port->fd = socket(to->ai_family, to->ai_socktype | SOCK_NONBLOCK | SOCK_CLOEXEC, to->ai_protocol);
    if (port->fd < 0) return errno;
    port->events = POLLOUT;
    connection->present = to;
    connection->due_us = now_us(port) + CONNECT_US;
    /* A request is small, and waits for nothing. */
    (void)setsockopt(port->fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    (void)setsockopt(port->fd, IPPROTO_TCP, TCP_USER_TIMEOUT, &silent_ms, sizeof silent_ms);
    return connect(port->fd, to->ai_addr, to->ai_addrlen) == 0 || errno == EINPROGRESS ? 0 : errno;
}

/* Goes on to the next address of the host after an error of the present one. Returns 0, or the error of the last one. */
static int connect_next(port_t *port, int error)
{
    connection_t *const connection = port->connection;
    do {
        close_socket(port);
        if (connection->next == NULL) return error;
        error = start_connecting(port, connection->next);
        connection->next = connection->next->ai_next;
    } while (error != 0);
    return 0;
}

/* Returns 0 if the socket is connected, EINPROGRESS, or the error of the last address. */
static int poll_socket(port_t *port)
{
    struct pollfd entry = {port->fd, POLLOUT, 0};
    int error = 0;
    socklen_t length = sizeof error;
    if (poll(&entry, 1, 0) <= 0) {
        if (now_us(port) < port->connection->due_us) return EINPROGRESS;
        error = ETIMEDOUT;
    } else if (getsockopt(port->fd, SOL_SOCKET, SO_ERROR, &error, &length) != 0) {
        error = errno;
    }
    if (error == 0) return 0;
    error = connect_next(port, error);
    return error == 0 ? EINPROGRESS : error;
}

/* ---- again ---- */

/* Returns true if an attempt is on the wire, as the line knows since its last poll. */
static bool is_pending(const port_t *port)
{
    return port->connection->length != 0 && !fathom_line_is_idle(&port->line);
}

static void connect_again(port_t *port)
{
    connection_t *const connection = port->connection;
    const unsigned pauses = port->barren > 1 ? 1u << (port->barren - 2) : 0;
    connection->state = CONNECTION_AGAIN;
    connection->due_us = now_us(port) + (uint64_t)pauses * PAUSE_US;
    if (port->barren <= 1) connection->until_us = connection->due_us + REFUSED_US;
}

/* Returns false if the port is lost: several connections in a row ended without a response. */
static bool note_barren(port_t *port)
{
    const char *const who = port->connection->kind->far_end;
    if (++port->barren < MOST_BARREN) return true;
    (void)port_fail(port, PORT_LOST,
                    "%s: the %s closes each connection without a response%s; some serve one program at a "
                    "time, so check whether another one is connected",
                    port->name, who,
                    port->kind == PORT_RAW ? " (one that expects Modbus TCP does this too: use tcp:)" : "");
    return false;
}

/* A connection has ended before anything of a request left. False: the port is lost. */
static bool end_unsent(port_t *port)
{
    if (port->connection->kind->judge(port) != FATHOM_OK || !note_barren(port)) return false;
    close_socket(port);
    connect_again(port);
    return true;
}

/* There is a new connection. False: it cannot be used. */
static bool take_connection(port_t *port)
{
    connection_t *const connection = port->connection;
    const bool is_again = connection->state == CONNECTION_AGAIN;
    if (!connection->kind->start(port)) return false;
    port->events = POLLIN;
    connection->state = CONNECTION_OPEN;
    connection->opened_us = now_us(port);
    connection->is_used = false;
    if (is_again) port->reconnects++;
    if (connection->sends_again && is_pending(port) &&
        connection->bytes.write(connection->bytes.ctx, connection->request, connection->length) < 0)
        return end_unsent(port);
    connection->sends_again = false;
    return true;
}

/* Goes on with connecting again. */
static void step(port_t *port)
{
    connection_t *const connection = port->connection;
    int error = EINPROGRESS;
    if (port->error != PORT_OK || connection->state != CONNECTION_AGAIN) return;
    if (port->fd >= 0) {
        error = poll_socket(port);
    } else if (now_us(port) >= connection->due_us) {
        connection->next = connection->addresses;
        error = start_connecting(port, connection->present);
        if (error != 0) error = connect_next(port, error);
        if (error == 0) error = EINPROGRESS;
    }
    if (error == EINPROGRESS) return;
    if (error == 0)
        (void)take_connection(port);
    else if (now_us(port) < connection->until_us)
        connection->due_us = now_us(port) + 2 * PAUSE_US;
    else
        (void)fail(port, PORT_LOST, error);
}

/* ---- the end of a connection ---- */

/* A request that changes nothing: a Modbus function that reads, or a measurement of 55 AA. */
static bool is_read(const connection_t *connection)
{
    enum { FUNCTION = 1, COMMAND = 3, LAST_READ = 4 };
    const uint8_t *const request = connection->request;
    if (request[0] == 0x55 && request[FUNCTION] == 0xAA)
        return fathom_dyp_55aa_value_count(request[COMMAND]) != 0;
    return request[FUNCTION] <= LAST_READ;
}

/* The connection ended while a response was pending. Returns as `read` of the UART. */
static int end_pending(port_t *port, uint8_t *bytes, fathom_rx_t *rx)
{
    connection_t *const connection = port->connection;
    const bool is_race = now_us(port) - connection->sent_us <= connection->kind->race_us;
    port->gateway.is_closed = true;
    if (is_race && is_read(connection)) {
        connect_again(port);
        connection->sends_again = true;
        return 0;
    }
    bytes[0] = 0;
    rx->flags |= FATHOM_RX_NO_RESPONSE;
    return 1;
}

/* `bytes` has returned an error. Returns as `read` of the UART. */
static int end(port_t *port, uint8_t *bytes, fathom_rx_t *rx)
{
    connection_t *const connection = port->connection;
    const bool is_steady = now_us(port) - connection->opened_us >= STEADY_US;
    const bool was_pending = is_pending(port);
    if (connection->kind->judge(port) != FATHOM_OK) return -1;
    close_socket(port);
    connection->state = CONNECTION_CLOSED;
    if (!connection->is_used && (was_pending || !is_steady) && !note_barren(port)) return -1;
    if (was_pending) return end_pending(port, bytes, rx);
    if (port->kind == PORT_RAW && connection->length == 0) connect_again(port);
    return 0;
}

/* ---- the UART ---- */

static int read_bytes(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    port_t *const port = ctx;
    connection_t *const connection = port->connection;
    step(port);
    if (port->error != PORT_OK) return -1;
    if (connection->state != CONNECTION_OPEN) return 0;
    const int n = connection->bytes.read(connection->bytes.ctx, bytes, capacity, rx);
    if (n > 0) {
        port->barren = 0;
        connection->is_used = true;
    }
    return n < 0 ? end(port, bytes, rx) : n;
}

static int write_bytes(void *ctx, const uint8_t *bytes, size_t length)
{
    port_t *const port = ctx;
    connection_t *const connection = port->connection;
    connection->sends_again = false;
    if (connection->state == CONNECTION_CLOSED) connect_again(port);
    step(port);
    if (port->error != PORT_OK) return -1;
    if (connection->state != CONNECTION_OPEN) return 0;
    const int n = connection->bytes.write(connection->bytes.ctx, bytes, length);
    if (n < 0) return end_unsent(port) ? 0 : -1;
    if (n == 0 || length > sizeof connection->request) return n;
    memcpy(connection->request, bytes, length);
    connection->length = (uint8_t)length;
    connection->sent_us = now_us(port);
    port->gateway.is_closed = false;
    return n;
}

static bool is_sent(void *ctx)
{
    (void)ctx;
    return true;
}

uint32_t connection_due_us(const port_t *port)
{
    const connection_t *const connection = port->connection;
    if (connection == NULL || connection->state != CONNECTION_AGAIN) return FATHOM_NO_DEADLINE;
    const uint64_t at_us = now_us(port);
    return connection->due_us > at_us ? (uint32_t)(connection->due_us - at_us) : 0;
}

/* While it connects, there is nothing to send to. */
static uint32_t leaves_in_us(void *ctx)
{
    const uint32_t us = connection_due_us(ctx);
    return us != FATHOM_NO_DEADLINE ? us : 0;
}

/* ---- the driver ---- */

fathom_status_t connection_poll(port_t *port)
{
    connection_t *const connection = port->connection;
    if (port->error != PORT_OK) return FATHOM_ERR_PORT;
    if (connection->state != CONNECTION_FIRST) {
        step(port);
        return port->error == PORT_OK ? FATHOM_OK : FATHOM_ERR_PORT;
    }
    const int error = poll_socket(port);
    if (error == EINPROGRESS) return FATHOM_PENDING;
    if (error != 0) (void)fail(port, PORT_ABSENT, error);
    if (error == 0 && take_connection(port)) {
        port->inner = (fathom_uart_t){.read = read_bytes,
                                      .write = write_bytes,
                                      .sent = is_sent,
                                      .leaves_in_us = leaves_in_us,
                                      .ctx = port};
        return FATHOM_OK;
    }
    connection_close(port);
    return FATHOM_ERR_PORT;
}

void connection_close(port_t *port)
{
    connection_t *const connection = port->connection;
    if (connection == NULL) return;
    close_socket(port);
    if (connection->kind->stop != NULL) connection->kind->stop(port);
    if (connection->addresses != NULL) freeaddrinfo(connection->addresses);
    free(connection);
    port->connection = NULL;
}

static fathom_status_t look_up(port_t *port)
{
    const struct addrinfo hints = {.ai_family = AF_UNSPEC, .ai_socktype = SOCK_STREAM};
    connection_t *const connection = port->connection;
    const char *const wrong = tcp_parse(port->options.path, &connection->address);
    if (wrong != NULL) return port_fail(port, PORT_FAILED, "%s: %s", port->name, wrong);
    int error =
        getaddrinfo(connection->address.host, connection->address.service, &hints, &connection->addresses);
    if (error != 0)
        return port_fail(port, error == EAI_AGAIN ? PORT_ABSENT : PORT_FAILED,
                         "%s: the host is not known: %s; check its name, or give its address in numbers",
                         port->name, gai_strerror(error));
    connection->next = connection->addresses;
    error = connect_next(port, 0);
    return error == 0 ? FATHOM_PENDING : fail(port, PORT_ABSENT, error);
}

fathom_status_t connection_open(port_t *port, const connection_kind_t *kind)
{
    port->connection = calloc(1, sizeof *port->connection);
    if (port->connection == NULL) return port_fail(port, PORT_FAILED, "%s: %s", port->name, strerror(ENOMEM));
    port->connection->kind = kind;
    if (port->barren >= MOST_BARREN)
        port->barren = MOST_BARREN - 1; /* one more shows whether it is well again */
    const fathom_status_t status = look_up(port);
    if (status == FATHOM_ERR_PORT) connection_close(port);
    return status;
}

/* ---- raw bytes: Modbus RTU and the protocols of a serial line ---- */

static int fail_raw(int error) { return error == EAGAIN || error == EWOULDBLOCK || error == EINTR ? 0 : -1; }

static int read_raw(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    const port_t *const port = ctx;
    const ssize_t n = recv(port->fd, bytes, capacity, MSG_DONTWAIT);
    (void)rx; /* nothing is known about single bytes */
    if (n < 0) return fail_raw(errno);
    return n == 0 ? -1 : (int)n;
}

static int write_raw(void *ctx, const uint8_t *bytes, size_t length)
{
    const port_t *const port = ctx;
    const ssize_t n = send(port->fd, bytes, length, MSG_DONTWAIT | MSG_NOSIGNAL);
    return n < 0 ? fail_raw(errno) : (int)n;
}

static bool start_raw(port_t *port)
{
    port->connection->bytes = (fathom_uart_t){.read = read_raw, .write = write_raw, .ctx = port};
    port->has_wire = false;
    port_set_line(port);
    return true;
}

static fathom_status_t judge_raw(port_t *port)
{
    (void)port;
    return FATHOM_OK;
}

const connection_kind_t connection_raw = {start_raw, judge_raw, NULL, "converter", 20000};
