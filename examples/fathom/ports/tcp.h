/* SPDX-License-Identifier: MIT */
#ifndef TCP_H
#define TCP_H

#include <stdint.h>

/*
 * A connection to a Modbus TCP server, as the driver port_tcp of port.h: a UART that carries RTU frames, by
 * port/libmodbus. Without libmodbus, port_tcp only reports that it is missing.
 */
typedef struct tcp tcp_t;

/* The exception 10 or 11 that a gateway sent since the last request; 0: none, or *tcp is NULL. */
uint8_t tcp_gateway_exception(const tcp_t *tcp);

#endif
