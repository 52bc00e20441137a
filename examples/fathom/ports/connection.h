/* SPDX-License-Identifier: MIT */
#ifndef CONNECTION_H
#define CONNECTION_H

#include <netdb.h>

#include "ports/port.h"

/* What the files of a connection share. */

/* What passes over a connection. */
typedef struct {
    /* Called with each new connection: sets connection->bytes, which read and write bytes of a line. False: port_fail()
     * has the reason. */
    bool (*start)(port_t *port);
    /* Called after `bytes` returned an error. FATHOM_OK: the connection has ended. FATHOM_ERR_PORT: port_fail() has why
     * the far end is not usable. */
    fathom_status_t (*judge)(port_t *port);
    void (*stop)(port_t *port); /* frees what start() has allocated; NULL: nothing */
    const char *far_end;
    /* If a connection ends within this time after a request, the far end has not sent the request on. */
    uint32_t race_us;
} connection_kind_t;

typedef enum { CONNECTION_FIRST, CONNECTION_OPEN, CONNECTION_CLOSED, CONNECTION_AGAIN } connection_state_t;

typedef struct connection {
    const connection_kind_t *kind;
    connection_state_t state;
    tcp_address_t address;
    struct addrinfo *addresses;     /* of the host */
    const struct addrinfo *next;    /* to try if the present address fails; NULL: none */
    const struct addrinfo *present; /* the address that is, or was, connected */
    uint64_t due_us;                /* if a socket connects: the end of this; else the next attempt */
    uint64_t until_us;              /* in CONNECTION_AGAIN: the end of all attempts that fail */
    uint64_t opened_us;
    bool is_used;              /* something was received */
    uint64_t sent_us;          /* the time of the newest request */
    uint8_t request[255];      /* the newest one */
    uint8_t length;            /* of the request; 0: none was sent */
    bool sends_again;          /* the request, as soon as there is a connection */
    fathom_uart_t bytes;       /* by the kind */
    struct modbus_tcp *modbus; /* of a Modbus TCP server */
} connection_t;

extern const connection_kind_t connection_raw;

/* The functions of a driver (port.h). */
fathom_status_t connection_open(port_t *port, const connection_kind_t *kind);
fathom_status_t connection_poll(port_t *port);
void connection_close(port_t *port);
uint32_t connection_due_us(const port_t *port);

#endif
