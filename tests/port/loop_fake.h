/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_LOOP_FAKE_H
#define FATHOM_TESTS_LOOP_FAKE_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom_loop.h"

/* A loop in simulated time, whose sources and sensors do what the test says. A sleep takes no time; it ends when its time
 * is over, or at the next wake that the test has planned. */

enum { FAKE_WAKES = 16, FAKE_SCRIPT = 64, FAKE_NEWS = 256 };

typedef struct {
    uint64_t at_us;
    fathom_loop_source_t *source;
} fake_wake_t;

typedef struct {
    fathom_loop_source_t *source;
    uint64_t at_us;
    bool is_open;
} fake_news_t;

typedef struct {
    uint64_t now_us;
    uint64_t begin_us;
    uint32_t slept_us; /* what the last sleep was asked for */
    fake_wake_t wakes[FAKE_WAKES];
    fake_news_t news[FAKE_NEWS];
    unsigned count; /* of news */
    unsigned turns; /* polls of all sources */
    fathom_loop_t loop;
} fake_t;

extern fake_t fake;

typedef struct {
    fathom_loop_source_t source; /* first */
    bool cannot_open;
    bool is_lost; /* its poll says so */
    uint32_t due_us;
    int fd;
    short events;
    const char *text;
    unsigned opens, closes, polls;
    unsigned turn; /* of its last poll; */
    uint64_t polled_us;
} fake_source_t;

typedef struct {
    fathom_loop_sensor_t node;
    fake_source_t *on;
    /* What it says, one after the other; 0: FATHOM_PENDING. After the last one: `for_ever`. */
    fathom_status_t script[FAKE_SCRIPT];
    fathom_status_t for_ever;
    unsigned at;
    uint32_t due_us;
    unsigned polls;
    /* What was taken. */
    unsigned readings, errors, port_errors;
    void (*when_taken)(fathom_status_t status);
} fake_sensor_t;

/* cmocka's fixture: the loop is there, with the config's pauses, and nothing on it. */
int fake_set_up(void **state);
int fake_tear_down(void **state);
/* The same with pauses that are set. */
void fake_begin(uint32_t first_pause_us, uint32_t longest_pause_us);

/* A source that is due in 1 s, after each poll. */
void fake_source(fake_source_t *source);
/* One with nothing to say, at any time. */
void fake_sensor(fake_sensor_t *sensor, fake_source_t *on);

/* Wakes it once, so long from now on. */
void fake_wake_in(fake_source_t *source, uint32_t us);

/* Steps until so much time has passed. */
void fake_pass(uint64_t us);

/* Since the loop began. */
uint64_t fake_elapsed_us(void);

/* How often the source was told to be lost or not opened. */
unsigned fake_failures(const fake_source_t *source);

#endif
