/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_ECHO_BENCH_H
#define FATHOM_TESTS_ECHO_BENCH_H

#include "line_bench.h"

/* What the tests of local echo share: each is run with all that an echo may be known as, and with bytes that come
 * in every way. */

enum { BY_BYTE = 0, SEEDS = 6 }; /* one by one, or in pieces that the seed cuts */

typedef struct {
    uint8_t mode; /* FATHOM_LINE_ECHO_... */
    unsigned seed;
    uint32_t pause_us; /* between the request and what follows it */
    uint32_t step_us;  /* of the loop */
} way_t;

extern const uint8_t modes[3];
extern const uint32_t pauses_us[3];
extern const uint32_t steps_us[3];

/* Calls the test with each of them. */
void in_every_way(void (*test)(const way_t *way));

void set_up_with(uint8_t echo);
void run_until_written(size_t written, uint32_t step_us);

/* Asks unit 1; the request is on its way from now on. */
void send_1(uint8_t retries, uint32_t step_us);

/* The bytes come at the line's speed, the first one complete in_us + BYTE_US from now. */
void come(unsigned seed, uint32_t in_us, const uint8_t *bytes, size_t length);
#define come_all(in_us, array) come(BY_BYTE, in_us, array, sizeof(array))

/* Unit 1 is asked, and responses 754, behind the echo if there is one. */
void read_once(bool echoes);

uint8_t known_echo(void);
#define expect_echo(echo) assert_int_equal(known_echo(), echo)

/* So much is known of the echo now, or what was told. */
void expect_learned(uint8_t mode, uint8_t echo);

#endif
