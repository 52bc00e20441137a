/* SPDX-License-Identifier: MIT */
#ifndef LOOP_H
#define LOOP_H

#include "diagnosis/advice.h"
#include "reading/site.h"

/*
 * Reads all sensors of a site, in one loop, until the user, a count, a duration, a loss or the sink ends it. `fathom read`,
 * `fathom watch` and `fathom publish` are sinks of this loop.
 */

/* What the loop reports of a sensor: a reading, the change of an alarm, or an attempt that failed or could not be made
 * because the port is waited for. */
typedef struct {
    sensor_t *sensor;
    fathom_status_t status;    /* FATHOM_OK: a reading or a change of an alarm */
    const char *failure;       /* the word of `status` for programs; NULL with FATHOM_OK */
    const failure_t *evidence; /* of an attempt that failed; else NULL */
    const result_t *result;    /* of a failure: the time, the address, the probe if it is of one alone */
    uint64_t time_us;          /* since the start of the program; does not wrap */
    uint64_t utc_us;           /* since 1970; 0: the clock was not set */
} reading_t;

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

/* Prints it on the standard error. */
void notice_print(void *ctx, const notice_t *notice);

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
    uint64_t start_us;     /* of the program */
    uint64_t reconnects;
    bool has_alarms;
    bool has_new;    /* lines are LINE_NEW */
    bool has_failed; /* a port could not be opened, or not be used as it should */
    bool is_stopped;
} loop_t;

/* Clears everything. The time of readings starts here. */
void loop_init(loop_t *loop, const host_t *host, const sink_t *sink, void *ctx);

/* Starts to read the site in loop->site, which is the loop's from now on. False: the user knows why no port can be
 * opened or waited for. */
bool loop_open(loop_t *loop);

/* Reports to the sink if the clock was not set, so that readings have no date. */
void loop_check_clock(const loop_t *loop);

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

/* The clock of the host, and the time since the start. */
uint64_t loop_now_us(const loop_t *loop);
uint64_t loop_time_us(const loop_t *loop);

/* Returns true if a port is lost, or was never there. */
bool loop_is_lost(const loop_t *loop);

/* Returns true if nothing failed and each sensor gave a reading that is not unknown. A sensor without a reading is good
 * if the user ended the loop, or if its port was still waited for. */
bool loop_is_good(const loop_t *loop);

/* The counters of a run, or of one sensor. */
typedef struct {
    counters_t sum; /* of all sensors */
    sensor_t *const *sensors;
    size_t sensor_count;
    int64_t time_us; /* since the start */
    int64_t requests;
    int64_t reconnects;
    int64_t dropped_spikes;                                     /* if has_median */
    int64_t timeouts_in_row, backoff_left_us;                   /* of one sensor */
    int64_t response_min_us, response_mean_us, response_max_us; /* from a request to its response */
    bool has_median;
    bool has_stream; /* a sensor sends automatically */
    bool has_port;   /* the driver of a port counts errors */
} account_t;

/* Adds up the counters of these sensors. */
account_t account_of(sensor_t *const *sensors, size_t count);

/* Adds up all counters. */
void loop_account(loop_t *loop, account_t *account);

#endif
