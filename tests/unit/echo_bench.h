/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_ECHO_BENCH_H
#define FATHOM_TESTS_ECHO_BENCH_H

#include "line_bench.h"

/* What the tests of local echo share: each is run with all that an echo may be known as, and with bytes that come
 * in every way. */
#define COUNT_OF(array) (sizeof(array) / sizeof *(array))

enum { BY_BYTE = 0, SEEDS = 6 }; /* one by one, or in pieces that the seed cuts */

extern const uint8_t modes[3];
extern const uint32_t pauses_us[3]; /* between the request and what follows it */
extern const uint32_t steps_us[3];  /* of the loop */

/* Calls the test with each of them. */
typedef void (*case_t)(void **state, uint8_t mode, unsigned seed, uint32_t pause_us, uint32_t step_us);
void in_every_way(void **state, case_t test);

void set_up_with(void **state, uint8_t echo);
void run_until_written(size_t written, uint32_t step_us);

/* The bytes come at the line's speed, the first one complete in_us + BYTE_US from now. */
void come(unsigned seed, uint32_t in_us, const uint8_t *bytes, size_t length);

uint8_t known_echo(void);

#endif
