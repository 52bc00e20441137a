/* SPDX-License-Identifier: MIT */
#include "pulse_rig.h"

pulse_rig_t stand;

fathom_status_t init_meter(void)
{
    stand.meter.capture = stand.capture;
    stand.meter.trigger.clock = stand.clock;
    stand.meter.trigger.output = stand.trigger;
    stand.meter.trigger.period_us = stand.config.cycle_us;
    stand.meter.trigger.low_us = stand.config.low_us;
    stand.meter.no_target_us = stand.config.no_target_us;
    stand.meter.stuck_us = stand.config.stuck_us;
    stand.meter.noise_us = stand.config.noise_us;
    return fathom_pulse_init(&stand.meter);
}

void start_meter_at(uint32_t now_us)
{
    fake_init(&stand.fake);
    stand.fake.now_us = now_us;
    stand.fake.busy_until_us = now_us;
    fake_pin_init(&stand.pin, &stand.fake);
    stand.clock = &stand.fake.clock;
    stand.capture = &stand.pin.capture;
    memset(&stand.meter, 0x5A, sizeof stand.meter);
    stand.readings = 0;
    stand.no_responses = stand.port_errors = 0;
    assert_int_equal(init_meter(), FATHOM_OK);
}

void start_meter(void) { start_meter_at(1000); }

void response_with(uint32_t after_us, uint32_t width_us)
{
    stand.pin.response_after_us = after_us;
    stand.pin.response_width_us = width_us;
}

int set_up_meter(void **state)
{
    /* A16 1(2), 1(3): a period over 220 ms, a fixed pulse of about 94 ms, pulses from 3 ms on */
    stand.config = (pulse_times_t){
        .cycle_us = 221000, .no_target_us = 92000, .stuck_us = 105000, .low_us = 2000, .noise_us = 2700};
    stand.trigger = fathom_output_pin(&stand.pin.trigger);
    start_meter();
    return 0;
}

fathom_status_t poll_meter(void)
{
    fathom_pulse_reading_t reading;
    memset(&reading, GUARD, sizeof reading);
    const fathom_status_t status = fathom_pulse_poll(&stand.meter, &reading);
    if (status == FATHOM_OK) {
        stand.last = reading;
        stand.readings++;
    } else {
        assert_guard(&reading, sizeof reading);
    }
    stand.no_responses += status == FATHOM_ERR_NO_RESPONSE;
    stand.port_errors += status == FATHOM_ERR_PORT;
    return status;
}

void run_meter_in_steps(uint32_t for_us, uint32_t step_us)
{
    for (uint32_t passed_us = 0; passed_us < for_us; passed_us += step_us) {
        stand.fake.now_us += step_us;
        poll_meter();
    }
}

void run_meter(uint32_t for_us) { run_meter_in_steps(for_us, 100); }

void run_to_trigger(void)
{
    run_meter(2 * MS);
    expect_falls(1);
    assert_int_equal(stand.pin.fall_us, stand.fake.now_us);
}

void pulse_in(uint32_t in_us, uint32_t width_us) { fake_pulse(&stand.pin, in_us, width_us); }

void measure(uint32_t after_us, uint32_t width_us)
{
    start_meter();
    run_to_trigger();
    pulse_in(after_us, width_us);
    run_meter(222 * MS);
}

void expect_last(uint8_t kind, uint32_t width_us)
{
    assert_int_equal(stand.last.kind, kind);
    assert_int_equal(stand.last.width_us, width_us);
}
