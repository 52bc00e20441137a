/* SPDX-License-Identifier: MIT */
#ifndef RUN_H
#define RUN_H

#include "reading/reading.h"

/* A run of the loop: what it reads, where its readings go, and its time. */

typedef enum {
    NOTICE_REMARK,  /* something to know about a sensor, or to do with it */
    NOTICE_OPEN,    /* a port is there again, or for the first time after a wait */
    NOTICE_WAITING, /* for a port */
    NOTICE_GIVEN_UP /* a port is not read any more */
} notice_kind_t;

/* Something that the user has to know. */
typedef struct {
    notice_kind_t kind;
    const sensor_t *sensor; /* of a remark; else NULL, and the text names the port */
    const char *text;
} notice_t;

/* What a command does with it. */
typedef struct {
    void (*reading)(void *ctx, const reading_t *reading);
    void (*notice)(void *ctx, const notice_t *notice);
    /* Called before each sleep, outside of all other calls. Returns the longest time to sleep in us. */
    uint32_t (*tick)(void *ctx);
} sink_t;

typedef struct loop {
    site_t site;
    const host_t *host;
    const sink_t *sink;
    void *ctx;
    fathom_loop_t sources; /* the ports, and what else ends a sleep */
    size_t lines_left;     /* that are not done */
    uint64_t start_us;     /* of the program */
    uint64_t reconnects;
    bool has_left;   /* a line is_left */
    bool has_new;    /* lines that have not been started */
    bool has_failed; /* a port could not be opened, or not be used as it should */
    bool is_stopped;
} loop_t;

/* The clock of the host; since the start; of a sample since the start; and the time of day of the latter. */
uint64_t loop_now_us(const loop_t *loop);
uint64_t loop_time_us(const loop_t *loop);
uint64_t loop_sample_us(const loop_t *loop, uint32_t sample_us);
uint64_t loop_utc_us(const loop_t *loop, uint64_t time_us);

/* Returns true if nothing is left to read, or if the loop has to end. */
bool loop_is_over(const loop_t *loop);

#endif
