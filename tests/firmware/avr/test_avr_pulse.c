/* SPDX-License-Identifier: MIT */
#include <stdint.h>
#include <stdlib.h>

#include "suite.h"

#include "pulse_rig.h"

/*
 * How well a pulse of 1..94 ms is measured, both ways at once on the same edges. Bounds: input capture within 1 us,
 * always; INT0 within 1 us when no other interrupt was due at an edge, else within the longest of them and 1 us.
 */
enum { MS = 1000 * BOARD_CYCLES_PER_US, US = BOARD_CYCLES_PER_US };

/* A character of 8N1 at 115200 baud, and 3 % of slack: what is sent back keeps up. */
enum { BYTE_CYCLES = 1430 };

/* Odd steps, so that edges and the timer's ticks fall on each other in every way. */
enum { STEP_CYCLES = MS + 37, SPREAD_CYCLES = 3 * MS + 1013 };

typedef struct {
    uint32_t pulses;
    uint32_t masked;
    int64_t icp1; /* the largest errors, in cycles */
    int64_t int0;
    int64_t int0_masked;
} errors_t;

static pulse_rig_t rig;

static int set_up(void **state)
{
    pulse_rig_start(&rig);
    return 0;
}

static int tear_down(void **state)
{
    pulse_rig_end(&rig);
    return 0;
}

static const suite_t suite = {.set_up = set_up, .tear_down = tear_down};

static void keep(int64_t *largest, int64_t error)
{
    if (llabs(error) > *largest) *largest = llabs(error);
}

/* When it ended, by input capture. */
static uint32_t measure(errors_t *errors, uint64_t at_cycle, uint64_t width_cycles)
{
    const pulse_told_t told = pulse_rig_pulse(&rig, at_cycle, width_cycles);
    assert_int_equal(told.missed, 0);
    errors->pulses++;
    if (rig.masked) errors->masked++;
    keep(&errors->icp1, pulse_rig_error(&rig, told.icp1_us));
    keep(rig.masked ? &errors->int0_masked : &errors->int0, pulse_rig_error(&rig, told.int0_us));
    /* The ends agree to what INT0 may be late. */
    assert_in_range(told.int0_end_us - told.icp1_end_us, 0, 1 + pulse_rig_longest_cycles(&rig) / US);
    return told.icp1_end_us;
}

static void check(const errors_t *errors, const char *what)
{
    const uint32_t longest = pulse_rig_longest_cycles(&rig);
    print_message(
        "%s: %u pulses, input capture off by %.2f us at most; INT0 by %.2f us, with another interrupt due "
        "(%u pulses) by %.2f us, where the longest one takes %.2f us\n",
        what, errors->pulses, (double)errors->icp1 / US, (double)errors->int0 / US, errors->masked,
        (double)errors->int0_masked / US, (double)longest / US);
    assert_true(errors->icp1 <= US);
    assert_true(errors->int0 <= US);
    assert_true(errors->int0_masked <= US + (int64_t)longest);
}

static void sweep(errors_t *errors)
{
    for (uint64_t width = MS; width <= 94 * MS; width += STEP_CYCLES)
        measure(errors, rig.board.avr->cycle + SPREAD_CYCLES, width);
    measure(errors, rig.board.avr->cycle + SPREAD_CYCLES, 94 * MS);
}

TEST(a_pulse_of_1_to_94_ms_is_measured_within_1_us_while_nothing_else_happens)
{
    errors_t errors = {0};
    sweep(&errors);
    check(&errors, "quiet");
    assert_true(errors.pulses - errors.masked > 80);
}

TEST(a_pulse_of_1_to_94_ms_is_measured_by_input_capture_within_1_us_while_bytes_come_and_go)
{
    errors_t errors = {0};
    pulse_rig_traffic(&rig, BYTE_CYCLES);
    sweep(&errors);
    sweep(&errors);
    check(&errors, "with traffic");
    assert_true(errors.masked > 20); /* there was something to disturb it */
    assert_true(errors.pulses - errors.masked > 20);
}

/* The rise, then the fall of pulses at each cycle around the overflow, or at each so many: from well before it, so that
 * it comes while the interrupts of the edge wait or run, to behind it. */
static void sweep_overflow(errors_t *errors, int step, bool rising)
{
    enum { BEFORE_CYCLES = 300, AFTER_CYCLES = 100, WIDTH_CYCLES = 5 * MS, NEAR_CYCLES = 24 };
    for (int offset = -BEFORE_CYCLES; offset <= AFTER_CYCLES; offset += step) {
        uint64_t edge = rig.overflow_cycle + PULSE_RIG_PERIOD_CYCLES + (uint64_t)(int64_t)offset;
        measure(errors, rising ? edge : edge - WIDTH_CYCLES, WIDTH_CYCLES);
        /* That is where it was. */
        edge = rising ? rig.rise_cycle : rig.fall_cycle;
        const int64_t from = (int64_t)(edge - rig.overflow_cycle) - offset + PULSE_RIG_PERIOD_CYCLES;
        assert_in_range((from + NEAR_CYCLES) % PULSE_RIG_PERIOD_CYCLES, 0, 2 * NEAR_CYCLES);
    }
}

TEST(an_edge_at_any_cycle_around_the_overflow_of_the_timer_has_its_right_time)
{
    errors_t errors = {0};
    assert_true(board_run_us(&rig.board, 40000)); /* until there was one */
    assert_true(rig.overflow_cycle != 0);
    sweep_overflow(&errors, 1, true);
    sweep_overflow(&errors, 1, false);
    check(&errors, "around the overflow");
}

TEST(so_has_one_while_bytes_come_and_go)
{
    errors_t errors = {0};
    assert_true(board_run_us(&rig.board, 40000));
    pulse_rig_traffic(&rig, BYTE_CYCLES);
    sweep_overflow(&errors, 3, true);
    sweep_overflow(&errors, 3, false);
    check(&errors, "around the overflow, with traffic");
}

TEST(a_pulse_across_the_wrap_of_the_clock_is_measured_within_1_us)
{
    errors_t errors = {0};
    const uint64_t wrap = (1ull << 32) * US;
    measure(&errors, 0, 94 * MS); /* it works, so it will sleep */
    assert_true(board_run_us(&rig.board, UINT32_MAX - 200000));
    uint32_t end_us = UINT32_MAX;
    while (end_us > 94000) {
        assert_true(rig.board.avr->cycle < wrap);
        end_us = measure(&errors, rig.board.avr->cycle + SPREAD_CYCLES, 94 * MS);
    }
    check(&errors, "across the wrap");
}

TEST(pulses_down_to_60_us_are_measured_as_well)
{
    errors_t errors = {0};
    for (uint64_t width = 60 * US; width <= 3 * MS; width += 61 * US + 7)
        measure(&errors, rig.board.avr->cycle + MS + width, width);
    check(&errors, "short");
}

/* Of glitches of any length, shorter than the interrupts and longer, at both ends of the pause before a pulse. */
TEST(glitches_leave_the_pulse_after_them_as_it_is)
{
    errors_t errors = {0};
    for (uint64_t width = 1; width <= 70 * US; width += 11) {
        const uint64_t at = rig.board.avr->cycle + MS;
        pulse_rig_glitch(&rig, at, width);
        measure(&errors, at + width + 100 * US, 3 * MS);
    }
    check(&errors, "after a glitch");
    assert_true(errors.pulses > 100);
}
