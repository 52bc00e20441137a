/* SPDX-License-Identifier: MIT */
#ifndef TCP_H
#define TCP_H

#include <stdint.h>

#include "fathom/hal.h"
#include "fathom/status.h"
#include "fathom_posix.h"

/*
 * A connection to a Modbus TCP server, in the place of a serial port: a UART that carries RTU frames, by
 * port/libmodbus. Where the tool was built without libmodbus, tcp_none.c says so instead.
 */
typedef struct tcp tcp_t;

/*
 * Connects to `path` (tcp_address.h), and sets *uart. NULL: it failed.
 *
 * The commands ask `port` how things are, so it stands in for the connection: its descriptor, its errors (NOT_FOUND:
 * not there, and may come; LOST; SYSTEM for the rest) and their text. Nothing else of it may be used, and it is not
 * to be closed.
 */
tcp_t *tcp_open(const char *path, fathom_posix_uart_t *port, fathom_uart_t *uart);
void tcp_close(tcp_t *tcp);

/*
 * The same without waiting: tcp_begin, and then tcp_go_on when `port`'s descriptor can be written, and in TCP_CONNECT_S.
 * Returns FATHOM_OK; FATHOM_PENDING; or FATHOM_ERR_PORT, and *port has the error. turn: so often it was tried.
 */
tcp_t *tcp_begin(const char *path, unsigned turn, fathom_posix_uart_t *port);
fathom_status_t tcp_go_on(tcp_t *tcp, fathom_uart_t *uart);

/* What a gateway has said since the last request: exception 10 or 11; 0: neither. */
uint8_t tcp_gateway_exception(const tcp_t *tcp);

#endif
