/* SPDX-License-Identifier: MIT */
#include <simavr/sim_cycle_timers.h>
#include <simavr/sim_interrupts.h>
#include <stdlib.h>

#include "suite.h"

#include "profile.h"

/*
 * How well a pulse of 1..94 ms is measured, both ways at once on the same edges. Bounds: input capture within 1 us,
 * always; INT0 within 1 us when no other interrupt was due at an edge, else within the longest of them and 1 us.
 *
 * The image `pulses` has a signal of known edges at its two inputs, PB0 (ICP1) and PD2 (INT0). They are placed to the
 * cycle, by the processor's own timers and not by port/sim, which knows whole microseconds.
 */
enum { MS = 1000 * BOARD_CYCLES_PER_US, US = BOARD_CYCLES_PER_US };

/* A character of 8N1 at 115200 baud, and 3 % of slack: what is sent back keeps up. */
enum { BYTE_CYCLES = 1430 };

/* Odd steps, so that edges and the timer's ticks fall on each other in every way. */
enum { STEP_CYCLES = MS + 37, SPREAD_CYCLES = 3 * MS + 1013 };

enum { BY_ICP1 = 1, BY_INT0 = 2, REPORT_BYTES = 9 };
enum { TCCR1B = 0x81, ICES1 = 0x40 }; /* ATmega328P 36, 16.11.2 */
enum { READY_US = 1000, PATIENCE_US = 40000, GLITCH_US = 200 };
enum { PERIOD_CYCLES = 65536 * 8 }; /* of Timer1 */

static struct {
    uint64_t overflow_cycle; /* of Timer1, the last one */
    uint64_t rise_cycle;     /* of the last pulse: when its edges really were, */
    uint64_t fall_cycle;
    bool masked; /* and whether another interrupt ran or was due at one, or the main loop kept it out */
    uint64_t fall_at_cycle; /* when it is to fall */
    uint32_t passed_over_us;
    uint8_t byte;   /* of the traffic */
    bool is_rising; /* the edge that is captured next */
} rig;

/* What the image says of one pulse, by BY_ICP1 and by BY_INT0. */
typedef struct {
    uint32_t us[3], end_us[3];
    uint8_t missed; /* edges, by either, so far */
} pulse_report_t;

static void drive(bool high)
{
    /* Off; or on again since the last instruction, after which one more comes first; or another waits. */
    const avr_t *const avr = board.avr;
    if (avr->sreg[S_I] == 0 || avr->interrupt_state != 0) rig.masked = true;
    board_drive('B', 0, high);
    board_drive('D', 2, high);
}

static avr_cycle_count_t fall(avr_t *avr, avr_cycle_count_t when, void *param)
{
    rig.fall_cycle = avr->cycle;
    drive(false);
    return 0;
}

static avr_cycle_count_t rise(avr_t *avr, avr_cycle_count_t when, void *param)
{
    rig.rise_cycle = avr->cycle;
    rig.masked = false;
    drive(true);
    const uint64_t at = rig.fall_at_cycle;
    avr_cycle_timer_register(avr, at > avr->cycle ? at - avr->cycle : 1, fall, NULL);
    return 0;
}

static avr_cycle_count_t byte_comes(avr_t *avr, avr_cycle_count_t when, void *param)
{
    usart_arrive(&board.usart, rig.byte++, 0);
    return when + BYTE_CYCLES;
}

static void overflow(struct avr_irq_t *irq, uint32_t value, void *param)
{
    if (value != 0) rig.overflow_cycle = board.avr->cycle;
}

/* The capture's flag may rise when its edge is changed (ATmega328P 16.6.3): here it always does. */
static void control_written(avr_t *avr, avr_io_addr_t address, uint8_t value, void *param)
{
    const bool was_rising = rig.is_rising;
    rig.is_rising = (value & ICES1) != 0;
    if (rig.is_rising == was_rising) return;
    for (uint8_t i = 0; i < avr->interrupts.vector_count; i++)
        if (avr->interrupts.vector[i]->vector == PROFILE_TIMER1_CAPTURE)
            avr_raise_interrupt(avr, avr->interrupts.vector[i]);
}

static int set_up(void **state)
{
    board_start("pulses");
    memset(&rig, 0, sizeof rig);
    profile_begin();
    avr_irq_t *const irq = avr_get_interrupt_irq(board.avr, PROFILE_TIMER1_OVERFLOW);
    assert_non_null(irq);
    avr_irq_register_notify(irq + AVR_INT_IRQ_PENDING, overflow, NULL);
    avr_register_io_write(board.avr, TCCR1B, control_written, NULL);
    board_drive('B', 0, false);
    board_drive('D', 2, false);
    assert_true(board_run_us(READY_US));
    return 0;
}

/* From now on a byte comes every so many cycles, each of which is sent back. */
static void traffic(void) { avr_cycle_timer_register(board.avr, BYTE_CYCLES, byte_comes, NULL); }

/* One pulse, beginning at this cycle or, if that has passed, at once. Fails the test unless each way tells one pulse
 * of it. */
static pulse_report_t pulse(uint64_t at_cycle, uint64_t width_cycles)
{
    avr_t *const avr = board.avr;
    const uint64_t begin = at_cycle > avr->cycle ? at_cycle : avr->cycle + 1;
    rig.fall_at_cycle = begin + width_cycles;
    avr_cycle_timer_register(avr, begin - avr->cycle, rise, NULL);

    pulse_report_t report = {0};
    bool has[3] = {false}; /* by BY_ICP1 and by BY_INT0 */
    const uint64_t us = (rig.fall_at_cycle - avr->cycle) / BOARD_CYCLES_PER_US + PATIENCE_US;
    while (!has[BY_ICP1] || !has[BY_INT0]) {
        const board_record_t *const record = board_next_record(us);
        assert_non_null(record);
        assert_int_equal(record->length, REPORT_BYTES);
        if (board_number(record->bytes, 4) < rig.passed_over_us) continue;
        assert_in_range(record->kind, BY_ICP1, BY_INT0);
        assert_false(has[record->kind]);
        has[record->kind] = true;
        report.us[record->kind] = board_number(record->bytes, 4);
        report.end_us[record->kind] = board_number(record->bytes + 4, 4);
        report.missed = (uint8_t)(report.missed + record->bytes[8]);
    }
    rig.passed_over_us = 0;
    return report;
}

/* A glitch that may be reported or not, beginning then: pulse() passes over pulses that are reported with less than
 * GLITCH_US. */
static void glitch(uint64_t at_cycle, uint64_t width_cycles)
{
    for (int high = 1; high >= 0; high--) {
        const uint64_t cycle = high != 0 ? at_cycle : at_cycle + width_cycles;
        board_drive_at('B', 0, high != 0, cycle);
        board_drive_at('D', 2, high != 0, cycle);
    }
    rig.passed_over_us = GLITCH_US;
}

/* The error of a width, in cycles: reported less true. */
static int64_t error_of(uint32_t told_us)
{
    return (int64_t)told_us * BOARD_CYCLES_PER_US - (int64_t)(rig.fall_cycle - rig.rise_cycle);
}

/* The longest time for which one interrupt keeps the others out, INT0's own left out, in cycles. */
static uint32_t longest_cycles(void)
{
    uint32_t longest = 0;
    for (int i = 0; i < PROFILE_VECTORS; i++) {
        const uint32_t cycles = profile.interrupts[i].longest_cycles;
        if (i != PROFILE_INT0 && cycles > longest) longest = cycles;
    }
    return longest + BOARD_ENTRY_CYCLES;
}

static const suite_t suite = {.set_up = set_up, .tear_down = board_stop};

typedef struct {
    uint32_t pulses, masked;
    int64_t icp1; /* the largest errors, in cycles */
    int64_t int0, int0_masked;
} errors_t;

static void keep(int64_t *largest, int64_t error)
{
    if (llabs(error) > *largest) *largest = llabs(error);
}

/* When it ended, by input capture. */
static uint32_t measure(errors_t *errors, uint64_t at_cycle, uint64_t width_cycles)
{
    const pulse_report_t report = pulse(at_cycle, width_cycles);
    assert_int_equal(report.missed, 0);
    errors->pulses++;
    if (rig.masked) errors->masked++;
    keep(&errors->icp1, error_of(report.us[BY_ICP1]));
    keep(rig.masked ? &errors->int0_masked : &errors->int0, error_of(report.us[BY_INT0]));
    /* The ends agree to what INT0 may be late. */
    assert_in_range(report.end_us[BY_INT0] - report.end_us[BY_ICP1], 0, 1 + longest_cycles() / US);
    return report.end_us[BY_ICP1];
}

static void check(const errors_t *errors, const char *what)
{
    const uint32_t longest = longest_cycles();
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
        measure(errors, board.avr->cycle + SPREAD_CYCLES, width);
    measure(errors, board.avr->cycle + SPREAD_CYCLES, 94 * MS);
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
    traffic();
    sweep(&errors);
    sweep(&errors);
    check(&errors, "with traffic");
    assert_true(errors.masked > 20); /* there was something to disturb it */
    assert_true(errors.pulses - errors.masked > 20);
}

/* The rise, then the fall of pulses at each cycle around the overflow, or at each so many (odd, for the ticks of 8):
 * from well before it, so that it comes while the interrupts of the edge wait or run, to behind it. */
static void sweep_overflow(errors_t *errors, int step, bool rising)
{
    enum { BEFORE_CYCLES = 300, AFTER_CYCLES = 100, WIDTH_CYCLES = 5 * MS, NEAR_CYCLES = 24 };
    for (int offset = -BEFORE_CYCLES; offset <= AFTER_CYCLES; offset += step) {
        uint64_t edge = rig.overflow_cycle + PERIOD_CYCLES + (uint64_t)(int64_t)offset;
        measure(errors, rising ? edge : edge - WIDTH_CYCLES, WIDTH_CYCLES);
        /* That is where it was. */
        edge = rising ? rig.rise_cycle : rig.fall_cycle;
        const int64_t from = (int64_t)(edge - rig.overflow_cycle) - offset + PERIOD_CYCLES;
        assert_in_range((from + NEAR_CYCLES) % PERIOD_CYCLES, 0, 2 * NEAR_CYCLES);
    }
}

TEST(an_edge_at_any_cycle_around_the_overflow_of_the_timer_has_its_right_time)
{
    errors_t errors = {0};
    assert_true(board_run_us(40000)); /* until there was one */
    assert_true(rig.overflow_cycle != 0);
    sweep_overflow(&errors, board_has_time() ? 1 : 3, true);
    sweep_overflow(&errors, board_has_time() ? 1 : 3, false);
    check(&errors, "around the overflow");
}

TEST(so_has_one_while_bytes_come_and_go)
{
    errors_t errors = {0};
    assert_true(board_run_us(40000));
    traffic();
    sweep_overflow(&errors, board_has_time() ? 3 : 7, true);
    sweep_overflow(&errors, board_has_time() ? 3 : 7, false);
    check(&errors, "around the overflow, with traffic");
}

TEST(a_pulse_across_the_wrap_of_the_clock_is_measured_within_1_us)
{
    errors_t errors = {0};
    const uint64_t wrap = (1ull << 32) * US;
    measure(&errors, 0, 94 * MS); /* it works, so it will sleep */
    assert_true(board_run_us(UINT32_MAX - 200000));
    uint32_t end_us = UINT32_MAX;
    while (end_us > 94000) {
        assert_true(board.avr->cycle < wrap);
        end_us = measure(&errors, board.avr->cycle + SPREAD_CYCLES, 94 * MS);
    }
    check(&errors, "across the wrap");
}

TEST(pulses_down_to_60_us_are_measured_as_well)
{
    errors_t errors = {0};
    for (uint64_t width = 60 * US; width <= 3 * MS; width += 61 * US + 7)
        measure(&errors, board.avr->cycle + MS + width, width);
    check(&errors, "short");
}

/* Of glitches of any length, shorter than the interrupts and longer, at both ends of the pause before a pulse. */
TEST(glitches_leave_the_pulse_after_them_as_it_is)
{
    errors_t errors = {0};
    for (uint64_t width = 1; width <= 70 * US; width += 11) {
        const uint64_t at = board.avr->cycle + MS;
        glitch(at, width);
        measure(&errors, at + width + 100 * US, 3 * MS);
    }
    check(&errors, "after a glitch");
    assert_true(errors.pulses > 100);
}
