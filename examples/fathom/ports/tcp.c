/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "fathom_libmodbus.h"
#include "ports/connection.h"

/* Modbus TCP over a connection: a UART that carries RTU frames, by port/libmodbus. */
typedef struct modbus_tcp {
    fathom_libmodbus_t port;
    modbus_t *modbus;
} modbus_tcp_t;

static fathom_libmodbus_t *libmodbus_of(const port_t *port) { return &port->connection->modbus->port; }

static void stop(port_t *port)
{
    modbus_tcp_t *const gateway = port->connection->modbus;
    if (gateway == NULL) return;
    if (gateway->modbus != NULL) modbus_free(gateway->modbus);
    free(gateway);
}

/* Responses arrive whole, and need no silence between them. The server assigns each response to its request. */
static bool begin(port_t *port)
{
    connection_t *const connection = port->connection;
    const fathom_libmodbus_config_t config = {.clock = &port->clock};
    modbus_tcp_t *const gateway = connection->modbus = calloc(1, sizeof *gateway);
    if (gateway != NULL)
        gateway->modbus = modbus_new_tcp_pi(connection->address.host, connection->address.service);
    if (gateway == NULL || gateway->modbus == NULL) {
        (void)port_fail(port, PORT_FAILED, "%s: %s", port->name, strerror(ENOMEM));
        return false;
    }
    (void)fathom_libmodbus_init(&gateway->port, gateway->modbus, &config); /* all of it is there */
    connection->bytes = fathom_libmodbus_uart(&gateway->port);
    port->parts.silence_us = 100; /* the least (line.h) */
    port->parts.gap_us = 1000;
    port->parts.echo = FATHOM_LINE_ECHO_OFF;
    port->parts.senders = NULL;
    port->parts.masters = NULL;
    return true;
}

static bool start(port_t *port)
{
    if (port->connection->modbus == NULL && !begin(port)) return false;
    (void)modbus_set_socket(port->connection->modbus->modbus, port->fd);
    return true;
}

/* Returns true if what was received begins as the response of RTU does. */
static bool is_rtu(const port_t *port)
{
    const connection_t *const connection = port->connection;
    const fathom_libmodbus_t *const libmodbus = libmodbus_of(port);
    return libmodbus->have >= 2 && libmodbus->adu[0] == connection->request[0] &&
           (libmodbus->adu[1] & 0x7F) == connection->request[1];
}

static fathom_status_t judge(port_t *port)
{
    switch (fathom_libmodbus_error(libmodbus_of(port))) {
    case FATHOM_LIBMODBUS_ERR_NONSENSE:
        if (is_rtu(port))
            return port_fail(
                port, PORT_LOST,
                "%s: the response is a frame of Modbus RTU without the header of Modbus TCP: the "
                "converter passes raw bytes. Use rtu-%s, or switch the converter to Modbus TCP",
                port->name, port->name);
        return port_fail(
            port, PORT_LOST,
            "%s: the received bytes are not Modbus TCP. Check the port number (usually 502) and the server",
            port->name);
    case FATHOM_LIBMODBUS_ERR_TRUNCATED:
        return port_fail(port, PORT_LOST, "%s: the system accepted only a part of a request", port->name);
    default:
        return FATHOM_OK;
    }
}

static const connection_kind_t kind = {start, judge, stop, "server", 200000};

/* ---- the driver ---- */

static fathom_status_t open_tcp(port_t *port)
{
    return connection_open(port, port->kind == PORT_RAW ? &connection_raw : &kind);
}

static void start_line(port_t *port)
{
    port->parts.marks = fathom_line_refusals;
    if (port->connection->modbus != NULL) fathom_libmodbus_hold(libmodbus_of(port), &port->line);
}

static void note_sent(port_t *port)
{
    if (port->connection->modbus == NULL) return;
    fathom_libmodbus_t *const libmodbus = libmodbus_of(port);
    libmodbus->other_units = 0;
    libmodbus->foreign_responses = 0;
}

static void note_read(port_t *port)
{
    if (port->connection == NULL || port->connection->modbus == NULL) return;
    fathom_libmodbus_t *const libmodbus = libmodbus_of(port);
    if (libmodbus->gateway_refusals != 0)
        listener_word(port->listener.now != NULL ? port->listener.now : &port->listener,
                      libmodbus->gateway_exception);
    libmodbus->gateway_refusals = 0;
    port->gateway.other_unit = libmodbus->other_unit;
    port->gateway.has_other_unit = libmodbus->other_units != 0;
    port->gateway.has_other_identifier = libmodbus->foreign_responses != 0;
    port->gateway.is_rtu = is_rtu(port);
    port->gateway.is_incomplete = libmodbus->have != 0;
}

const port_driver_t port_tcp = {open_tcp,  connection_poll, connection_close, start_line,
                                note_sent, note_read,       connection_due_us};
