/* SPDX-License-Identifier: MIT */
#ifndef POLL_H
#define POLL_H

#include "shared/usb_adapter.h"
#include "stations/advice.h"
#include "stations/counters_print.h"
#include "stations/sensor_options.h"

/* What poll_loop.c and poll_attempt.c have in common. */
typedef struct poll_loop poll_loop_t;

/* What a command does with it. ctx: poll_loop_t.ctx. */
typedef struct {
    /* False: it could not be told. */
    bool (*reading)(void *ctx, const station_t *station, const fathom_sample_t *sample);
    /* attempt: its number, from 1. Once for each failed part of an attempt. */
    void (*failure)(void *ctx, const failure_t *failure, const station_t *station);
    /* What the user has to know of this sensor, or to do with it. */
    void (*remark)(void *ctx, const station_t *station, const char *text);
    /* What happened to the port, a line of text; is_there: false while it is waited for. */
    void (*port)(void *ctx, const char *text, bool is_there);
    /* Called before each sleep. Returns how long it may take at most, in us. */
    uint32_t (*tick)(void *ctx);
    /* Ends it. */
    bool (*is_over)(const void *ctx);
} poll_loop_user_t;

struct poll_loop {
    sensor_options_t options;
    const host_t *host;
    const poll_loop_user_t *user;
    void *ctx;
    channel_t channel;
    usb_adapter_t adapter;
    port_counts_t port_counts;
    uint64_t start_us; /* the program's */
    uint64_t reconnects;
    bool is_lost; /* the port */
};

#endif
