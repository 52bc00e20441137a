/* SPDX-License-Identifier: MIT */
#ifndef LISTENER_H
#define LISTENER_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/hal.h"

/*
 * Sits between the line and its port, changes nothing, and remembers what passes: the evidence from which a failure is
 * explained.
 */
enum { LISTENER_WINDOW = 512, LISTENER_REQUEST = 255 };

typedef struct listener listener_t;
struct listener {
    fathom_uart_t inner;
    fathom_clock_t clock;
    /* Where several sensors are asked: the listener that remembers the request which is about to leave, and what
     * passes until the next one does. NULL: this one. */
    listener_t *(*whose)(void *ctx);
    void *ctx;
    listener_t *now;                 /* the one that does at present; NULL: this one */
    uint8_t window[LISTENER_WINDOW]; /* what was heard in this attempt; of more than fits, the beginning */
    uint16_t have;
    uint32_t bytes;      /* heard in this attempt, the window's included */
    uint32_t slowest_us; /* the longest time from a request to a byte that came after it, in this attempt */
    uint8_t request[LISTENER_REQUEST]; /* the last one */
    uint8_t request_length;            /* 0: none has been sent */
    uint32_t asked_us;
    uint64_t requests; /* since the start */
    uint64_t passed;   /* those of all listeners, by the one that stands before the port */
};

/* What is in the window. */
typedef struct {
    uint32_t bytes;   /* all that was heard */
    uint32_t echoes;  /* of the request that was sent last */
    uint32_t rest;    /* bytes of the window that were neither echo nor frame */
    uint32_t own;     /* responses with a right CRC from the unit that was asked; ... */
    uint32_t fitting; /* ... and those of them that are no measurement which came unasked, by their length */
    uint32_t foreign; /* frames with a right CRC from another unit than the one that was asked, ... */
    uint8_t foreign_address; /* ... and the first of these units */
    uint32_t masters;        /* requests of another master with a right CRC, ... */
    uint8_t masters_address; /* ... and whom the first one asked */
    uint32_t streamed_a16;   /* frames FF..SUM, two or more in a row: of a sensor that sends by itself */
    uint32_t streamed_a05;
    uint32_t slowest_us;
} evidence_t;

/* Stands before *uart, which is replaced; the listener may not be moved then. */
void listener_begin(listener_t *listener, fathom_uart_t *uart, const fathom_clock_t *clock);

/* Goes on with the attempt of another one. */
void listener_take_over(listener_t *listener, const listener_t *other);

/* A new attempt: forgets what was heard. */
void listener_forget(listener_t *listener);

/* address: of the unit that is asked; 0: none is. */
void listener_judge(const listener_t *listener, uint8_t address, evidence_t *evidence);

#endif
