/* SPDX-License-Identifier: MIT */
/* What input capture makes of edges that come while its own interrupt runs; and INT0 by itself. */
#include "suite.h"

#include "board.h"

enum { US = BOARD_CYCLES_PER_US, PULSE_CYCLES = 1000 * US };
enum { BY_ICP1 = 1, BY_INT0 = 2 }; /* images/pulses.c */

static uint64_t rise_cycle; /* of the next edge that is placed */

static int start(void **state)
{
    board_start("pulses");
    board_drive('B', 0, false);
    board_drive('D', 2, false);
    assert_true(board_run_us(1000));
    return 0;
}

static const suite_t suite = {.set_up = start, .tear_down = board_stop};

/* `offset` cycles after rise_cycle. */
static void edge(bool high, uint64_t offset) { board_drive_at('B', 0, high, rise_cycle + offset); }

/* The width of the next pulse that is told, in us; 0: none is for 3 ms. */
static uint32_t told_us(uint8_t by)
{
    const board_record_t *const record = board_next_record(3000);
    if (record == NULL) return 0;
    assert_int_equal(record->kind, by);
    return board_number(record->bytes, 4);
}

static void place(void)
{
    board_run_us(2000);
    assert_int_equal(board.taken, board.recorded); /* the pulse before was told once */
    rise_cycle = board.avr->cycle + 100 * US;
}

static void assert_told(uint32_t us, uint64_t least_cycles, uint64_t most_cycles)
{
    assert_in_range((uint64_t)us * US, least_cycles - US, most_cycles + US);
}

/* Its fall is captured from 72 cycles on, when the interrupt has turned to it. Before that the interrupt finds the pin
 * low again, and what it tells is as long as itself. Either way the pulse after it is right. */
TEST(a_pulse_that_ends_in_the_interrupt_is_no_longer_than_it_or_right)
{
    enum { TURNED = 72, INTERRUPT = 190 };
    for (uint64_t width = 1; width < 2 * INTERRUPT; width++) {
        place();
        edge(true, 0);
        edge(false, width);
        const uint32_t us = told_us(BY_ICP1);
        if (width < TURNED)
            assert_told(us, 1 + US, INTERRUPT);
        else
            assert_told(us, width, width);
        place();
        edge(true, 0);
        edge(false, PULSE_CYCLES);
        assert_told(told_us(BY_ICP1), PULSE_CYCLES, PULSE_CYCLES);
    }
}

/* Low again for some cycles, both edges while the interrupt gets at the first one: the pulse begins before or after. */
TEST(a_bounce_in_the_interrupt_costs_no_more_than_itself)
{
    for (uint64_t high = 1; high < 60; high += 3) {
        for (uint64_t low = 1; low < 60; low += 3) {
            place();
            edge(true, 0);
            edge(false, high);
            edge(true, high + low);
            edge(false, PULSE_CYCLES);
            assert_told(told_us(BY_ICP1), PULSE_CYCLES - high - low, PULSE_CYCLES);
        }
    }
}
