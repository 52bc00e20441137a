/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TEST_AVR_REMOTE_CALLS_H
#define FATHOM_TEST_AVR_REMOTE_CALLS_H

#include <stdint.h>

/* Between images/remote.c and remote.c: laid out alike on both sides, little-endian, no padding on either. */
enum { REMOTE_BYTES = 64, REMOTE_REQUEST = 40 };

enum { /* call */
       REMOTE_BEGIN = 1,
       REMOTE_READ,
       REMOTE_WRITE,
       REMOTE_SENT,
       REMOTE_SET_LINE,
       REMOTE_SET_BREAK,
       REMOTE_NOW,
       REMOTE_IDLE,
       REMOTE_CLOCK,
       REMOTE_PIN,
       REMOTE_READY,
       REMOTE_MARK
};

typedef struct {
    uint32_t baud;
    uint32_t time_us;
    int16_t result;
    uint8_t parity;
    uint8_t stop_bits;
    uint8_t length;
    uint8_t flags;
    uint8_t bytes[REMOTE_BYTES];
    uint8_t call; /* 0: done */
    uint8_t unused;
} remote_t;

#endif
