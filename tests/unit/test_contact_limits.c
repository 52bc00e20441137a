/* SPDX-License-Identifier: MIT */
#include "contact_rig.h"
#include "fathom/engine/line_pins.h"

/* contact.h to the microsecond: when it is stale, when it is due, and for how long a line is not looked at. */
enum { START_US = 1000 };

static fathom_contact_timing_t timing;
static fathom_contact_t contact;

static void start_on(uint8_t fill, const fathom_contact_guard_t *guard)
{
    memset(&contact, fill, sizeof contact);
    contact.pin = &pins.pin;
    contact.clock = &pins.fake.clock;
    contact.guard = guard;
    contact.near_is_high = true;
    contact.model = FATHOM_A16;
    contact.address = 0;
    assert_int_equal(fathom_contact_init(&contact, &timing), FATHOM_OK);
    pins.sensor = fathom_contact_sensor(&contact);
}

static int set_up(void **state)
{
    memset(&timing, 0, sizeof timing);
    pins_start(START_US);
    start_on(0x5A, NULL);
    return 0;
}

static const suite_t suite = {.set_up = set_up};

static fathom_status_t poll_after(uint32_t us)
{
    pins.fake.now_us += us;
    return pins_poll();
}

static uint32_t due_us(void) { return pins.sensor.due_us(pins.sensor.ctx); }

/* "stale_us ... 0: 2 s": "no level has counted for so long ... or it is held". */
TEST(without_a_level_that_counts_it_is_stale_after_2_s)
{
    fathom_contact_set_hold(&contact, true);
    assert_int_equal(poll_after(1999999), FATHOM_PENDING);
    assert_int_equal(poll_after(1), FATHOM_ERR_STALE);
}

/* "FATHOM_OK: a sample: the first level that counts", whatever the memory held: of a sample that was FATHOM_NEAR,
 * too. */
TEST(the_first_level_is_told_whatever_stood_in_the_memory)
{
    static const uint8_t fills[] = {FATHOM_NEAR, FATHOM_FAR, 0xFF, true}; /* held, too */
    for (unsigned level = 0; level != 2; level++)
        for (unsigned i = 0; i != sizeof fills; i++) {
            pins_start(START_US);
            pins.level = level != 0;
            start_on(fills[i], NULL);
            poll_after(10000);
            assert_int_equal(poll_after(10000), FATHOM_OK);
            pins_expect(1, level != 0 ? FATHOM_NEAR : FATHOM_FAR);
        }
}

/* The rig hands over a sample full of A5. */
TEST(a_sample_has_a_level_and_nothing_that_is_measured)
{
    const bool no = false;
    pins.level = true;
    poll_after(10000);
    assert_int_equal(poll_after(20000), FATHOM_OK);
    assert_int_equal(pins.sample.kind, FATHOM_NEAR);
    assert_int_equal(pins.sample.raw, 1);
    assert_int_equal(pins.sample.distance_mm, 0);
    assert_int_equal(pins.sample.magnitude, 0);
    assert_int_equal(pins.sample.precision, 0);
    assert_int_equal(pins.sample.ambient, 0);
    assert_memory_equal(&pins.sample.interference, &no, sizeof no);
    assert_int_equal(pins.sample.model, FATHOM_A16);
    assert_int_equal(pins.sample.address, 0);
    assert_int_equal(pins.sample.probe, 1);
}

/* fathom_contact_set_near_is_high(): "The level has to settle anew". */
TEST(a_level_settles_anew_when_it_means_something_else)
{
    assert_int_equal(poll_after(20000), FATHOM_OK);
    pins_expect(1, FATHOM_FAR);
    fathom_contact_set_near_is_high(&contact, false);
    assert_int_equal(poll_after(19999), FATHOM_PENDING);
    assert_int_equal(poll_after(1), FATHOM_OK);
    pins_expect(2, FATHOM_NEAR);
    assert_int_equal(pins.sample.time_us, START_US + 20000);
}

/* "The longest that due_us advises between looks". */
TEST(the_next_look_is_due_look_us_after_the_last_one)
{
    timing.interval_us = 100000;
    start_on(0, NULL);
    assert_int_equal(poll_after(20000), FATHOM_OK);
    assert_int_equal(due_us(), 100000);
    pins.fake.now_us += 70000;
    assert_int_equal(due_us(), 30000);
    pins.fake.now_us += 30001;
    assert_int_equal(due_us(), 0);
}

/* "the level is not looked at ... until 5 ms after the last byte". The first look at which it is looked at is at 5000
 * us, and with a settle_us of 1 the next look 1 us later is enough. */
TEST(a_level_counts_again_5_ms_after_the_last_byte_on_its_line)
{
    static const uint8_t byte[] = {0x00};
    static uint8_t frame[8];
    static fathom_line_parts_t config;
    static fathom_line_t line;
    const fathom_contact_guard_t guard = fathom_contact_line_guard(&line);
    config = (fathom_line_parts_t){.uart = &pins.fake.uart,
                                   .clock = &pins.fake.clock,
                                   .frame = frame,
                                   .frame_size = sizeof frame,
                                   .echo = FATHOM_LINE_ECHO_OFF,
                                   .marks = fathom_line_marks};
    assert_int_equal(fathom_line_init(&line, &config), FATHOM_OK);
    timing.settle_us = 1;
    start_on(0, &guard);
    fake_receive(&pins.fake, 100, byte, 1);
    assert_int_equal(poll_after(100), FATHOM_PENDING);
    assert_int_equal(poll_after(4999), FATHOM_PENDING);
    assert_int_equal(poll_after(1), FATHOM_PENDING);
    assert_int_equal(poll_after(1), FATHOM_OK);
    assert_int_equal(pins.sample.time_us, START_US + 100 + 5000);
}
