/* SPDX-License-Identifier: MIT */
#include "controlled_rig.h"

#include <string.h>

#include "suite.h"

/* a16_controlled.h: its defaults to the microsecond and to the millimetre, when it is due, and whose hands it keeps
 * off. */

static const suite_t suite = {.set_up = controlled_set_up};

static fathom_status_t poll_after(uint32_t us)
{
    rig.fake.now_us += us;
    return rig_poll();
}

static uint32_t due_us(void) { return rig.sensor.due_us(rig.sensor.ctx); }

/* The rising edge, and then a silence. */
static void release(void)
{
    assert_int_equal(poll_after(2 * MS), FATHOM_PENDING);
    assert_int_equal(poll_after(8 * MS), FATHOM_PENDING);
}

/* The edge, 2 ms after the start. */
static void trigger(void)
{
    poll_after(2 * MS);
    assert_int_equal(rig.fake.breaks, 1);
}

/* A frame whose last byte came so long after the edge, as the port knows; then the silence that ends it. */
static fathom_status_t answered_after(uint32_t us, const uint8_t frame[4])
{
    fake_receive_rx(&rig.fake, us, frame, 4, (fathom_rx_t){rig.fake.now_us + us, FATHOM_RX_TIMED});
    release();
    assert_int_equal(poll_after(us - 10000u + 100u), FATHOM_PENDING);
    return poll_after(RIG_GAP_US - 100);
}

/* ---- the defaults ---- */

/* "earliest_us; 0: 80 ms", "latest_us; 0: 130 ms". */
TEST(a_frame_answers_from_80_to_130_ms_after_the_edge)
{
    static const struct {
        uint32_t after_us;
        bool responses;
    } rows[] = {{79999, false}, {80000, true}, {130000, true}, {130001, false}};
    for (unsigned i = 0; i != 4; i++) {
        controlled_set_up(state);
        trigger();
        const fathom_status_t status = answered_after(rows[i].after_us, controlled_1953);
        assert_int_equal(status == FATHOM_OK, rows[i].responses);
        assert_int_equal(controlled.a16.late, !rows[i].responses);
    }
}

/* FATHOM_ERR_ARGUMENT: "earliest_us over latest_us". */
TEST(earliest_and_latest_may_be_the_same)
{
    controlled.config.earliest_us = 100000;
    controlled.config.latest_us = 100000;
    assert_int_equal(controlled_init(), FATHOM_OK);
    controlled.config.latest_us = 99999;
    assert_int_equal(controlled_init(), FATHOM_ERR_ARGUMENT);
}

/* ---- when it is due ---- */

/* After the response the next trigger is due, however long the period is: the stream's own deadline means nothing. */
TEST(between_two_triggers_it_is_due_at_the_next_one)
{
    controlled.config.period_us = 20000 * MS;
    for (unsigned fill = 0; fill != 2; fill++) {
        rig_start(RIG_START_US);
        memset(&controlled.a16, fill != 0 ? 0xFF : 0, sizeof controlled.a16);
        assert_int_equal(controlled_init(), FATHOM_OK);
        rig.sensor = fathom_a16_controlled_sensor(&controlled.a16);
        trigger();
        poll_after(2 * MS);
        assert_int_equal(poll_after(128 * MS), FATHOM_ERR_NO_RESPONSE);
        assert_int_equal(due_us(), 19870 * MS);
        rig.fake.now_us += 70 * MS;
        assert_int_equal(due_us(), 19800 * MS);
        rig.fake.now_us += 19801 * MS;
        assert_int_equal(due_us(), 0);
    }
}

/* line.h: "Several users of one line may each call" its poll; FF begins another frame and so ends this one. */
TEST(a_frame_that_a_poll_of_the_line_has_brought_is_due_at_once)
{
    static const uint8_t and_more[] = {0xFF, 0x07, 0xA1, 0xA7, 0xFF};
    trigger();
    release();
    fake_receive(&rig.fake, 90 * MS, and_more, 5);
    rig.fake.now_us += 90 * MS;
    assert_int_equal(fathom_line_poll(&rig.line), FATHOM_PENDING);
    assert_int_equal(due_us(), 0);
    assert_int_equal(poll_after(0), FATHOM_OK);
}

/* ---- what it leaves alone ---- */

TEST(a_pin_that_is_high_is_not_set_when_the_sensor_is_given_up)
{
    controlled.trigger = fathom_output_pin(&controlled.pin.trigger);
    controlled_start();
    assert_int_equal(controlled.pin.sets, 1); /* high */
    fathom_a16_controlled_deinit(&controlled.a16);
    assert_int_equal(controlled.pin.sets, 1);
}
