/* SPDX-License-Identifier: MIT */
#include "auto_rig.h"
#include "fathom/sensor/a16_auto.h"

/* What test_driver_contract.c does not ask of every listener. */

static fathom_a16_auto_config_t config;
static fathom_a16_auto_t a16;
static fake_pin_t pin;
static fathom_uart_t uart; /* of the line; it counts what is done to its TX */
static unsigned set_breaks;
static uint8_t memory; /* of the driver, before init */

static int counted_set_break(void *ctx, bool on)
{
    set_breaks++;
    return rig.fake.uart.set_break(ctx, on);
}

/* A16 2(4): 1953 mm. */
static const uint8_t mm_1953[] = {0xFF, 0x07, 0xA1, 0xA7};

static void start_at(uint32_t now_us)
{
    rig_start(now_us);
    fake_pin_init(&pin, &rig.fake);
    uart = rig.fake.uart;
    uart.set_break = counted_set_break;
    rig.line_parts.uart = &uart;
    set_breaks = 0;
    memset(&a16, memory, sizeof a16);
    assert_int_equal(fathom_a16_auto_init(&a16, &rig.line, &config), FATHOM_OK);
    rig.sensor = fathom_a16_auto_sensor(&a16);
}

static void start(void) { start_at(RIG_START_US); }

static int set_up(void **state)
{
    memset(&config, 0, sizeof config);
    memory = 0x5A;
    start();
    return 0;
}

static const suite_t suite = {.set_up = set_up};

/* ---- readings ---- */

/* a16_auto.h: the gap of the line if that is longer than 5 ms. A USB adapter holds bytes back for up to 16 ms. */
TEST(a_frame_in_two_parts_is_read_if_the_gap_of_the_line_is_longer)
{
    rig.line_parts.gap_us = 25000;
    assert_int_equal(fathom_a16_auto_init(&a16, &rig.line, &config), FATHOM_OK);
    rig_run(30000, 5000);
    fake_receive(&rig.fake, 0, mm_1953, 2);
    rig_run(16000, 4000);
    fake_receive(&rig.fake, 0, mm_1953 + 2, 2);
    rig_run(30000, 5000);
    rig_expect(1, FATHOM_TARGET);
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
    uart.set_break = NULL;
    inits(FATHOM_OK);
    fathom_a16_auto_deinit(&a16);
    assert_int_equal(pin.sets, 0);
}

/* deinit "ends a break that selected": whatever the memory held, there was none. */
TEST(without_a_selection_tx_is_left_alone)
{
    static const uint8_t fills[] = {0x00, 0x5A, 0xFF};
    config.select = fathom_output_line_break(&rig.line);
    for (unsigned i = 0; i != sizeof fills; i++) {
        memory = fills[i];
        start();
        fathom_a16_auto_deinit(&a16);
        assert_int_equal(set_breaks, 0);
    }
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
    set_breaks = 0;
    fathom_a16_auto_deinit(&a16);
    assert_false(rig.fake.in_break);
    assert_int_equal(set_breaks, 1); /* it is ended once */
    assert_null(rig.line.listener);
}

/* A pin stays as it is: the module goes on with the value that was selected. */
TEST(a_pin_that_selected_is_left_as_it_is)
{
    config.select = fathom_output_pin(&pin.trigger);
    for (unsigned value = FATHOM_PROCESSED; value != 2; value++) {
        start();
        selects((fathom_dyp_value_t)value, FATHOM_OK);
        const unsigned sets = pin.sets;
        fathom_a16_auto_deinit(&a16);
        assert_int_equal(pin.sets, sets);
        assert_int_equal(pin.level, value == FATHOM_PROCESSED);
        assert_int_equal(set_breaks, 0);
    }
}

TEST(a_port_that_cannot_is_said_by_init_and_nothing_listens)
{
    config.select = fathom_output_line_break(&rig.line);
    config.value = FATHOM_REAL_TIME;
    fathom_a16_auto_deinit(&a16);
    rig.fake.never_sent = true;
    inits(FATHOM_ERR_BUSY);
    assert_null(rig.line.listener);
    uart.set_break = NULL;
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
