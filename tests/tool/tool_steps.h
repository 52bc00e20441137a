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

/* Begins with an A16 at address 1, or an A05 at address 2, that sees this from second to second. */
void steps_a16(uint8_t mode, const int32_t *distances, size_t count);
void steps_a05(const int32_t rows[][4], size_t count);

#define SEES_A16(...)                                                                                        \
    steps_a16(FATHOM_SIM_A16_MODBUS, (const int32_t[]){__VA_ARGS__},                                         \
              sizeof((const int32_t[]){__VA_ARGS__}) / sizeof(int32_t))
#define SEES_A05(...)                                                                                        \
    steps_a05((const int32_t[][4]){__VA_ARGS__},                                                             \
              sizeof((const int32_t[][4]){__VA_ARGS__}) / sizeof(int32_t[4]))

/* Reads once a second. */
const tool_run_t *read_steps(const char *sensors, const char *options);

/* Lines of text, each with the second in which it was, and without its fraction. */
void expect_text(const tool_run_t *run, const char *expected);

/* This stands somewhere on the standard error. */
void expect_err(const tool_run_t *run, const char *text);

#endif
