/* SPDX-License-Identifier: MIT */
#include "auto_rig.h"
#include "fake_pin.h"
#include "fathom/engine/line_pins.h"
#include "fathom/sensor/a16_auto.h"

/* What test_driver_contract.c does not ask of every listener. */

static fathom_a16_auto_config_t config;
static fathom_a16_auto_t a16;
static fake_pin_t pin;

/* A16 2(4): 1953 mm. */
static const uint8_t mm_1953[] = {0xFF, 0x07, 0xA1, 0xA7};

static void start_at(uint32_t now_us)
{
    rig_start(now_us);
    fake_pin_init(&pin, &rig.fake);
    memset(&a16, 0x5A, sizeof a16);
    assert_int_equal(fathom_a16_auto_init(&a16, &rig.line, &config), FATHOM_OK);
    rig.sensor = fathom_a16_auto_sensor(&a16);
}

static void start(void) { start_at(RIG_START_US); }

static int set_up(void **state)
{
    memset(&config, 0, sizeof config);
    start();
    return 0;
}

static const suite_t suite = {.set_up = set_up};

/* ---- readings ---- */

TEST(a_sample_is_there_5_ms_after_its_last_byte_and_says_when_that_came)
{
    rig_run(20000, 500);
    fake_receive(&rig.fake, 0, mm_1953, 3);
    PENDS(rig_poll());
    fake_receive(&rig.fake, 0, mm_1953 + 3, 1);
    const uint32_t came_us = rig.fake.now_us;
    PENDS(rig_poll());
    rig.fake.now_us += 4999;
    PENDS(rig_poll());
    assert_int_equal(fathom_due_us(&rig.sensor, 1), 1);
    rig.fake.now_us += 1;
    assert_int_equal(fathom_due_us(&rig.sensor, 1), 0);
    assert_int_equal(rig_poll(), FATHOM_OK);
    assert_int_equal(rig.sample.time_us, came_us);
    assert_int_equal(rig.sample.distance_mm, 1953);
    PENDS(rig_poll());
}

/* A USB adapter holds bytes back for up to 16 ms in the middle of a frame, and the parts of its line say so (line.h). */
TEST(a_frame_in_two_pieces_is_whole_if_the_line_has_a_long_gap)
{
    rig.line_parts.gap_us = 25000;
    assert_int_equal(fathom_line_init(&rig.line, &rig.line_parts), FATHOM_OK);
    assert_int_equal(fathom_a16_auto_init(&a16, &rig.line, NULL), FATHOM_OK);
    rig_run(30000, 500);
    fake_receive(&rig.fake, 0, mm_1953, 2);
    rig_run(16000, 500);
    fake_receive(&rig.fake, 0, mm_1953 + 2, 2);
    rig_run(24000, 500);
    assert_int_equal(rig.samples, 0); /* it may go on */
    rig_run(2000, 500);
    assert_int_equal(rig.samples, 1);
    assert_int_equal(rig.sample.distance_mm, 1953);
    assert_int_equal(rig.damaged, 0);
}

/* The gap of a connection whose responses come whole is 1000 us, which is less than a character here. */
TEST(a_short_gap_of_the_line_changes_nothing)
{
    rig.line_parts.gap_us = 1000;
    assert_int_equal(fathom_line_init(&rig.line, &rig.line_parts), FATHOM_OK);
    assert_int_equal(fathom_a16_auto_init(&a16, &rig.line, NULL), FATHOM_OK);
    assert_int_equal(a16.base.stream.listener.gap_us, 5000);
}

/* The byte behind it has come in time, but is read only when the silence would have been long enough. */
TEST(a_byte_that_has_come_is_looked_at_before_the_silence)
{
    rig_run(20000, 500);
    fake_receive(&rig.fake, 0, mm_1953, 4);
    PENDS(rig_poll());
    fake_receive(&rig.fake, 1042, mm_1953 + 3, 1); /* A7 begins nothing */
    rig_run(20000, 20000);
    assert_int_equal(rig.samples, 0);
    assert_int_equal(a16.base.stream.counters[FATHOM_STREAM_UNSURE], 1);
}

TEST(the_time_is_the_ports_stamp_where_it_has_one)
{
    static const uint32_t starts_us[] = {1000, UINT32_MAX - 60000, UINT32_MAX - 45000};
    for (unsigned i = 0; i != 3; i++) {
        start_at(starts_us[i]);
        rig_run(40000, 20000);
        const uint32_t came_us = rig.fake.now_us + 7000;
        fake_receive_rx(&rig.fake, 8000, mm_1953, 4, (fathom_rx_t){came_us, FATHOM_RX_TIMED});
        rig_run(20000, 20000);
        assert_int_equal(rig.samples, 1);
        assert_int_equal(rig.sample.time_us, came_us);
    }
}

TEST(it_is_due_when_a_gap_is_seen_and_then_when_it_turns_stale)
{
    assert_int_equal(fathom_due_us(&rig.sensor, 1), 5000);
    rig_run(5000, 5000);
    assert_int_equal(fathom_due_us(&rig.sensor, 1), 1995000);
    rig.fake.now_us += 995000;
    assert_int_equal(fathom_due_us(&rig.sensor, 1), 1000000);
    fake_receive(&rig.fake, 0, mm_1953, 4);
    rig_poll();
    assert_int_equal(rig.samples, 0);
    assert_int_equal(fathom_due_us(&rig.sensor, 1), 5000);
    rig.fake.now_us += 5000;
    assert_int_equal(fathom_due_us(&rig.sensor, 1), 0);
    rig_poll();
    assert_int_equal(rig.samples, 1);
    assert_int_equal(fathom_due_us(&rig.sensor, 1), 2000000);
    rig.fake.now_us += 2000000;
    assert_int_equal(fathom_due_us(&rig.sensor, 1), 0);
    assert_int_equal(rig_poll(), FATHOM_ERR_STALE);
}

/* line.h: "Several users of one line may each call" its poll; FF begins the next frame and so ends this one. */
TEST(a_frame_that_a_poll_of_the_line_has_brought_is_due_at_once)
{
    static const uint8_t and_more[] = {0xFF, 0x07, 0xA1, 0xA7, 0xFF};
    rig_run(20000, 500);
    fake_receive(&rig.fake, 0, and_more, 5);
    PENDS(fathom_line_poll(&rig.line));
    assert_int_equal(fathom_due_us(&rig.sensor, 1), 0);
    assert_int_equal(rig_poll(), FATHOM_OK);
    assert_true(fathom_due_us(&rig.sensor, 1) > 0);
}

TEST(without_silence_a_value_with_one_alignment_is_shown)
{
    fake_receive(&rig.fake, 0, mm_1953 + 2, 2); /* it was heard from within a frame on */
    rig_poll();
    for (unsigned i = 0; i != 10; i++) {
        fake_trickle(&rig.fake, 0, RIG_BYTE_US, mm_1953, 4);
        rig_run(4 * RIG_BYTE_US, RIG_BYTE_US / 2);
    }
    assert_int_equal(rig.samples, 8); /* all but the first and the last, which nothing vouches for */
    assert_int_equal(rig.sample.distance_mm, 1953);
    assert_int_equal(a16.base.stream.counters[FATHOM_STREAM_UNSURE], 1);
}

/* 511 mm held still can be read in two ways, with pauses of 20 ms, which 5000 us would call gaps. */
TEST(where_gap_us_is_longer_than_the_pauses_no_frame_is_shown)
{
    static const uint8_t mm_511[] = {0xFF, 0x01, 0xFF, 0xFF};
    config.gap_us = 25000;
    start();
    for (unsigned i = 0; i != 6; i++) {
        rig_run(i == 0 ? 10000 : i != 5 ? 20000 : 25500, 500);
        assert_int_equal(rig.samples, 0);
        fake_receive(&rig.fake, 0, mm_511, 4);
        rig_poll();
    }
    rig_run(24500, 500);
    assert_int_equal(rig.samples, 0);
    rig_run(500, 500);
    assert_int_equal(rig.samples, 1);
}

/* ---- which value is sent: its RX pin high or open, the processed one; low, the real-time one (A16 2(2)) ---- */

static void inits(fathom_status_t status)
{
    assert_int_equal(fathom_a16_auto_init(&a16, &rig.line, &config), status);
}

static void selects(fathom_dyp_value_t value, fathom_status_t status)
{
    assert_int_equal(fathom_a16_auto_select(&a16, value), status);
}

TEST(by_default_nothing_is_driven)
{
    rig.fake.uart.set_break = NULL;
    inits(FATHOM_OK);
    fathom_a16_auto_deinit(&a16);
    assert_int_equal(rig.fake.breaks, 0);
    assert_int_equal(pin.sets, 0);
}

TEST(a_pin_is_driven_at_init_and_when_told)
{
    config.select = fathom_output_pin(&pin.trigger);
    inits(FATHOM_OK);
    assert_true(pin.level);
    config.value = FATHOM_REAL_TIME;
    inits(FATHOM_OK);
    assert_false(pin.level);
    selects(FATHOM_PROCESSED, FATHOM_OK);
    assert_true(pin.level);
    selects(FATHOM_REAL_TIME, FATHOM_OK);
    assert_false(pin.level);
    fathom_a16_auto_deinit(&a16);
    assert_int_equal(rig.fake.breaks, 0);
    assert_null(rig.line.listener);
}

TEST(a_break_selects_until_deinit)
{
    config.select = fathom_output_line_break(&rig.line);
    config.value = FATHOM_REAL_TIME;
    inits(FATHOM_OK);
    assert_true(rig.fake.in_break);
    selects(FATHOM_PROCESSED, FATHOM_OK);
    assert_false(rig.fake.in_break);
    selects(FATHOM_REAL_TIME, FATHOM_OK);
    fathom_a16_auto_deinit(&a16);
    assert_false(rig.fake.in_break);
    assert_null(rig.line.listener);
}

TEST(frames_are_read_in_a_break)
{
    config.select = fathom_output_line_break(&rig.line);
    config.value = FATHOM_REAL_TIME;
    inits(FATHOM_OK);
    rig.sensor = fathom_a16_auto_sensor(&a16);
    rig_send(mm_1953, 4, 500);
    assert_true(rig.fake.in_break);
    assert_int_equal(rig.sample.distance_mm, 1953);
}

TEST(a_port_that_cannot_is_said_by_init_and_nothing_listens)
{
    config.select = fathom_output_line_break(&rig.line);
    config.value = FATHOM_REAL_TIME;
    fathom_a16_auto_deinit(&a16);
    rig.fake.never_sent = true;
    inits(FATHOM_ERR_BUSY);
    assert_null(rig.line.listener);
    rig.fake.uart.set_break = NULL;
    inits(FATHOM_ERR_UNSUPPORTED);
    assert_null(rig.line.listener);
    config.value = FATHOM_PROCESSED;
    inits(FATHOM_ERR_UNSUPPORTED);
    assert_null(rig.line.listener);
}

TEST(no_other_value_is_selected)
{
    config.select = fathom_output_pin(&pin.trigger);
    fathom_a16_auto_deinit(&a16);
    config.value = 2;
    inits(FATHOM_ERR_ARGUMENT);
    assert_null(rig.line.listener);
    config.value = FATHOM_REAL_TIME;
    inits(FATHOM_OK);
    const unsigned sets = pin.sets;
    selects((fathom_dyp_value_t)2, FATHOM_ERR_ARGUMENT);
    selects((fathom_dyp_value_t)256, FATHOM_ERR_ARGUMENT);
    assert_int_equal(pin.sets, sets);
}

TEST(without_anything_that_drives_rx_nothing_is_selected)
{
    inits(FATHOM_OK);
    selects(FATHOM_REAL_TIME, FATHOM_ERR_UNSUPPORTED);
    selects(FATHOM_PROCESSED, FATHOM_ERR_UNSUPPORTED);
    config.value = FATHOM_REAL_TIME;
    inits(FATHOM_ERR_UNSUPPORTED);
}

TEST(a_selection_that_failed_has_changed_nothing)
{
    config.select = fathom_output_line_break(&rig.line);
    inits(FATHOM_OK);
    rig.fake.never_sent = true;
    selects(FATHOM_REAL_TIME, FATHOM_PENDING);
    assert_int_equal(a16.value, FATHOM_PROCESSED);
    rig.fake.never_sent = false;
    selects(FATHOM_REAL_TIME, FATHOM_OK);
    assert_int_equal(a16.value, FATHOM_REAL_TIME);
}
