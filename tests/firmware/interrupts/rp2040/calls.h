/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TEST_INTERRUPTS_CALLS_H
#define FATHOM_TEST_INTERRUPTS_CALLS_H

#include <stdint.h>

/* Between the image "interrupts" and the host; bench.js has the same layout and numbers. */
enum { CALLS_BYTES = 160, CALLS_REQUEST = 60, CALLS_SERIAL_REQUEST = 8 };

/* call */
enum { CALL_NOW = 1, CALL_READ, CALL_WRITE, CALL_SENT, CALL_LEAVES, CALL_SET_LINE, CALL_SET_BREAK, CALL_ARM };
enum { CALL_TAKE = 9, CALL_IDLE, CALL_PIN, CALL_LEVEL, CALL_EDGES_BEGIN };
enum { CALL_SERIAL_READ = 14, CALL_SERIAL_WRITE, CALL_SERIAL_LEAVES };

/* The watchdog's SCRATCH: what the image does without, to be set before it begins; and its reports: it waits for calls;
 * the path, which is one call of the port, begins and ends. */
enum { CALLS_WITHOUT = 3, CALLS_REPORT = 2 };
enum { CALLS_NO_DRIVER = 1, CALLS_NO_IDLE = 2, CALLS_NO_PIN = 4 };
enum { CALLS_READY = 1, CALLS_BEGIN, CALLS_END };

typedef struct {
    volatile uint32_t call;     /* 0: done */
    uint32_t length;            /* of a request, or the capacity of a read */
    uint32_t flags;             /* of a read; the level of a pin, or on and off */
    uint32_t baud;              /* for set_line */
    uint32_t parity, stop_bits; /* for set_line */
    int32_t result;
    uint32_t
        time_us[2]; /* idle: the most; now, leaves: what they return; take: width and end; read: last_us */
    uint32_t is_high;
    uint8_t bytes[CALLS_BYTES];
} calls_t;

#endif
