/* SPDX-License-Identifier: MIT */
/* The clock of port/avr against the cycles of the processor. */
#include "suite.h"

#include "remote.h"

enum { PERIOD_CYCLES = 65536 * 8 }; /* of Timer1: 32768 us */

EACH_BEGINS(remote_start())

static const suite_t suite = {.set_up = begins, .tear_down = board_stop};

typedef struct {
    uint64_t cycle; /* just before it */
    uint32_t us;
} reading_t;

/* The next reading of those that remote_watch_clock makes. */
static reading_t next_reading(void)
{
    reading_t reading = {0, 0};
    for (;;) {
        const board_record_t *const record = board_next_record(100000);
        assert_non_null(record);
        if (record->kind == REMOTE_MARK) reading.cycle = board.avr->cycle;
        if (record->kind != REMOTE_CLOCK || reading.cycle == 0) continue;
        assert_int_equal(record->length, 4);
        reading.us = board_number(record->bytes, 4);
        return reading;
    }
}

static void watch(uint8_t masked)
{
    board.taken = board.recorded;
    remote_watch_clock(true, masked);
}

/* When the clock was 0, by this reading: the same for all of them but for the us that is cut off and for the way from
 * the mark to the timer, which is a few cycles longer when an overflow has to be added. */
static int64_t zero_cycle(reading_t reading)
{
    return (int64_t)reading.cycle - (int64_t)reading.us * BOARD_CYCLES_PER_US;
}

static void assert_right(reading_t reading, int64_t zero, uint64_t wraps)
{
    const int64_t off = zero_cycle(reading) - zero - (int64_t)(wraps * BOARD_CYCLES_PER_US << 32);
    assert_true(off > -BOARD_CYCLES_PER_US - 4 && off < BOARD_CYCLES_PER_US + 4);
}

/* Takes a few readings away from any overflow, which has all later ones compared with them. */
static int64_t set_off(void)
{
    watch(0);
    const int64_t zero = zero_cycle(next_reading());
    for (int i = 0; i < 100; i++) assert_right(next_reading(), zero, 0);
    remote_watch_clock(false, 0);
    board_run_us(100);
    return zero;
}

/* The main loop sleeps as a device on a battery does, to the next overflow at most. */
TEST(it_is_right_to_the_microsecond_for_72_minutes_with_a_wrap)
{
    const int64_t zero = set_off();
    const uint64_t wrap_cycle = (uint64_t)BOARD_CYCLES_PER_US << 32; /* 71.6 minutes */
    uint32_t readings = 0;
    for (uint32_t slept = 0; board.avr->cycle < (uint64_t)72 * 60 * BOARD_HZ; slept++) {
        assert_true(slept < 140000); /* of 32000 us each */
        remote_idle(32000);
        if (slept % 500 != 0) continue;
        watch(0);
        const reading_t reading = next_reading();
        const uint64_t since = reading.cycle - (uint64_t)zero;
        remote_watch_clock(false, 0);
        board_run_us(100);
        assert_right(reading, zero, since >= wrap_cycle ? 1 : 0);
        readings++;
    }
    assert_true(board.avr->cycle > wrap_cycle);
    assert_true(readings > 250);
    assert_true(board.asleep_cycles > board.avr->cycle / 100 * 99);
}

/* With interrupts off for 16 ms at a time, most overflows are counted late; each reading looks at them itself. */
TEST(overflows_that_wait_for_16_ms_are_in_each_reading)
{
    const int64_t zero = set_off();
    uint32_t last_us = 0, pending = 0;
    watch(255); /* 261120 cycles */
    for (int i = 0; i < 400; i++) {
        const reading_t reading = next_reading();
        assert_right(reading, zero, 0);
        assert_true(reading.us > last_us);
        if ((reading.cycle - (uint64_t)zero) % PERIOD_CYCLES < 261120) pending++;
        last_us = reading.us;
    }
    assert_in_range(pending, 150, 250);
}

static const fathom_line_settings_t line = {19200, FATHOM_PARITY_NONE, 1};

TEST(idle_returns_when_its_time_is_up)
{
    static const uint32_t most_us[] = {100, 1000, 5000, 20000, 32000};
    for (size_t i = 0; i < sizeof most_us / sizeof most_us[0]; i++) {
        const uint64_t begin_cycle = board.avr->cycle, asleep_cycles = board.asleep_cycles;
        remote_idle(most_us[i]);
        assert_in_range(board.avr->cycle - begin_cycle, most_us[i] * BOARD_CYCLES_PER_US,
                        (most_us[i] + 40) * BOARD_CYCLES_PER_US);
        assert_true(board.asleep_cycles - asleep_cycles > (most_us[i] - 40) * BOARD_CYCLES_PER_US);
    }
}

TEST(idle_sleeps_for_one_period_of_the_timer_at_most_and_not_at_all_for_no_time)
{
    uint64_t begin_cycle = board.avr->cycle;
    remote_idle(UINT32_MAX);
    assert_in_range(board.avr->cycle - begin_cycle, 32000 * BOARD_CYCLES_PER_US, 32768 * BOARD_CYCLES_PER_US);
    for (uint32_t most_us = 0; most_us < 30; most_us++) {
        begin_cycle = board.avr->cycle;
        remote_idle(most_us);
        assert_in_range(board.avr->cycle - begin_cycle, 0, (most_us + 40) * BOARD_CYCLES_PER_US);
    }
}

TEST(the_last_stop_bit_ends_the_sleep)
{
    static const uint8_t request[] = {1, 2, 3};
    assert_true(remote_begin(&line, false, 8));
    remote_idle(0);
    remote_write(request, sizeof request);
    remote_idle(20000);
    assert_int_equal(board.bytes_seen, 3);
    assert_in_range(board.avr->cycle, board.bytes[2].end_cycle, board.bytes[2].end_cycle + 400);
    assert_true(remote_sent());
    const uint64_t begin_cycle = board.avr->cycle;
    remote_idle(20000); /* it ends one */
    assert_true(board.avr->cycle - begin_cycle > 20000 * BOARD_CYCLES_PER_US);
}
