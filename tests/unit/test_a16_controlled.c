/* SPDX-License-Identifier: MIT */
#include "auto_rig.h"

/* The trigger, and when a response is one; test_driver_contract.c has the rest. */

static const uint8_t wrong_sum[] = {0xFF, 0x07, 0xA1, 0xA6};

static const suite_t suite = {.set_up = controlled_set_up};

/* ---- the trigger ---- */

TEST(a_break_of_2_ms_triggers_every_121_ms)
{
    controlled_run_to_break(1, 100);
    assert_int_equal(rig.fake.now_us, RIG_START_US + 2 * MS);
    assert_int_equal(fathom_due_us(&rig.sensor, 1), 2 * MS);
    rig.fake.now_us += 1999;
    rig_poll();
    assert_true(rig.fake.in_break);
    rig.fake.now_us += 1;
    rig_poll();
    assert_false(rig.fake.in_break);
    for (unsigned n = 2; n <= 10; n++) {
        controlled_response(controlled_1953, 98 * MS);
        const uint32_t edge_us = rig.fake.now_us - 2 * MS;
        controlled_run_to_break(n, 100);
        assert_int_equal(rig.fake.now_us - edge_us, 121 * MS); /* "must be greater than 120ms" (A16 3(2)) */
        assert_int_equal(rig.samples, n - 1);
        rig_run(2 * MS, 100);
    }
}

TEST(a_pin_triggers_instead_of_the_break)
{
    controlled.trigger = fathom_output_pin(&controlled.pin.trigger);
    controlled_start();
    assert_true(controlled.pin.level);
    fathom_a16_controlled_deinit(&controlled.a16);
    assert_int_equal(controlled.pin.sets, 1); /* a pin that is high is not set again */
    controlled_start();
    rig_run(2 * MS, 100);
    assert_false(controlled.pin.level);
    assert_int_equal(controlled.pin.falls, 1);
    controlled_response(controlled_1953, 100 * MS);
    rig_run(110 * MS, 100);
    assert_int_equal(controlled.pin.low_us, 2 * MS);
    assert_int_equal(rig.samples, 1);
    rig_run(1000 * MS, 100);
    assert_true(controlled.pin.falls > 7);
    assert_true(controlled.pin.least_us >= 121 * MS);
    assert_int_equal(rig.fake.breaks, 0);
}

TEST(period_and_low_time_are_options_and_a_shorter_period_is_not_kept)
{
    controlled.trigger = fathom_output_pin(&controlled.pin.trigger);
    controlled.config.period_us = 300 * MS;
    controlled.model.trigger_us = 10 * MS;
    controlled_start();
    rig_run(2000 * MS, 1 * MS);
    assert_int_equal(controlled.pin.least_us, 300 * MS);
    assert_int_equal(controlled.pin.low_us, 10 * MS);
    controlled.config.period_us = 120 * MS;
    controlled.model.latest_ms = 90;
    controlled_start();
    rig_run(2000 * MS, 1 * MS);
    assert_int_equal(controlled.pin.least_us, 121 * MS);
}

TEST(a_slow_loop_leaves_the_pin_high_for_the_low_time_before_the_next_edge)
{
    controlled.trigger = fathom_output_pin(&controlled.pin.trigger);
    controlled_start();
    for (unsigned i = 0; i != 100; i++) {
        rig.fake.now_us += i % 2 != 0 ? 300 * MS : 500;
        rig_poll();
    }
    assert_true(controlled.pin.falls > 10);
    assert_in_range(controlled.pin.least_high_us, 2 * MS, 301 * MS);
}

/* ---- in time or not ---- */

/* One trigger, answered so much later; what comes of it. */
static fathom_status_t answered_after(const uint8_t frame[4], uint32_t us, uint32_t step_us)
{
    controlled_start();
    controlled_run_to_break(1, step_us);
    controlled_response(frame, us);
    return controlled_outcome(step_us);
}

static void comes(fathom_status_t status) { assert_int_equal(controlled_outcome(100), status); }

/* What begins in time and ends too late is damaged as far as it came: CHECKSUM. */
TEST(a_frame_answers_80_to_130_ms_after_the_edge_and_is_late_else)
{
    static const struct {
        uint32_t after_us;
        fathom_status_t status;
    } times[] = {{30 * MS, FATHOM_ERR_NO_RESPONSE},
                 {79900, FATHOM_ERR_NO_RESPONSE},
                 {80 * MS, FATHOM_OK},
                 {94 * MS, FATHOM_OK},
                 {114 * MS, FATHOM_OK},
                 {130 * MS, FATHOM_OK},
                 {130200, FATHOM_ERR_CHECKSUM},
                 {133 * MS, FATHOM_ERR_CHECKSUM},
                 {134 * MS, FATHOM_ERR_NO_RESPONSE}};
    for (unsigned i = 0; i != COUNT(times); i++) {
        assert_int_equal(answered_after(controlled_1953, times[i].after_us, 50), times[i].status);
        rig_run(20 * MS, 50);
        assert_int_equal(controlled.a16.late, times[i].status != FATHOM_OK);
        assert_int_equal(rig.samples, times[i].status == FATHOM_OK);
    }
}

TEST(no_response_is_said_at_130_ms_and_the_next_trigger_follows)
{
    controlled_run_to_break(1, 100);
    rig_run(129900, 100);
    assert_int_equal(rig.fake.breaks, 1);
    rig.fake.now_us += 100;
    assert_int_equal(fathom_due_us(&rig.sensor, 1), 0);
    assert_int_equal(rig_poll(), FATHOM_ERR_NO_RESPONSE);
    assert_int_equal(rig.fake.breaks, 2);
}

/* Bytes before the time of a response are none. */
TEST(a_damaged_response_is_a_wrong_checksum_and_noise_right_after_the_trigger_is_none)
{
    assert_int_equal(answered_after(wrong_sum, 100 * MS, 100), FATHOM_ERR_CHECKSUM);
    comes(FATHOM_ERR_NO_RESPONSE);
    controlled_response(wrong_sum, 20 * MS);
    comes(FATHOM_ERR_NO_RESPONSE);
    controlled_response(wrong_sum, 20 * MS);
    controlled_response(controlled_1953, 100 * MS);
    comes(FATHOM_OK);
}

TEST(a_late_response_is_not_that_of_the_next_trigger_and_the_count_stops)
{
    controlled.a16.late = UINT16_MAX - 1;
    controlled_run_to_break(1, 100);
    for (unsigned i = 0; i != 3; i++) {
        comes(FATHOM_ERR_NO_RESPONSE);
        controlled_response(controlled_511, 30 * MS); /* of the trigger before, 160 ms after it */
    }
    comes(FATHOM_ERR_NO_RESPONSE);
    assert_int_equal(rig.samples, 0);
    assert_int_equal(controlled.a16.late, UINT16_MAX);
    controlled_response(controlled_1953, 100 * MS);
    comes(FATHOM_OK);
    assert_int_equal(rig.sample.distance_mm, 1953);
}

/* With a response taken, a second one to the same trigger has no business. */
TEST(a_second_frame_to_one_trigger_is_late)
{
    controlled_run_to_break(1, 100);
    controlled_response(controlled_1953, 90 * MS);
    controlled_response(controlled_511, 105 * MS);
    comes(FATHOM_OK);
    rig_run(24 * MS, 100);
    assert_int_equal(rig.samples, 1);
    assert_int_equal(controlled.a16.late, 1);
}

/* "a response 80 to 130 ms after the edge", to the microsecond. At 131 ms it is read at 139 ms, when the poll before
 * was at 119 ms: it may have come in time but for the stamp. */
TEST(the_ports_time_stamps_decide_where_there_are_any)
{
    static const uint32_t came_us[] = {79999, 80000, 129000, 130000, 130001, 131000};
    for (unsigned i = 0; i != COUNT(came_us); i++) {
        const bool in_time = came_us[i] >= 80000 && came_us[i] <= 130000;
        controlled_start();
        controlled_run_to_break(1, 100);
        const uint32_t edge_us = rig.fake.now_us;
        rig_run(i < 2 ? 79 * MS : 119 * MS, 1 * MS);
        fake_receive_rx(&rig.fake, 20 * MS, controlled_1953, 4,
                        (fathom_rx_t){edge_us + came_us[i], FATHOM_RX_TIMED});
        assert_int_equal(controlled_outcome(20 * MS), in_time ? FATHOM_OK : FATHOM_ERR_NO_RESPONSE);
        if (in_time) assert_int_equal(rig.sample.time_us, edge_us + came_us[i]);
        assert_int_equal(controlled.a16.late, !in_time);
    }
}

TEST(earliest_and_latest_may_be_the_same)
{
    controlled.model.earliest_ms = controlled.model.latest_ms = 100;
    assert_int_equal(controlled_init(), FATHOM_OK);
    controlled.model.latest_ms = 99;
    assert_int_equal(controlled_init(), FATHOM_ERR_ARGUMENT);
    controlled.model.earliest_ms = controlled.model.latest_ms = 0;
    assert_int_equal(controlled_init(), FATHOM_ERR_ARGUMENT);
}

/* ---- when it is due ---- */

static fathom_status_t poll_after(uint32_t us)
{
    rig.fake.now_us += us;
    return rig_poll();
}

static void expect_due(uint32_t us) { assert_int_equal(fathom_due_us(&rig.sensor, 1), us); }

/* After the response the next trigger is due, however long the period is: the stream's own deadline means nothing. */
TEST(between_two_triggers_it_is_due_at_the_next_one)
{
    static const uint8_t fills[] = {0x00, 0xFF};
    controlled.config.period_us = 20000 * MS;
    for (unsigned i = 0; i != sizeof fills; i++) {
        rig_start(RIG_START_US);
        memset(&controlled.a16, fills[i], sizeof controlled.a16);
        assert_int_equal(controlled_init(), FATHOM_OK);
        rig.sensor = fathom_a16_controlled_sensor(&controlled.a16);
        controlled_run_to_break(1, 2 * MS);
        PENDS(poll_after(2 * MS));
        assert_int_equal(poll_after(128 * MS), FATHOM_ERR_NO_RESPONSE);
        expect_due(19870 * MS);
        rig.fake.now_us += 70 * MS;
        expect_due(19800 * MS);
        rig.fake.now_us += 19801 * MS;
        expect_due(0);
    }
}

/* line.h: "Several users of one line may each call" its poll; FF begins another frame and so ends this one. */
TEST(a_frame_that_a_poll_of_the_line_has_brought_is_due_at_once)
{
    static const uint8_t and_more[] = {0xFF, 0x07, 0xA1, 0xA7, 0xFF};
    controlled_run_to_break(1, 2 * MS);
    PENDS(poll_after(2 * MS));
    PENDS(poll_after(8 * MS));
    fake_receive(&rig.fake, 90 * MS, and_more, 5);
    rig.fake.now_us += 90 * MS;
    PENDS(fathom_line_poll(&rig.line));
    expect_due(0);
    assert_int_equal(rig_poll(), FATHOM_OK);
}

/* ---- loops and the clock ---- */

TEST(every_trigger_is_one_sample_in_loops_from_100_us_to_300_ms_and_across_the_wrap)
{
    static const uint32_t steps_us[] = {100, 1000, 3333, 20000, 33000, 300000};
    static const uint32_t starts_us[] = {0,
                                         UINT32_MAX - 1000,
                                         UINT32_MAX - 60000,
                                         UINT32_MAX - 100000,
                                         UINT32_MAX - 250000,
                                         UINT32_C(0x7FFFF000)};
    for (unsigned s = 0; s != COUNT(steps_us); s++) {
        for (unsigned n = 0; n != COUNT(starts_us); n++) {
            unsigned triggers = 0;
            controlled_start_at(starts_us[n]);
            rig.fake.step_us = n % 2 * 7; /* a clock that goes on within a poll */
            while (rig.samples != 6) {
                rig.fake.now_us += steps_us[s];
                const fathom_status_t status = rig_poll();
                assert_true(status == FATHOM_PENDING || status == FATHOM_OK);
                if (status == FATHOM_OK)
                    assert_int_equal(rig.sample.distance_mm, rig.samples % 2 != 0 ? 1953 : 511);
                assert_in_range(rig.fake.breaks, rig.samples, rig.samples + 1);
                if (rig.fake.breaks == triggers) continue;
                triggers++;
                controlled_response(triggers % 2 != 0 ? controlled_1953 : controlled_511,
                                    90 * MS + triggers % 6 * 4 * MS + FRAME_US);
            }
            assert_int_equal(controlled.a16.late, 0);
        }
    }
}

/* ---- the port ---- */

TEST(a_busy_port_delays_the_edges_and_costs_no_response)
{
    rig.fake.never_sent = true;
    rig_run(50 * MS, 100);
    assert_int_equal(rig.fake.breaks, 0);
    assert_in_range(fathom_due_us(&rig.sensor, 1), 0, 1 * MS);
    rig.fake.never_sent = false;
    rig_run(100, 100);
    assert_int_equal(rig.fake.breaks, 1);
    controlled_response(controlled_1953, 100 * MS);
    rig.fake.never_sent = true;
    rig_run(50 * MS, 100);
    assert_true(rig.fake.in_break);
    rig.fake.never_sent = false;
    rig_run(100, 100);
    assert_false(rig.fake.in_break);
    rig_run(60 * MS, 100);
    assert_int_equal(rig.samples, 1);
}

TEST(a_port_that_breaks_in_the_break_is_said_and_then_the_trigger_had_no_response)
{
    controlled_run_to_break(1, 100);
    rig.fake.read_fails = true;
    for (unsigned i = 0; i != 5; i++) {
        rig.fake.now_us += 100 * MS;
        assert_int_equal(rig_poll(), FATHOM_ERR_PORT);
    }
    rig.fake.read_fails = false;
    assert_int_equal(rig_poll(), FATHOM_ERR_NO_RESPONSE);
    assert_false(rig.fake.in_break);
}

static int broken(void *ctx, bool on) { return -1; }

TEST(a_break_that_fails_is_said_by_every_poll_until_it_works_again)
{
    int (*const works)(void *ctx, bool on) = rig.fake.uart.set_break;
    rig.fake.uart.set_break = broken;
    rig.fake.now_us += 2 * MS;
    for (unsigned i = 0; i != 3; i++) assert_int_equal(rig_poll(), FATHOM_ERR_PORT);
    rig.fake.uart.set_break = works;
    assert_int_equal(rig_poll(), FATHOM_PENDING);
    assert_int_equal(rig.fake.breaks, 1);
}

TEST(without_a_pin_or_a_break_nothing_listens_and_deinit_ends_a_break)
{
    fathom_a16_controlled_t other;
    controlled_run_to_break(1, 100);
    fathom_a16_controlled_deinit(&controlled.a16);
    assert_false(rig.fake.in_break);
    rig.fake.uart.set_break = NULL;
    assert_int_equal(fathom_a16_controlled_init(&other, &rig.line, &controlled.trigger, &controlled.config),
                     FATHOM_ERR_UNSUPPORTED);
    assert_null(rig.line.listener);
    controlled.trigger.set = NULL;
    assert_int_equal(fathom_a16_controlled_init(&other, &rig.line, &controlled.trigger, &controlled.config),
                     FATHOM_ERR_ARGUMENT);
    controlled.trigger = fathom_output_pin(&controlled.pin.trigger);
    assert_int_equal(fathom_a16_controlled_init(&other, &rig.line, &controlled.trigger, &controlled.config),
                     FATHOM_OK);
    assert_ptr_equal(rig.line.listener, &other.stream.listener);
}

/* ---- what was in the port before the trigger ---- */

/* A trigger and its response, and then 5 ms until the next trigger is due; the line has seen a silence. */
static void run_to_second_trigger(void)
{
    controlled_start();
    controlled_run_to_break(1, 100);
    controlled_response(controlled_511, 100 * MS);
    assert_int_equal(controlled_outcome(100), FATHOM_OK);
    rig_run(12 * MS, 100);
    assert_int_equal(rig.samples, 1);
}

/* A frame that is read by the poll that triggers, in loops so slow that no silence is seen behind it. The clock goes on
 * within a poll, so the frame is some microseconds older than the edge. */
TEST(a_frame_of_before_the_trigger_is_not_the_response)
{
    for (uint32_t step_us = 0; step_us != 20; step_us++) {
        run_to_second_trigger();
        rig.fake.step_us = step_us;
        fake_receive(&rig.fake, 0, controlled_1953, 4);
        rig.fake.now_us += 5 * MS;
        PENDS(rig_poll());
        assert_int_equal(rig.fake.breaks, 2);
        controlled_response(controlled_511, 100 * MS);
        rig.fake.now_us += 102 * MS;
        PENDS(rig_poll());
        rig.fake.now_us += 5 * MS;
        assert_int_equal(rig_poll(), FATHOM_OK);
        assert_int_equal(rig.sample.distance_mm, 511);
        assert_int_equal(controlled.a16.late, 1);
    }
}

/* A frame that arrives between the read and the edge of one poll, as on a machine that does something else there. */
TEST(a_frame_that_arrives_while_the_poll_triggers_is_not_the_response)
{
    unsigned tried = 0;
    for (uint32_t after_us = 0; after_us <= 20 * MS; after_us += 500) {
        run_to_second_trigger();
        rig.fake.now_us += 5 * MS;
        const uint32_t arrives_us = rig.fake.now_us + after_us;
        fake_receive(&rig.fake, after_us, controlled_1953, 4);
        rig.fake.step_us = 2 * MS; /* each look at the clock */
        PENDS(rig_poll());
        rig.fake.step_us = 0;
        assert_int_equal(rig.fake.breaks, 2);
        if (arrives_us > controlled.a16.edge_us) break;
        tried++;
        rig_run(100 * MS, 100 * MS);
        rig_run(10 * MS, 10 * MS);
        assert_int_equal(rig.samples, 1);
    }
    assert_in_range(tried, 5, 40);
}

/* test_a16_auto.c shows what it is good for. */
TEST(the_gap_is_that_of_the_line_if_it_is_longer)
{
    rig.line_parts.gap_us = 25000;
    assert_int_equal(fathom_line_init(&rig.line, &rig.line_parts), FATHOM_OK);
    assert_int_equal(fathom_a16_controlled_init(&controlled.a16, &rig.line, &controlled.trigger, NULL),
                     FATHOM_OK);
    assert_int_equal(controlled.a16.stream.listener.gap_us, 25000);
}
