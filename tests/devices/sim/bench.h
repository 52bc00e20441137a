/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_SIM_BENCH_H
#define FATHOM_TESTS_SIM_BENCH_H

/* What all tests of the simulator share: where the clock starts, and the settings of lines. */
#include "suite.h"

#include "sim/sim.h"

static const fathom_line_settings_t bench_9600 = {9600, FATHOM_PARITY_NONE, 1};
static const fathom_line_settings_t bench_19200 = {19200, FATHOM_PARITY_EVEN, 1};

/* Where the clock starts: at nothing special; so that it wraps after 65 ms, 1 s, 3 ms; at the sign bit. */
enum { BENCH_STARTS = 5 };
extern const uint32_t bench_starts_us[BENCH_STARTS];
extern uint32_t bench_start_us; /* of this round */

void bench_begin_round(unsigned round);

/* Every test at every start, or at the first two: where what is looked at is no time, or where the test moves the start
 * itself. With FATHOM_LONG in the environment those run at every start as well. */
#define BENCH_ROUNDS     .begin_round = bench_begin_round, .rounds = BENCH_STARTS
#define BENCH_TWO_ROUNDS .begin_round = bench_begin_round, .rounds = 2, .long_rounds = BENCH_STARTS

#define LITERAL(...) (const uint8_t[]){__VA_ARGS__}, sizeof((const uint8_t[]){__VA_ARGS__})

/* a <= span <= b, where span may have wrapped */
#define ASSERT_SPAN(later_us, earlier_us, from_us, to_us)                                                    \
    assert_in_range(fathom_elapsed_us((later_us), (earlier_us)), (from_us), (to_us))

#endif
