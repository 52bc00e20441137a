/* SPDX-License-Identifier: MIT */
#include <errno.h>

#include "gpio_chip.h"

/* Pulses made of the kernel's events, at chosen times; each width is the difference of two of them. */

static fathom_gpio_t gpio;
static fathom_capture_t capture;
static chip_line_t *const wire = &chip.lines[0];

static void open_echo(void)
{
    assert_int_equal(fathom_gpio_open_edges(&gpio, "gpiochip0", 27, FATHOM_GPIO_BIAS_AS_IS), FATHOM_GPIO_OK);
    capture = fathom_gpio_capture(&gpio);
}

static int begins(void **state)
{
    chip_reset();
    open_echo();
    capture.arm(capture.ctx);
    return 0;
}

static int ends(void **state)
{
    fathom_gpio_close(&gpio);
    chip_reset();
    return 0;
}

static const suite_t suite = {.set_up = begins, .tear_down = ends};

static void pulse(uint64_t rise_us, uint64_t fall_us)
{
    chip_edge(wire, true, rise_us);
    chip_edge(wire, false, fall_us);
}

static void expect_pulse(uint32_t width_us, uint32_t end_us)
{
    fathom_pulse_t taken = {0, 0, false};
    assert_int_equal(capture.take(capture.ctx, &taken), 1);
    assert_int_equal(taken.width_us, width_us);
    assert_int_equal(taken.end_us, end_us);
    assert_int_equal(taken.is_high, wire->level);
}

static void expect_none(void)
{
    fathom_pulse_t taken = {0, 0, !wire->level};
    assert_int_equal(capture.take(capture.ctx, &taken), 0);
    assert_int_equal(taken.is_high, wire->level);
    assert_int_equal(wire->events, 0); /* the descriptor is not ready any more */
}

static void expect_lost(void)
{
    fathom_pulse_t taken;
    assert_true(capture.take(capture.ctx, &taken) < 0);
    assert_int_equal(fathom_gpio_error(&gpio), FATHOM_GPIO_ERR_LOST);
}

TEST(a_width_is_the_difference_of_the_stamps)
{
    expect_none();
    pulse(1000000, 1003000);
    expect_pulse(3000, 1003000);
    pulse(2000000, 2094000);
    expect_pulse(94000, 2094000);
    expect_none();
    assert_int_equal(gpio.events, 4);
    assert_int_equal(gpio.lost_events, 0);
}

/* The stamps are 64 bits of ns since the system began; the clock of hal.h is 32 bits of us. */
TEST(stamps_wrap_as_the_clock_does)
{
    pulse(4294966296u, 4294969296u); /* 2^32 - 1000, and 3000 later */
    expect_pulse(3000, 2000);
    pulse(86400000000u * 365, 86400000000u * 365 + 10000); /* 31536000000000 - 7342 * 2^32 is 2350112768 */
    expect_pulse(10000, 2350122768u);
}

TEST(an_edge_alone_is_no_pulse)
{
    chip_edge(wire, true, 1000);
    expect_none(); /* which says that it is high */
    chip_edge(wire, false, 6000);
    expect_pulse(5000, 6000);
}

TEST(a_slow_edge_that_bounces_within_50_us_is_one)
{
    chip_edge(wire, true, 100000);
    chip_edge(wire, true, 100050);
    chip_edge(wire, false, 110000);
    chip_edge(wire, false, 110040);
    expect_pulse(10000, 110000);
    expect_none();
    assert_int_equal(gpio.edges.missed, 0);
    /* Two rises 51 us apart: the fall between them was missed, and with it both widths. */
    chip_edge(wire, true, 200000);
    chip_edge(wire, true, 200051);
    chip_edge(wire, false, 210000);
    expect_none();
    assert_int_equal(gpio.edges.missed, 1);
    pulse(300000, 303000);
    expect_pulse(3000, 303000);
}

TEST(arm_forgets_what_was_queued_and_what_has_begun)
{
    for (uint32_t i = 0; i != 10; i++)
        pulse(1000 + 10000 * i, 5000 + 10000 * i); /* more than edges.h keeps */
    capture.arm(capture.ctx);
    assert_int_equal(wire->events, 0);
    expect_none();
    chip_edge(wire, true, 200000);
    capture.arm(capture.ctx);
    chip_edge(wire, false, 204000);
    expect_none();
    pulse(210000, 213000);
    expect_pulse(3000, 213000);
}

/* The line fell and nothing has told: a driver of the chip that loses interrupts, as edges.h has it. */
TEST(arm_finds_out_that_a_fall_was_missed)
{
    chip_edge(wire, true, 1000);
    expect_none();
    wire->level = false;
    capture.arm(capture.ctx);
    pulse(300000, 303000);
    expect_pulse(3000, 303000);
}

TEST(pulses_that_wait_are_taken_in_order_and_none_is_lost)
{
    for (uint32_t i = 0; i != 20; i++) pulse(1000 + 1000 * i, 1100 + i + 1000 * i);
    for (uint32_t i = 0; i != 20; i++) expect_pulse(100 + i, 1100 + i + 1000 * i);
    expect_none();
    assert_int_equal(gpio.edges.lost, 0);
}

TEST(the_level_is_asked_for_and_the_events_are_taken_with_it)
{
    const fathom_pin_t pin = fathom_gpio_pin(&gpio);
    pulse(1000, 5000);
    chip_edge(wire, true, 9000);
    assert_null(pin.set);
    assert_true(pin.get(pin.ctx));
    assert_int_equal(wire->events, 0);
    expect_pulse(4000, 5000);
    chip_edge(wire, false, 12000);
    assert_false(pin.get(pin.ctx));
    expect_pulse(3000, 12000);
}

/* ---- events that the queue has lost ---- */

static void expect_goes_on(unsigned lost)
{
    expect_none();
    assert_int_equal(gpio.lost_events, lost);
    pulse(900000, 903000);
    expect_pulse(3000, 903000);
    assert_int_equal(gpio.lost_events, lost);
}

TEST(a_lost_rise_makes_no_pulse)
{
    chip_lose(wire, true);
    chip_edge(wire, false, 5000);
    expect_goes_on(1);
}

TEST(a_lost_fall_makes_no_pulse_of_the_next_fall)
{
    chip_edge(wire, true, 1000);
    chip_lose(wire, false);
    chip_edge(wire, true, 200000); /* high from 1000, as it seems */
    chip_edge(wire, false, 205000);
    expect_goes_on(1);
}

TEST(a_lost_fall_and_rise_make_no_long_pulse)
{
    chip_edge(wire, true, 1000);
    chip_lose(wire, false);
    chip_lose(wire, true);
    chip_edge(wire, false, 90000); /* 89 ms would be a target */
    expect_goes_on(2);
}

TEST(a_lost_pulse_is_counted_and_no_more)
{
    pulse(1000, 4000);
    chip_lose(wire, true);
    chip_lose(wire, false);
    chip_edge(wire, true, 20000);
    expect_pulse(3000, 4000);
    /* A rise after a gap may be the second one of a bounce: its pulse is given up. */
    chip_edge(wire, false, 23000);
    expect_goes_on(2);
}

TEST(several_gaps_add_up)
{
    chip_lose(wire, true);
    chip_edge(wire, false, 1000);
    pulse(10000, 13000);
    for (unsigned i = 0; i != 7; i++) chip_lose(wire, i % 2 == 0);
    chip_edge(wire, false, 50000);
    pulse(60000, 64000);
    expect_pulse(3000, 13000);
    expect_pulse(4000, 64000);
    expect_goes_on(8);
}

/* 64 places: of 33 pulses the first is dropped, both edges; of 32 and a rise its rise only. */
TEST(a_full_queue_drops_the_oldest)
{
    for (uint32_t i = 0; i != 33; i++) pulse(1000 + 1000 * i, 1500 + 1000 * i);
    /* The second pulse's rise is the first event after the gap. */
    for (uint32_t i = 2; i != 33; i++) expect_pulse(500, 1500 + 1000 * i);
    expect_goes_on(2);
}

TEST(a_full_queue_that_drops_a_rise_makes_no_pulse_of_its_fall)
{
    for (uint32_t i = 0; i != 32; i++) pulse(1000 + 1000 * i, 1500 + 1000 * i);
    chip_edge(wire, true, 100000);
    for (uint32_t i = 1; i != 32; i++) expect_pulse(500, 1500 + 1000 * i);
    expect_none();
    assert_int_equal(gpio.lost_events, 1);
    chip_edge(wire, false, 103000);
    expect_pulse(3000, 103000);
}

TEST(the_numbers_of_events_wrap)
{
    wire->last_seqno = 0xFFFFFFFDu;
    gpio.line_seqno = 0xFFFFFFFDu;
    for (uint32_t i = 0; i != 4; i++)
        pulse(10000 * i + 1000, 10000 * i + 4000); /* FFFFFFFE, FFFFFFFF, 0, 1, ... */
    for (uint32_t i = 0; i != 4; i++) expect_pulse(3000, 10000 * i + 4000);
    assert_int_equal(gpio.lost_events, 0);
    wire->last_seqno = 0xFFFFFFFEu;
    gpio.line_seqno = 0xFFFFFFFEu;
    chip_lose(wire, true);         /* FFFFFFFF */
    chip_lose(wire, false);        /* 0 */
    chip_edge(wire, true, 100000); /* 1 */
    chip_edge(wire, false, 105000);
    expect_goes_on(2);
}

TEST(more_than_16_bits_of_lost_events_are_counted)
{
    for (unsigned i = 0; i != 70000; i++) chip_lose(wire, i % 2 == 0);
    chip_edge(wire, true, 5000);
    chip_edge(wire, false, 8000);
    expect_goes_on(70000);
}

TEST(what_was_lost_before_arm_is_counted_and_costs_nothing)
{
    chip_lose(wire, true);
    chip_edge(wire, false, 1000);
    chip_edge(wire, true, 2000);
    chip_lose(wire, false);
    chip_edge(wire, true, 3000);
    wire->level = false;
    capture.arm(capture.ctx);
    pulse(100000, 103000);
    expect_pulse(3000, 103000);
    assert_int_equal(gpio.lost_events, 2);
}

/* They bounce, so that none of them makes a pulse. 64 lines of 16 events are what the kernel's queue has at most. */
TEST(events_that_come_as_fast_as_they_are_read_hold_nothing_up)
{
    const fathom_pin_t pin = fathom_gpio_pin(&gpio);
    fathom_pulse_t taken;
    chip.is_endless = true;
    assert_int_equal(capture.take(capture.ctx, &taken), 0);
    assert_true(gpio.events >= 64 * 16);
    uint32_t before = gpio.events;
    assert_true(pin.get(pin.ctx));
    assert_true(gpio.events - before >= 64 * 16);
    before = gpio.events;
    capture.arm(capture.ctx);
    assert_true(gpio.events - before >= 64 * 16);
}

/* ---- when a system call fails ---- */

TEST(an_interrupted_read_is_repeated)
{
    pulse(1000, 4000);
    chip.interrupts = 2;
    expect_pulse(3000, 4000);
    assert_int_equal(chip.interrupts, 0);
}

TEST(a_chip_that_goes_is_lost_for_good)
{
    chip_edge(wire, true, 1000);
    expect_none();
    chip.read_error = ENODEV;
    expect_lost();
    gpio_says(&gpio, "/dev/gpiochip0, line 27: the chip has gone (No such device)");
    chip.read_error = 0;
    chip_edge(wire, false, 4000);
    expect_lost();
    capture.arm(capture.ctx);
    expect_lost();
}

TEST(a_chip_that_goes_before_its_level_is_read_is_lost)
{
    chip.level_error = ENODEV;
    expect_lost();
}

TEST(a_chip_that_goes_in_arm_is_lost)
{
    chip.read_error = ENODEV;
    capture.arm(capture.ctx);
    chip.read_error = 0;
    expect_lost();
}

TEST(half_an_event_is_an_error_and_not_an_edge)
{
    chip_edge(wire, true, 1000);
    chip.short_read = 24;
    expect_lost();
    gpio_says(&gpio, "reading its events: Input/output error");
    assert_int_equal(gpio.events, 0);
}

TEST(one_that_was_closed_is_no_use_and_one_that_was_opened_again_begins_anew)
{
    pulse(1000, 4000);
    fathom_gpio_close(&gpio);
    assert_int_equal(fathom_gpio_fd(&gpio), -1);
    fathom_pulse_t taken;
    assert_true(capture.take(capture.ctx, &taken) < 0);
    capture.arm(capture.ctx);
    fathom_gpio_close(&gpio);

    chip.read_error = 0;
    open_echo();
    assert_true(fathom_gpio_fd(&gpio) >= 0);
    assert_int_equal(gpio.events + gpio.lost_events, 0);
    pulse(500000, 503000); /* the first event has the number 1 again */
    expect_pulse(3000, 503000);
    assert_int_equal(gpio.lost_events, 0);
}

/* The system gives the number of its descriptor to the next one that is opened. */
TEST(one_that_is_closed_takes_no_events_of_the_others)
{
    static fathom_gpio_t next;
    const int fd = fathom_gpio_fd(&gpio);
    fathom_gpio_close(&gpio);
    assert_int_equal(fathom_gpio_open_edges(&next, "gpiochip0", 22, FATHOM_GPIO_BIAS_AS_IS), FATHOM_GPIO_OK);
    assert_int_equal(fathom_gpio_fd(&next), fd);
    chip_edge(wire, true, 1000);
    capture.arm(capture.ctx);
    fathom_pulse_t taken;
    assert_true(capture.take(capture.ctx, &taken) < 0);
    const fathom_pin_t pin = fathom_gpio_pin(&gpio);
    assert_false(pin.get(pin.ctx));
    assert_int_equal(wire->events, 1);
    fathom_gpio_close(&next);
}

TEST(a_line_that_is_high_when_it_is_opened_has_no_rise)
{
    wire->level = true;
    fathom_gpio_close(&gpio);
    memset(&gpio, 0xA5, sizeof gpio);
    open_echo();
    wire->level = true;
    capture.arm(capture.ctx);
    chip_edge(wire, false, 5000);
    expect_none();
}
