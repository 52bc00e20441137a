/* SPDX-License-Identifier: MIT */
#ifndef LOOP_H
#define LOOP_H

#include "reading/reading.h"
#include "reading/stats.h"

/*
 * Reads all sensors of a site, in one loop, until the user, a count, a duration, a loss or the sink ends it. `fathom read`,
 * `fathom watch` and `fathom publish` are sinks of this loop.
 */

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

/* Clears everything. The time of readings starts here. */
void loop_init(loop_t *loop, const host_t *host, const sink_t *sink, void *ctx);

/* Starts to read the site in loop->site, which is the loop's from now on. False: the user knows why no port can be
 * opened or waited for. */
bool loop_open(loop_t *loop);

/*
 * Reads another site instead, between two steps of the loop: in tick. A line whose text is the same goes on. Any other line
 * is closed, and opened again if *site has it. False: a request on a line that has to be closed is pending; nothing
 * changed, call again soon. is_urgent: such a request is given up. When it is true, *site is empty and `old` has what is
 * not read any more, for the caller to free. The lines are started when tick returns.
 */
bool loop_set_site(loop_t *loop, site_t *site, bool is_urgent, site_t *old);

void loop_run(loop_t *loop);
void loop_stop(loop_t *loop);

/* Also after loop_open() failed, or without it. The site stays until loop_deinit(). */
void loop_close(loop_t *loop);
void loop_deinit(loop_t *loop);

/* Returns true if a port is lost, or was never there. */
bool loop_is_lost(const loop_t *loop);

/* Returns true if nothing failed and each sensor gave a reading that is not unknown. A sensor without a reading is good
 * if the user ended the loop, or if its port was still waited for. */
bool loop_is_good(const loop_t *loop);

/* Adds up all counters. */
void loop_account(loop_t *loop, account_t *account);

/* The clock of the host; since the start; of a sample since the start; and the time of day of the latter. */
uint64_t loop_now_us(const loop_t *loop);
uint64_t loop_time_us(const loop_t *loop);
uint64_t loop_sample_us(const loop_t *loop, uint32_t sample_us);
uint64_t loop_utc_us(const loop_t *loop, uint64_t time_us);

/* For line.c: is there nothing more to read, or has the loop to end? */
bool loop_is_over(const loop_t *loop);

#endif
