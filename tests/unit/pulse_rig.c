/* SPDX-License-Identifier: MIT */
#include "pulse_rig.h"

#include <string.h>

#include "suite.h"

enum { GUARD = 0xA5 };

pulse_rig_t stand;

void pulse_rig_start(uint32_t now_us)
{
    fake_init(&stand.fake);
    stand.fake.now_us = now_us;
    stand.fake.busy_until_us = now_us;
    fake_pin_init(&stand.pin, &stand.fake);
    stand.config.clock = &stand.fake.clock;
    stand.config.capture = &stand.pin.capture;
    memset(&stand.meter, 0x5A, sizeof stand.meter);
    stand.readings = 0;
    stand.no_answers = 0;
    assert_int_equal(fathom_pulse_init(&stand.meter, &stand.config), FATHOM_READY);
}

int pulse_rig_set_up(void **state)
{
    memset(&stand.config, 0, sizeof stand.config);
    stand.config.trigger = &stand.pin.trigger;
    pulse_rig_start(1000);
    return 0;
}

fathom_status_t pulse_rig_poll(void)
{
    fathom_pulse_reading_t reading;
    uint8_t untouched[sizeof reading];
    memset(&reading, GUARD, sizeof reading);
    memset(untouched, GUARD, sizeof untouched);
    const fathom_status_t status = fathom_pulse_poll(&stand.meter, &reading);
    if (status == FATHOM_READY) {
        stand.last = reading;
        stand.readings++;
    } else {
        assert_memory_equal(&reading, untouched, sizeof untouched);
    }
    stand.no_answers += status == FATHOM_ERR_NO_ANSWER;
    return status;
}

void pulse_rig_run(uint32_t for_us, uint32_t step_us)
{
    for (uint32_t passed_us = 0; passed_us < for_us; passed_us += step_us) {
        stand.fake.now_us += step_us;
        pulse_rig_poll();
    }
}

void pulse_rig_run_to_trigger(void)
{
    pulse_rig_run(2 * MS, 100);
    assert_int_equal(stand.pin.falls, 1);
    assert_int_equal(stand.pin.fall_us, stand.fake.now_us);
}
