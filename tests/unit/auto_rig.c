/* SPDX-License-Identifier: MIT */
#include "auto_rig.h"

#include <string.h>

#include "suite.h"

enum { GUARD = 0xA5, T3_5_US = 3646, GAP_US = 5000 };

rig_t rig;

void rig_start(uint32_t now_us)
{
    memset(&rig, 0, sizeof rig);
    fake_init(&rig.fake);
    rig.fake.now_us = now_us;
    rig.fake.busy_until_us = now_us;
    rig.line_config = (fathom_line_config_t){
        &rig.fake.uart, &rig.fake.clock, rig.frame, sizeof rig.frame, FATHOM_LINE_ECHO_AUTO, T3_5_US, GAP_US};
    assert_int_equal(fathom_line_init(&rig.line, &rig.line_config), FATHOM_READY);
}

fathom_status_t rig_poll(void)
{
    fathom_sample_t sample;
    uint8_t untouched[sizeof sample];
    memset(&sample, GUARD, sizeof sample);
    memset(untouched, GUARD, sizeof untouched);
    const fathom_status_t status = fathom_poll(&rig.sensor, &sample);
    if (status == FATHOM_READY) {
        assert_in_range(sample.probe, 1, 4);
        rig.sample = sample;
        rig.last[sample.probe - 1] = sample;
        rig.samples++;
    } else {
        assert_memory_equal(&sample, untouched, sizeof untouched);
    }
    rig.stales += status == FATHOM_ERR_STALE;
    rig.malformed += status == FATHOM_ERR_MALFORMED;
    rig.ports += status == FATHOM_ERR_PORT;
    return status;
}

void rig_run(uint32_t for_us, uint32_t step_us)
{
    for (uint32_t passed_us = 0; passed_us < for_us; passed_us += step_us) {
        rig.fake.now_us += step_us;
        while (rig_poll() == FATHOM_READY) {
        }
    }
}

void rig_send(const uint8_t *frame, size_t length, uint32_t step_us)
{
    const uint32_t period_us = RIG_PERIOD_US - rig.silent_us;
    fake_trickle(&rig.fake, period_us - (uint32_t)length * RIG_BYTE_US, RIG_BYTE_US, frame, length);
    rig.silent_us = RIG_GAP_US;
    rig_run(period_us + RIG_GAP_US, step_us);
}
