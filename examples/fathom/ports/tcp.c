/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE 1 /* SOCK_NONBLOCK, getaddrinfo */
#include <errno.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "fathom_libmodbus.h"
#include "ports/port.h"

/* A connection to a Modbus TCP server as a driver of port.h: a UART that carries RTU frames, by port/libmodbus. A host may
 * have several addresses, which are tried one after another. */
enum { CONNECT_US = 5000000 };

typedef struct tcp {
    tcp_address_t address;
    struct addrinfo *addresses;  /* of the host */
    const struct addrinfo *next; /* to try if the present one fails */
    uint64_t deadline_us;        /* of the present address */
    fathom_libmodbus_t libmodbus;
    modbus_t *modbus; /* NULL: it connects */
} tcp_t;

static void close_tcp(port_t *port)
{
    tcp_t *const tcp = port->tcp;
    if (port->fd >= 0) (void)close(port->fd);
    port->fd = -1;
    port->tcp = NULL;
    if (tcp == NULL) return;
    if (tcp->addresses != NULL) freeaddrinfo(tcp->addresses);
    if (tcp->modbus != NULL) modbus_free(tcp->modbus);
    free(tcp);
}

/* ---- a connection ---- */

/* Explains why the server is lost. Some servers serve one program at a time. */
static fathom_status_t lose(port_t *port)
{
    static const char alone[] = "some serve one program at a time: is another one connected?";
    const int error = port->tcp->libmodbus.system_error;
    switch (fathom_libmodbus_error(&port->tcp->libmodbus)) {
    case FATHOM_LIBMODBUS_ERR_NONSENSE:
        return port_fail(
            port, PORT_LOST,
            "%s: the received bytes are not Modbus TCP. Check the port number (usually 502) and the server",
            port->name);
    case FATHOM_LIBMODBUS_ERR_TRUNCATED:
        return port_fail(port, PORT_LOST, "%s: the system accepted only a part of a request", port->name);
    case FATHOM_LIBMODBUS_ERR_SYSTEM:
        if (error != ECONNRESET && error != EPIPE)
            return port_fail(port, PORT_LOST, "%s: %s", port->name, strerror(error));
        return port_fail(port, PORT_LOST, "%s: the server reset the connection; %s", port->name, alone);
    default:
        return port_fail(port, PORT_LOST, "%s: the server closed the connection; %s", port->name, alone);
    }
}

/* The connection is established: the line on it. Responses arrive whole, and need no silence between them. The server
 * assigns each response to its request. */
static fathom_status_t start(port_t *port)
{
    tcp_t *const tcp = port->tcp;
    const fathom_libmodbus_config_t config = {.clock = &port->clock};
    tcp->modbus = modbus_new_tcp_pi(tcp->address.host, tcp->address.service);
    if (tcp->modbus == NULL) return port_fail(port, PORT_FAILED, "%s: %s", port->name, strerror(ENOMEM));
    (void)modbus_set_socket(tcp->modbus, port->fd);
    (void)fathom_libmodbus_init(&tcp->libmodbus, tcp->modbus, &config); /* all of it is there */
    port->inner = fathom_libmodbus_uart(&tcp->libmodbus);
    port->events = POLLIN;
    port->parts.silence_us = 100; /* the least (line.h) */
    port->parts.gap_us = 1000;
    port->parts.echo = FATHOM_LINE_ECHO_OFF;
    port->parts.senders = NULL;
    port->parts.masters = NULL;
    return FATHOM_OK;
}

static void start_line(port_t *port)
{
    port->parts.marks = fathom_line_refusals;
    fathom_libmodbus_hold(&port->tcp->libmodbus, &port->line);
}

static void note_sent(port_t *port)
{
    fathom_libmodbus_t *const libmodbus = &port->tcp->libmodbus;
    libmodbus->other_units = 0;
    libmodbus->foreign_responses = 0;
}

static void note_read(port_t *port)
{
    if (port->tcp == NULL) return;
    const fathom_libmodbus_t *const libmodbus = &port->tcp->libmodbus;
    port->gateway = (gateway_t){.exception = libmodbus->gateway_exception,
                                .exception_unit = libmodbus->gateway_unit,
                                .other_unit = libmodbus->other_unit,
                                .has_other_unit = libmodbus->other_units != 0,
                                .has_other_identifier = libmodbus->foreign_responses != 0};
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
static int start_connecting(port_t *port, const struct addrinfo *to)
{
    const int on = 1;
    port->fd = socket(to->ai_family, to->ai_socktype | SOCK_NONBLOCK | SOCK_CLOEXEC, to->ai_protocol);
    if (port->fd < 0) return errno;
    /* A request is small, and waits for nothing. */
    (void)setsockopt(port->fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    port->tcp->deadline_us = fathom_posix_now_us() + CONNECT_US;
    return connect(port->fd, to->ai_addr, to->ai_addrlen) == 0 || errno == EINPROGRESS ? 0 : errno;
}

/* Goes on to the next address of the host after an error of the present one. */
static fathom_status_t connect_next(port_t *port, int error)
{
    tcp_t *const tcp = port->tcp;
    do {
        if (port->fd >= 0) (void)close(port->fd);
        port->fd = -1;
        if (tcp->next == NULL)
            return port_fail(port, PORT_ABSENT, "%s: %s: %s", port->name, strerror(error), advice_for(error));
        error = start_connecting(port, tcp->next);
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

static fathom_status_t poll_tcp(port_t *port)
{
    tcp_t *const tcp = port->tcp;
    if (port->error != PORT_OK) return FATHOM_ERR_PORT;
    if (tcp->modbus != NULL)
        return fathom_libmodbus_error(&tcp->libmodbus) == FATHOM_LIBMODBUS_OK ? FATHOM_OK : lose(port);
    int error = connect_error(port->fd);
    if (error == EINPROGRESS && fathom_posix_now_us() < tcp->deadline_us) return FATHOM_PENDING;
    if (error == EINPROGRESS) error = ETIMEDOUT;
    const fathom_status_t status = error != 0 ? connect_next(port, error) : start(port);
    if (status == FATHOM_ERR_PORT) close_tcp(port);
    return status;
}

static fathom_status_t look_up(port_t *port)
{
    const struct addrinfo hints = {.ai_family = AF_UNSPEC, .ai_socktype = SOCK_STREAM};
    tcp_t *const tcp = port->tcp;
    const char *const wrong = tcp_parse(port->options.path, &tcp->address);
    if (wrong != NULL) return port_fail(port, PORT_FAILED, "%s: %s", port->name, wrong);
    const int error = getaddrinfo(tcp->address.host, tcp->address.service, &hints, &tcp->addresses);
    if (error != 0)
        return port_fail(port, error == EAI_AGAIN ? PORT_ABSENT : PORT_FAILED,
                         "%s: the host is not known: %s; check its name, or give its address in numbers",
                         port->name, gai_strerror(error));
    tcp->next = tcp->addresses;
    return connect_next(port, 0);
}

static fathom_status_t open_tcp(port_t *port)
{
    port->tcp = calloc(1, sizeof *port->tcp);
    if (port->tcp == NULL) return port_fail(port, PORT_FAILED, "%s: %s", port->name, strerror(ENOMEM));
    port->events = POLLOUT;
    const fathom_status_t status = look_up(port);
    if (status == FATHOM_ERR_PORT) close_tcp(port);
    return status;
}

const port_driver_t port_tcp = {open_tcp, poll_tcp, close_tcp, start_line, note_sent, note_read};
