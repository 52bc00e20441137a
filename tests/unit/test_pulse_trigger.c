/* SPDX-License-Identifier: MIT */
#include "pulse_rig.h"

static const suite_t suite = {.set_up = set_up_meter};

static void poll_after(uint32_t us)
{
    stand.fake.now_us += us;
    poll_meter();
}

/* ---- loops and the clock ---- */

TEST(every_cycle_is_one_reading_in_loops_from_50_us_to_200_ms_and_across_the_wrap)
{
    static const uint32_t steps_us[] = {50, 333, 1000, 20000, 33333, 200000};
    static const uint32_t starts_us[] = {0,
                                         UINT32_MAX - 1000,
                                         UINT32_MAX - 100000,
                                         UINT32_MAX - 130000,
                                         UINT32_MAX - 300000,
                                         UINT32_C(0x7FFFF000)};
    for (unsigned s = 0; s != COUNT_OF(steps_us); s++) {
        for (unsigned n = 0; n != COUNT_OF(starts_us); n++) {
            start_meter_at(starts_us[n]);
            stand.pin.response_after_us = 110 * MS;
            for (uint32_t cycle = 1; cycle <= 5; cycle++) {
                stand.pin.response_width_us = 3000 + cycle * 1000;
                while (stand.readings != cycle) {
                    assert_true(stand.fake.now_us - starts_us[n] < cycle * 900 * MS);
                    run_meter_in_steps(steps_us[s], steps_us[s]);
                }
                assert_int_equal(stand.last.width_us, 3000 + cycle * 1000);
                assert_int_equal(stand.last.time_us,
                                 stand.pin.pulses[cycle - 1].rise_us + stand.last.width_us);
            }
            expect_no_responses(0);
            assert_true(stand.pin.least_us >= 221 * MS);
        }
    }
}

TEST(who_sleeps_as_long_as_it_is_due_gets_a_reading_a_cycle)
{
    response_with(110 * MS, 10 * MS);
    for (unsigned polls = 0; polls != 31; polls++) { /* trigger, release and end of ten cycles */
        poll_after(fathom_pulse_due_us(&stand.meter));
    }
    assert_int_equal(stand.readings + stand.no_responses, 15);
    expect_no_responses(0);
}

/* trigger.h: "period_us: low_us + 1..FATHOM_MAX_DURATION_US". */
TEST(the_period_of_a_trigger_is_longer_than_its_low_time)
{
    static const struct {
        uint32_t period_us;
        fathom_status_t status;
    } rows[] = {{0, FATHOM_ERR_ARGUMENT},
                {30000, FATHOM_ERR_ARGUMENT},
                {30001, FATHOM_OK},
                {FATHOM_MAX_DURATION_US, FATHOM_OK},
                {FATHOM_MAX_DURATION_US + 1, FATHOM_ERR_ARGUMENT}};
    for (unsigned i = 0; i != COUNT_OF(rows); i++) {
        fathom_trigger_t trigger = {.output = fathom_output_pin(&stand.pin.trigger),
                                    .clock = &stand.fake.clock,
                                    .period_us = rows[i].period_us,
                                    .low_us = 30000};
        assert_int_equal(fathom_trigger_init(&trigger), rows[i].status);
    }
}

/* ---- a port that fails ---- */

TEST(a_capture_that_fails_is_said_by_every_poll_until_it_works_again)
{
    run_to_trigger();
    pulse_in(110 * MS, 10 * MS);
    run_meter(100 * MS);
    stand.pin.take_fails = true;
    for (unsigned i = 0; i != 3; i++) {
        stand.fake.now_us += 100 * MS;
        expect_poll(FATHOM_ERR_PORT);
    }
    stand.pin.take_fails = false;
    expect_poll(FATHOM_OK);
    expect_last(FATHOM_TARGET, 10 * MS);
}

/* ---- setting up ---- */

static void expect_init(fathom_status_t status) { assert_int_equal(init_meter(), status); }

TEST(a_config_without_what_it_needs_is_refused)
{
    const pulse_rig_t good = stand;
    fathom_uart_t uart = stand.fake.uart;
    stand.clock = NULL;
    expect_init(FATHOM_ERR_ARGUMENT);
    stand.clock = good.clock;
    stand.capture = NULL;
    expect_init(FATHOM_ERR_ARGUMENT);
    stand.capture = good.capture;
    stand.trigger.set = NULL;
    expect_init(FATHOM_ERR_ARGUMENT);
    stand.trigger = fathom_output_break(&uart);
    expect_init(FATHOM_OK);
    uart.set_break = NULL;
    expect_init(FATHOM_ERR_UNSUPPORTED);
    stand.trigger = good.trigger;
    stand.config.noise_us = 50000;
    stand.config.no_target_us = 50000;
    expect_init(FATHOM_ERR_ARGUMENT);
    stand.config.noise_us = 49999;
    expect_init(FATHOM_OK);
    stand.config.stuck_us = 49999;
    expect_init(FATHOM_ERR_ARGUMENT);
    stand.config.stuck_us = 50000;
    expect_init(FATHOM_OK);
}

TEST(deinit_lets_the_trigger_go_high)
{
    run_to_trigger();
    assert_false(stand.pin.level);
    fathom_pulse_deinit(&stand.meter);
    assert_true(stand.pin.level);
    const unsigned sets = stand.pin.sets;
    fathom_pulse_deinit(&stand.meter);
    assert_int_equal(stand.pin.sets, sets);
}
