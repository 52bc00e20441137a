/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fathom/pulse.h"

/* The capture looks for pulses before the trigger falls: or what an interrupt lets pass between the two would be lost.
 * Here the sensor answers in the very moment of the edge, with the example of A16 1: 10000 us. */

enum { WIDTH_US = 10000 };

static uint32_t now_us;
static bool is_low;
static bool is_waiting; /* the pulse, to be taken */
static unsigned falls;
static unsigned busy; /* so many times the port cannot begin a break yet */

static uint32_t clock_now_us(void *ctx) { return (void)ctx, now_us; }

static void drive(bool low)
{
    if (low && !is_low) {
        falls++;
        is_waiting = true;
    }
    is_low = low;
}

static void set_pin(void *ctx, bool high)
{
    (void)ctx;
    drive(!high);
}

static int set_break(void *ctx, bool on)
{
    (void)ctx;
    if (on && busy != 0) {
        busy--;
        return 0;
    }
    drive(on);
    return 1;
}

/* hal.h: what was captured before is forgotten. */
static void arm(void *ctx)
{
    (void)ctx;
    is_waiting = false;
}

static int take(void *ctx, fathom_pulse_t *pulse)
{
    (void)ctx;
    pulse->is_high = false;
    if (!is_waiting) return 0;
    is_waiting = false;
    pulse->width_us = WIDTH_US;
    pulse->end_us = now_us;
    return 1;
}

static const fathom_clock_t hal_clock = {clock_now_us, NULL};
static const fathom_capture_t capture = {arm, take, NULL};
static const fathom_pin_t trigger = {set_pin, NULL, NULL};
static const fathom_uart_t uart = {NULL, NULL, NULL, NULL, set_break, NULL};

static void assert_every_trigger_is_answered(const fathom_pulse_config_t *config)
{
    static const uint32_t starts_us[] = {1000, 0xFFFFFFFFu - 300000};
    static const uint32_t loops_us[] = {500, 20000};
    for (unsigned i = 0; i != 4; i++) {
        fathom_pulse_meter_t meter;
        fathom_pulse_reading_t reading;
        unsigned readings = 0;
        now_us = starts_us[i / 2];
        is_low = false;
        is_waiting = false;
        falls = 0;
        busy = 5;
        assert_int_equal(fathom_pulse_init(&meter, config), FATHOM_READY);
        for (uint32_t passed_us = 0; passed_us < 2000000; passed_us += loops_us[i % 2]) {
            now_us += loops_us[i % 2];
            const fathom_status_t status = fathom_pulse_poll(&meter, &reading);
            assert_true(status == FATHOM_PENDING || status == FATHOM_READY);
            if (status != FATHOM_READY) continue;
            readings++;
            assert_int_equal(reading.kind, FATHOM_TARGET);
            assert_int_equal(reading.width_us, WIDTH_US);
            assert_int_equal(readings, falls);
        }
        assert_true(falls >= 8); /* 2 s of cycles of 240 ms at most */
        assert_int_equal(readings, falls);
    }
}

TEST(a_pulse_that_begins_with_the_edge_counts)
{
    const fathom_pulse_config_t config = {.clock = &hal_clock, .capture = &capture, .trigger = &trigger};
    assert_every_trigger_is_answered(&config);
}

TEST(a_pulse_that_begins_with_a_break_counts)
{
    const fathom_pulse_config_t config = {.clock = &hal_clock, .capture = &capture, .uart = &uart};
    assert_every_trigger_is_answered(&config);
}
