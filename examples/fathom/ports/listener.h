/* SPDX-License-Identifier: MIT */
#ifndef LISTENER_H
#define LISTENER_H

#include <stdbool.h>
#include <stdint.h>

/*
 * What passed between a line and its port in an attempt: the evidence from which a failure is explained. An attempt
 * begins with listener_forget().
 */
enum { LISTENER_WINDOW = 512, LISTENER_REQUEST = 255 };

typedef struct listener listener_t;
struct listener {
    /* Of a port at which several sensors are asked: returns the listener of the sensor whose request is about to leave,
     * which stores what passes until the next request. NULL: the port's own listener stores all. */
    listener_t *(*whose)(void *ctx);
    void *ctx;
    listener_t *now; /* the listener that stores at present; NULL: the port's own */

    uint8_t window[LISTENER_WINDOW];   /* the first bytes that were received in this attempt */
    uint16_t have;                     /* bytes in `window` */
    uint32_t bytes;                    /* received in this attempt */
    uint32_t slowest_us;               /* the longest time in this attempt from a request to a later byte */
    uint8_t request[LISTENER_REQUEST]; /* the newest one */
    uint8_t request_length;            /* 0: none was sent */
    uint32_t asked_us;                 /* the time of the newest request */
    uint64_t requests;                 /* since the start */
};

/* What the window holds. A frame counts if its checksum is right. */
typedef struct {
    uint32_t bytes;          /* received, also those that the window had no place for */
    uint32_t echoes;         /* copies of the newest request */
    uint32_t rest;           /* bytes of the window that are neither echo nor frame */
    uint32_t own;            /* responses of the unit that was asked, ... */
    uint32_t fitting;        /* ... and those of them whose length fits the request */
    uint32_t foreign;        /* frames of other units, ... */
    uint8_t foreign_address; /* ... and the first of these units */
    uint32_t masters;        /* requests of another master, ... */
    uint8_t masters_address; /* ... and the unit that the first of them asked */
    uint32_t streamed_a16;   /* frames FF..SUM, at least two in a row, of a sensor that sends by itself */
    uint32_t streamed_a05;
    uint32_t slowest_us;
} evidence_t;

/* Starts an attempt: discards what was received. */
void listener_forget(listener_t *listener);

/* Stores a request, and received bytes. */
void listener_sent(listener_t *listener, const uint8_t *request, uint8_t length, uint32_t now_us);
void listener_received(listener_t *listener, const uint8_t *bytes, uint32_t count, uint32_t now_us);

/* address: of the unit that is asked; 0: none is asked. */
void listener_judge(const listener_t *listener, uint8_t address, evidence_t *evidence);

#endif
