/* SPDX-License-Identifier: MIT */
#ifndef POLL_H
#define POLL_H

#include "diagnosis/advice.h"
#include "diagnosis/counters_print.h"
#include "fathom_loop.h"
#include "ports/channel.h"
#include "reading/station.h"

/* What poll_loop.c, poll_port.c and poll_attempt.c have in common. */
typedef struct poll_loop poll_loop_t;

/* What a port is now. */
typedef enum { POLL_PORT_THERE, POLL_PORT_WAITED_FOR, POLL_PORT_GIVEN_UP } poll_port_state_t;

/* What a command does with it. ctx: poll_loop_t.ctx. */
typedef struct {
    /* False: it could not be told. */
    bool (*reading)(void *ctx, const station_t *station, const fathom_sample_t *sample);
    /* attempt: its number, from 1. Once for each failed part of an attempt. */
    void (*failure)(void *ctx, const failure_t *failure, const station_t *station);
    /* Its port is waited for, and was tried to be opened again, or for the first time, in vain. No attempt. */
    void (*away)(void *ctx, const station_t *station);
    /* What the user has to know of this sensor, or to do with it. */
    void (*remark)(void *ctx, const station_t *station, const char *text);
    /* What happened to a port, a line of text that names it. */
    void (*port)(void *ctx, const char *text, poll_port_state_t state);
    /* Called before each sleep. Returns how long it may take at most, in us. */
    uint32_t (*tick)(void *ctx);
    /* Ends it. */
    bool (*is_over)(const void *ctx);
} poll_loop_user_t;

/* A port, and the sensors on it. */
typedef struct {
    fathom_loop_source_t source;
    poll_loop_t *loop;
    const port_options_t *options;
    station_t *stations; /* the first of them, and then station_t.next */
    size_t station_count;
    channel_t channel;
    port_counts_t counts;
    bool is_waiting; /* for a connection that is under way */
    bool was_open;   /* once */
    bool is_lost;    /* or has not been there yet */
    bool waits;      /* it is opened again */
    bool is_done;    /* nothing is read there any more: all has been read, or it is lost for good */
    bool is_left;    /* and the loop may forget it */
} poll_port_t;

struct poll_loop {
    sensor_options_t options;
    const host_t *host;
    const poll_loop_user_t *user;
    void *ctx;
    fathom_loop_t sources; /* the ports, and what else ends a sleep */
    poll_port_t ports[MAX_PORTS];
    size_t ports_left; /* that are not done */
    uint64_t start_us; /* the program's */
    uint64_t reconnects;
    bool has_left;   /* a port is_left since the last look */
    bool has_failed; /* a port could not be opened, or be used as it should */
};

#endif
