/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_TOOL_STEPS_H
#define FATHOM_TESTS_TOOL_STEPS_H

#include "tool_bench.h"

/* A bench whose sensor sees something else every second, and may be cut off for a while. */
enum { STEPS = 16 };

typedef struct {
    int32_t distance[STEPS][4]; /* what each probe sees in this second; the last one stays */
    size_t count;
    uint64_t off_us; /* so long after the begin it is cut off, ... */
    uint64_t on_us;  /* ... and back; 0: never */
    uint64_t passed_us;
    fathom_sim_device_t *device;
} steps_t;

extern steps_t steps;

/* The bench, without a sensor. */
void steps_begin(void);

/* The bench with the sensors of these words, of which the first one sees this from second to second: "700 none fault",
 * or "480,450,100,700 480,450,none,700" for four probes. "@3800-7500": it is cut off from 3.8 to 7.5 s. Nothing: there is
 * no sensor. */
void steps_see(const char *sees, const char *words);

/* Runs "read WORDS --port line", once a second unless the words have another interval. */
const tool_run_t *read_steps(const char *words);

/* Lines of text, each with the second in which it was, and without its fraction. */
void expect_text(const tool_run_t *run, const char *expected);

/* This stands somewhere on the standard error. */
void expect_err(const tool_run_t *run, const char *text);

#endif
