/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TEST_INTERRUPTS_CALLS_H
#define FATHOM_TEST_INTERRUPTS_CALLS_H

#include <stdint.h>

/* Between the image "interrupts" and the host: laid out alike on both sides, little-endian, no padding on either. */
enum { CALLS_BYTES = 64, CALLS_REQUEST = 8 };

/* call */
enum { CALL_NOW = 1, CALL_READ, CALL_WRITE, CALL_SENT, CALL_LEAVES, CALL_SET_LINE, CALL_SET_BREAK };
enum { CALL_ARM = 8, CALL_TAKE, CALL_IDLE, CALL_PIN, CALL_ICP1_BEGIN, CALL_INT0_BEGIN };

/* Reports in GPIOR1: the image waits for calls; the path, which is one call of the port, begins and ends. */
enum { CALLS_READY = 1, CALLS_BEGIN, CALLS_END };

enum { CALLS_PENDING = 2 };

typedef struct {
    uint32_t time_us[2]; /* idle: the most; now, leaves_in_us: what they return; take: width and end */
    uint16_t baud;       /* for set_line */
    uint16_t gather_us;  /* for idle */
    int16_t result;
    uint8_t length; /* of a request, or the capacity of a read */
    uint8_t which;  /* edges: 0 int0, 1 icp1 */
    uint8_t flags;  /* of a read; the level of a pin, or on and off */
    uint8_t is_high;
    uint8_t
        is_masked; /* interrupts are off around the call; CALLS_PENDING: Timer1 overflows before it begins */
    uint8_t parity, stop_bits; /* for set_line */
    uint8_t call;              /* 0: done */
    uint8_t bytes[CALLS_BYTES];
} calls_t;

#endif
