/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE 1 /* SOCK_NONBLOCK, getaddrinfo */
#include <errno.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "fathom_libmodbus.h"
#include "ports/port.h"
#include "ports/tcp_address.h"

/* A connection to a Modbus TCP server as a driver of port.h: a UART that carries RTU frames, by port/libmodbus. A host may
 * have several addresses, which are tried one after another. */
enum { CONNECT_US = 5000000 };

typedef struct tcp {
    port_t *port;
    tcp_address_t address;
    struct addrinfo *addresses;  /* of the host, as long as it connects */
    const struct addrinfo *next; /* to try if the present one fails */
    int fd;                      /* -1: none */
    uint64_t deadline_us;        /* of the present address */
    fathom_libmodbus_t libmodbus;
    modbus_t *modbus;    /* NULL: it connects */
    fathom_uart_t inner; /* that of libmodbus */
} tcp_t;

/* ---- a connection ---- */

/* Explains why the server is lost. Some servers serve one program at a time. */
static void lose(const tcp_t *tcp)
{
    static const char alone[] = "; some serve one program at a time: is another one connected?";
    const int error = tcp->libmodbus.system_error;
    port_t *const port = tcp->port;
    if (port->error == PORT_LOST) return;
    switch (fathom_libmodbus_error(&tcp->libmodbus)) {
    case FATHOM_LIBMODBUS_ERR_NONSENSE:
        (void)port_fail(
            port, PORT_LOST,
            "the received bytes are not Modbus TCP. Check the port number (usually 502) and the server");
        break;
    case FATHOM_LIBMODBUS_ERR_TRUNCATED:
        (void)port_fail(port, PORT_LOST, "the system accepted only a part of a request");
        break;
    case FATHOM_LIBMODBUS_ERR_SYSTEM:
        if (error == ECONNRESET || error == EPIPE)
            (void)port_fail(port, PORT_LOST, "the server reset the connection%s", alone);
        else
            (void)port_fail(port, PORT_LOST, "%s", strerror(error));
        break;
    default:
        (void)port_fail(port, PORT_LOST, "the server closed the connection%s", alone);
        break;
    }
}

static int read_bytes(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    tcp_t *const tcp = ctx;
    const int n = tcp->inner.read(tcp->inner.ctx, bytes, capacity, rx);
    if (n < 0) lose(tcp);
    tcp->port->gateway_exception = tcp->libmodbus.gateway_exception;
    return n;
}

static int write_bytes(void *ctx, const uint8_t *bytes, size_t length)
{
    tcp_t *const tcp = ctx;
    const int n = tcp->inner.write(tcp->inner.ctx, bytes, length);
    if (n < 0) lose(tcp);
    if (n > 0) tcp->port->gateway_exception = tcp->libmodbus.gateway_exception = 0;
    return n;
}

static bool is_sent(void *ctx)
{
    tcp_t *const tcp = ctx;
    return tcp->inner.sent(tcp->inner.ctx);
}

/* The connection is established: the line on it. Responses arrive whole, and need no silence between them. The server
 * assigns each response to its request. */
static fathom_status_t start(tcp_t *tcp)
{
    port_t *const port = tcp->port;
    tcp->modbus = modbus_new_tcp_pi(tcp->address.host, tcp->address.service);
    if (tcp->modbus == NULL) return port_fail(port, PORT_FAILED, "%s", strerror(ENOMEM));
    (void)modbus_set_socket(tcp->modbus, tcp->fd);
    const fathom_libmodbus_config_t config = {.clock = &port->clock};
    (void)fathom_libmodbus_init(&tcp->libmodbus, tcp->modbus, &config); /* all of it is there */
    tcp->inner = fathom_libmodbus_uart(&tcp->libmodbus);
    port->uart = (fathom_uart_t){.read = read_bytes, .write = write_bytes, .sent = is_sent, .ctx = tcp};
    port->parts.silence_us = 100; /* the least (line.h) */
    port->parts.gap_us = 1000;
    port->parts.echo = FATHOM_LINE_ECHO_OFF;
    port->parts.senders = NULL;
    port->parts.masters = NULL;
    return FATHOM_OK;
}

/* ---- connecting ---- */

static const char *advice_for(int error)
{
    switch (error) {
    case ECONNREFUSED:
        return "nothing serves this port; check it (502 is usual), and that Modbus TCP is switched on there";
    case ETIMEDOUT:
        return "nothing answers at this address; check it, the supply of what should be there, and firewalls";
    case EHOSTUNREACH:
    case ENETUNREACH:
    case EADDRNOTAVAIL:
        return "there is no way to this address; check it, and the network of this machine";
    default:
        return "the connection failed";
    }
}

/* Starts to connect to an address. Returns 0 or the error. */
static int start_connecting(tcp_t *tcp, const struct addrinfo *to)
{
    const int on = 1;
    tcp->fd = socket(to->ai_family, to->ai_socktype | SOCK_NONBLOCK | SOCK_CLOEXEC, to->ai_protocol);
    if (tcp->fd < 0) return errno;
    /* A request is small, and waits for nothing. */
    (void)setsockopt(tcp->fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    tcp->deadline_us = fathom_posix_now_us() + CONNECT_US;
    return connect(tcp->fd, to->ai_addr, to->ai_addrlen) == 0 || errno == EINPROGRESS ? 0 : errno;
}

/* Goes on to the next address of the host after an error of the present one. */
static fathom_status_t connect_next(tcp_t *tcp, int error)
{
    do {
        if (tcp->fd >= 0) (void)close(tcp->fd);
        tcp->fd = -1;
        if (tcp->next == NULL)
            return port_fail(tcp->port, PORT_ABSENT, "%s: %s", strerror(error), advice_for(error));
        error = start_connecting(tcp, tcp->next);
        tcp->next = tcp->next->ai_next;
    } while (error != 0);
    return FATHOM_PENDING;
}

static int connect_error(int fd)
{
    struct pollfd entry = {fd, POLLOUT, 0};
    if (poll(&entry, 1, 0) <= 0) return EINPROGRESS;
    int error = 0;
    socklen_t length = sizeof error;
    return getsockopt(fd, SOL_SOCKET, SO_ERROR, &error, &length) == 0 ? error : errno;
}

/* ---- the driver ---- */

static void close_tcp(port_t *port)
{
    tcp_t *const tcp = port->tcp;
    port->tcp = NULL;
    if (tcp == NULL) return;
    if (tcp->addresses != NULL) freeaddrinfo(tcp->addresses);
    if (tcp->modbus != NULL) {
        modbus_close(tcp->modbus);
        modbus_free(tcp->modbus);
    } else if (tcp->fd >= 0) {
        (void)close(tcp->fd);
    }
    free(tcp);
}

static fathom_status_t poll_tcp(port_t *port)
{
    tcp_t *const tcp = port->tcp;
    if (tcp->modbus != NULL) return port->error == PORT_OK ? FATHOM_OK : FATHOM_ERR_PORT;
    int error = connect_error(tcp->fd);
    if (error == EINPROGRESS && fathom_posix_now_us() < tcp->deadline_us) return FATHOM_PENDING;
    if (error == EINPROGRESS) error = ETIMEDOUT;
    const fathom_status_t status = error != 0 ? connect_next(tcp, error) : start(tcp);
    if (status == FATHOM_ERR_PORT) close_tcp(port);
    return status;
}

static fathom_status_t open_tcp(port_t *port)
{
    const struct addrinfo hints = {.ai_family = AF_UNSPEC, .ai_socktype = SOCK_STREAM};
    tcp_address_t address;
    const char *const wrong = tcp_parse(port->settings.path, &address);
    if (wrong != NULL) return port_fail(port, PORT_FAILED, "%s", wrong);
    tcp_t *const tcp = calloc(1, sizeof *tcp);
    if (tcp == NULL) return port_fail(port, PORT_FAILED, "%s", strerror(ENOMEM));
    tcp->port = port;
    tcp->address = address;
    tcp->fd = -1;
    port->tcp = tcp;
    const int looked_up = getaddrinfo(address.host, address.service, &hints, &tcp->addresses);
    fathom_status_t status = FATHOM_ERR_PORT;
    if (looked_up != 0) {
        tcp->addresses = NULL;
        (void)port_fail(port, looked_up == EAI_AGAIN ? PORT_ABSENT : PORT_FAILED,
                        "the host is not known: %s; check its name, or give its address in numbers",
                        gai_strerror(looked_up));
    } else {
        tcp->next = tcp->addresses;
        status = connect_next(tcp, 0);
    }
    if (status == FATHOM_ERR_PORT) close_tcp(port);
    return status;
}

static int tcp_fd(const port_t *port) { return port->tcp != NULL ? port->tcp->fd : -1; }

static short tcp_events(const port_t *port)
{
    return port->tcp != NULL && port->tcp->modbus == NULL ? POLLOUT : POLLIN;
}

const port_driver_t port_tcp = {open_tcp, poll_tcp, close_tcp, tcp_fd, tcp_events};
