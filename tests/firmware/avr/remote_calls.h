/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TEST_AVR_REMOTE_CALLS_H
#define FATHOM_TEST_AVR_REMOTE_CALLS_H

#include <stdint.h>

/* Between images/remote.c and remote.c: laid out alike on both sides, little-endian, no padding on either. */
enum { REMOTE_BYTES = 64, REMOTE_REQUEST = 40 };

/* call */
enum { REMOTE_BEGIN = 1, REMOTE_READ, REMOTE_WRITE, REMOTE_SENT, REMOTE_SET_LINE, REMOTE_SET_BREAK };
enum { REMOTE_IDLE = 8, REMOTE_CLOCK, REMOTE_PIN, REMOTE_READY, REMOTE_MARK, REMOTE_LEAVES };

typedef struct {
    uint32_t baud, time_us;
    int16_t result;
    uint8_t parity, stop_bits, length, flags, bytes[REMOTE_BYTES];
    uint8_t call; /* 0: done */
    uint8_t unused;
} remote_t;

#endif
