/* SPDX-License-Identifier: MIT */
/* The sketches a16_pwm and hc_sr04 against a module that answers the trigger with pulses of known width (A16 1). */
#include <stdio.h>
#include <stdlib.h>

#include "suite.h"

#include "board.h"

enum { OVERFLOW_CYCLES = 16384 }; /* of Timer0 at 64 cycles a step; every 1.024 ms */
enum { TIMER0_OVF = 16 };         /* its vector */
enum { CYCLE_US = 240000 };       /* more than from one reading to the next */
/* What a width may be off: micros() counts 4 us, and one edge may wait for the interrupt of Timer0, which takes 109
 * cycles with its entry. */
enum { STEP_US = 4, BOUND_US = 11 };

static struct {
    uint64_t width_cycles;   /* of the response; 0: none */
    uint64_t rise_at_cycles; /* not 0: the edge is so long after an overflow of Timer0 */
    uint64_t fall_at_cycles, rise_cycle;
    uint64_t fell_cycles; /* width of the last response in truth */
    bool stays_high;
    uint64_t overflow_cycle;
    uint32_t rise_count; /* of overflows, as the core counts them */
    uint32_t fall_count;
    uint64_t low_cycle; /* of the trigger */
    uint64_t low_cycles;
    uint64_t trigger_cycles; /* from one trigger to the next */
    uint32_t triggers;
} bench;

static const suite_t suite = {.tear_down = board_stop};

static uint8_t *count_of(void) { return board_data("timer0_overflow_count"); }

static uint32_t overflows(void) { return board_number(count_of(), 4); }

static avr_cycle_count_t fall(avr_t *avr, avr_cycle_count_t when, void *param)
{
    bench.fell_cycles = avr->cycle - bench.rise_cycle;
    bench.fall_count = overflows();
    board_drive('D', 2, false);
    return 0;
}

/* From now, at least `cycles`, to so long after an overflow. */
static uint64_t aligned(uint64_t cycles, uint64_t at)
{
    const uint64_t would_be = (board.avr->cycle + cycles - bench.overflow_cycle) % OVERFLOW_CYCLES;
    return cycles + OVERFLOW_CYCLES + at - would_be;
}

static avr_cycle_count_t rise(avr_t *avr, avr_cycle_count_t when, void *param)
{
    uint64_t width = bench.width_cycles;
    if (width == 0) return 0;
    bench.rise_cycle = avr->cycle;
    bench.rise_count = overflows();
    if (bench.fall_at_cycles != 0) width = aligned(width, bench.fall_at_cycles);
    board_drive('D', 2, true);
    if (!bench.stays_high) avr_cycle_timer_register(avr, width, fall, NULL);
    return 0;
}

static void on_trigger(void *ctx, bool high)
{
    avr_t *const avr = board.avr;
    if (high) {
        bench.low_cycles = avr->cycle - bench.low_cycle;
        return;
    }
    bench.trigger_cycles = avr->cycle - bench.low_cycle;
    bench.low_cycle = avr->cycle;
    bench.triggers++;
    uint64_t after = UINT64_C(110000) * BOARD_CYCLES_PER_US;
    if (bench.rise_at_cycles != 0) after = aligned(after, bench.rise_at_cycles);
    avr_cycle_timer_register(avr, after, rise, NULL);
}

static void on_overflow(avr_irq_t *irq, uint32_t pending, void *param)
{
    if (pending != 0) bench.overflow_cycle = board.avr->cycle;
}

static void begin(const char *image)
{
    memset(&bench, 0, sizeof bench);
    board_start(image);
    board_drive('D', 2, false);
    board_watch('D', 7, true, on_trigger, NULL);
    avr_irq_register_notify(avr_get_interrupt_irq(board.avr, TIMER0_OVF) + AVR_INT_IRQ_PENDING, on_overflow,
                            NULL);
}

/* The next line, which is to be of the pulse whose width has been set. */
static const char *line(void) { return board_line(2 * CYCLE_US); }

/* How far the printed width is off, in us; the distance has to be 4/23 of it, rounded (A16 1(4)). */
static double off_us(void)
{
    unsigned mm = 0, us = 0;
    const char *const text = line();
    if (sscanf(text, "%u mm, %u us", &mm, &us) != 2) fail_msg("%s", text);
    assert_int_equal(mm, (us * 8 + 23) / 46);
    return us - (double)bench.fell_cycles / BOARD_CYCLES_PER_US;
}

static double magnitude(double value) { return value < 0 ? -value : value; }

static const uint32_t widths_us[] = {3000, 10100, 50003, 86250};

TEST(pulses_become_distances)
{
    begin("a16_raw");
    for (size_t i = 0; i < sizeof widths_us / sizeof *widths_us; i++) {
        bench.width_cycles = widths_us[i] * BOARD_CYCLES_PER_US;
        assert_true(magnitude(off_us()) <= BOUND_US);
        assert_int_equal(bench.fell_cycles / BOARD_CYCLES_PER_US, widths_us[i]);
    }
    /* A16 1(1), (2): low long enough for any input, and more than 220 ms from trigger to trigger. */
    assert_true(bench.triggers >= 4);
    assert_in_range(bench.low_cycles / BOARD_CYCLES_PER_US, 2000, 3000);
    assert_in_range(bench.trigger_cycles / BOARD_CYCLES_PER_US, 220001, CYCLE_US);
}

/* A sketch prints the distance of each width, or the name of what there is instead. */
static void expect_names(const char *image, uint64_t most_us)
{
    begin(image);
    for (size_t i = 0; i < sizeof widths_us / sizeof *widths_us; i++) {
        bench.width_cycles = widths_us[i] * BOARD_CYCLES_PER_US;
        const double off_mm = strtod(board_line(most_us), NULL) - widths_us[i] * 4 / 23.0; /* A16 1(4) */
        if (magnitude(off_mm) > BOUND_US * 4 / 23.0 + 0.5)
            fail_msg("%u us: off by %f mm", (unsigned)widths_us[i], off_mm);
    }
    bench.width_cycles = 94000 * BOARD_CYCLES_PER_US;
    assert_string_equal(board_line(most_us), "NO_TARGET");
    bench.width_cycles = 0;
    assert_string_equal(board_line(most_us), "NO_RESPONSE");
    bench.width_cycles = 1000 * BOARD_CYCLES_PER_US; /* below the range */
    assert_string_equal(board_line(most_us), "UNKNOWN");
    bench.width_cycles = 120000 * BOARD_CYCLES_PER_US;
    assert_string_equal(board_line(most_us), "FAULT"); /* a stuck line */
    bench.width_cycles = 10000 * BOARD_CYCLES_PER_US;
    assert_in_range(strtoul(board_line(most_us), NULL, 10), 1737, 1741); /* 1739.1 mm */
    bench.stays_high = true;
    assert_string_equal(board_line(most_us), "FAULT");
}

TEST(nothing_in_range_no_response_and_a_stuck_line_have_names) { expect_names("a16_pwm", 2 * CYCLE_US); }

TEST(a_loop_of_20_ms_loses_nothing) { expect_names("a16_slow", 3 * CYCLE_US); }

/* The most that widths are off with falling edges so long after an overflow of Timer0, and rising ones away from it, at
 * two places of a step of micros(), which is 64 cycles, or at four. */
static double most_off_us(uint64_t first, uint64_t end, uint64_t step)
{
    double most_us = 0;
    for (uint64_t rise_at = 8000; rise_at < 8064; rise_at += board_has_time() ? 21 : 37) {
        for (uint64_t at = first; at < end; at += step) {
            bench.rise_at_cycles = rise_at;
            bench.fall_at_cycles = at;
            const double off = magnitude(off_us());
            if (off > most_us) most_us = off;
        }
    }
    return most_us;
}

TEST(a_width_is_off_by_a_step_and_the_interrupt_of_timer0_at_most)
{
    begin("a16_raw");
    bench.width_cycles = 20000 * BOARD_CYCLES_PER_US;
    off_us(); /* until Timer0's time is known */
    const double apart_us = most_off_us(4000, 4064, 22);
    const double most_us = most_off_us(1, 120, 13);
    printf("figure arduino_pulse_error %.1f us\n", most_us);
    printf("figure arduino_pulse_error_apart_from_timer0 %.1f us\n", apart_us);
    assert_true(apart_us <= STEP_US);
    assert_true(most_us <= BOUND_US);
    assert_true(most_us > STEP_US); /* it was hit */
}

/* The core counts overflows of Timer0, of 1024 us each, in 32 bits, and micros() is 1024 times that: 2^22 of them are
 * its wrap. */
TEST(a_pulse_across_the_wrap_of_micros_is_right)
{
    static const uint32_t wrap = UINT32_C(1) << 22;
    begin("a16_raw");
    bench.width_cycles = 80000 * BOARD_CYCLES_PER_US;
    assert_true(board_run_us(1500)); /* the sketch has begun, and has not triggered */
    assert_int_equal(bench.triggers, 0);
    /* The pulse has its middle 150 ms, 146 overflows, after the first trigger, which now comes at once. */
    const uint32_t count = wrap - 146;
    for (unsigned i = 0; i < 4; i++) count_of()[i] = (uint8_t)(count >> (8 * i));
    assert_true(magnitude(off_us()) <= BOUND_US);
    assert_int_equal(bench.fell_cycles / BOARD_CYCLES_PER_US, 80000);
    assert_true(bench.rise_count < wrap && bench.fall_count >= wrap);
    assert_int_equal(bench.triggers, 1);
    assert_true(magnitude(off_us()) <= BOUND_US);
}

/* ---- an HC-SR04: a high pulse of at least 10 us triggers it, and an echo of 5.8 us is a millimetre ---- */

static void on_high_trigger(void *ctx, bool high)
{
    if (high) {
        bench.low_cycle = board.avr->cycle;
        return;
    }
    bench.triggers++;
    assert_true(board.avr->cycle - bench.low_cycle >= 10 * BOARD_CYCLES_PER_US);
    avr_cycle_timer_register(board.avr, 460 * BOARD_CYCLES_PER_US, rise, NULL);
}

TEST(a_module_whose_trigger_is_high_is_triggered_and_read)
{
    memset(&bench, 0, sizeof bench);
    board_start("hc_sr04");
    board_drive('D', 2, false);
    board_watch('D', 7, false, on_high_trigger, NULL);
    bench.width_cycles = 5800 * BOARD_CYCLES_PER_US;
    assert_in_range(strtoul(line(), NULL, 10), 998, 1002);
    bench.width_cycles = 580 * BOARD_CYCLES_PER_US;
    assert_in_range(strtoul(line(), NULL, 10), 98, 102);
    bench.width_cycles = 38000 * BOARD_CYCLES_PER_US;
    assert_string_equal(line(), "NO_TARGET");
    assert_in_range(bench.triggers, 3, 5);
}
