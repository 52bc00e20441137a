/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_LIBMODBUS_PORT_H
#define FATHOM_LIBMODBUS_PORT_H

#include "fathom_libmodbus.h"

/* The functions that the files of this port share. */

/* rtu.c and tcp.c: the UART functions for each kind of modbus_t. `ctx` is the port. */
int fathom_libmodbus_rtu_read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx);
int fathom_libmodbus_rtu_write(void *ctx, const uint8_t *bytes, size_t length);
bool fathom_libmodbus_rtu_sent(void *ctx);
int fathom_libmodbus_tcp_read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx);
int fathom_libmodbus_tcp_write(void *ctx, const uint8_t *bytes, size_t length);
bool fathom_libmodbus_tcp_sent(void *ctx);

/* hold.c: the clock of the port, in microseconds. */
uint32_t fathom_libmodbus_now_us(const fathom_libmodbus_t *port);

/* The newest request has left; a response to it or to an earlier one has arrived; no response can arrive any more. */
void fathom_libmodbus_note_request(fathom_libmodbus_t *port, uint8_t unit);
void fathom_libmodbus_note_response(fathom_libmodbus_t *port, bool is_to_newest);
void fathom_libmodbus_note_response_of(fathom_libmodbus_t *port, uint8_t unit); /* it is not silent */
void fathom_libmodbus_note_broken(fathom_libmodbus_t *port);

/* error.c: stores the first reason and returns -1. */
int fathom_libmodbus_broken(fathom_libmodbus_t *port, fathom_libmodbus_error_t error);

/* Call it after a system call that failed with errno. Returns 0 if the call should be repeated, else -1. */
int fathom_libmodbus_failed(fathom_libmodbus_t *port);

/* Clears the error, because bytes were sent or received. */
void fathom_libmodbus_works(fathom_libmodbus_t *port);

#endif
