/* SPDX-License-Identifier: MIT */
#include "controlled_rig.h"

controlled_t controlled;

const uint8_t controlled_1953[4] = {0xFF, 0x07, 0xA1, 0xA7};
const uint8_t controlled_511[4] = {0xFF, 0x01, 0xFF, 0xFF};

fathom_status_t controlled_init(void)
{
    return fathom_a16_controlled_init(&controlled.a16, &rig.line, &controlled.trigger, &controlled.config);
}

void controlled_start_at(uint32_t now_us)
{
    rig_start(now_us);
    fake_pin_init(&controlled.pin, &rig.fake);
    memset(&controlled.a16, 0x5A, sizeof controlled.a16);
    assert_int_equal(controlled_init(), FATHOM_OK);
    rig.sensor = fathom_a16_controlled_sensor(&controlled.a16);
}

void controlled_start(void) { controlled_start_at(RIG_START_US); }

int controlled_set_up(void **state)
{
    memset(&controlled.config, 0, sizeof controlled.config);
    controlled.trigger = fathom_output_line_break(&rig.line);
    controlled_start();
    return 0;
}

void controlled_run_to_break(unsigned breaks, uint32_t step_us)
{
    for (unsigned polls = 0; rig.fake.breaks != breaks; polls++) {
        assert_true(polls < 20000);
        rig.fake.now_us += step_us;
        rig_poll();
    }
}

void controlled_response(const uint8_t frame[4], uint32_t after_us)
{
    fake_trickle(&rig.fake, after_us - FRAME_US, RIG_BYTE_US, frame, 4);
}

fathom_status_t controlled_outcome(uint32_t step_us)
{
    const unsigned breaks = rig.fake.breaks;
    for (unsigned polls = 0; polls < 20000; polls++) {
        rig.fake.now_us += step_us;
        const fathom_status_t status = rig_poll();
        if (status != FATHOM_PENDING) return status;
        assert_int_equal(rig.fake.breaks, breaks);
    }
    fail_msg("nothing came of the trigger");
    return FATHOM_PENDING;
}
