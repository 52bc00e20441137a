/* SPDX-License-Identifier: MIT */
#include "contact_rig.h"

enum { GUARD = 0xA5 };

pins_t pins;

static bool get(void *ctx)
{
    pins_t *const r = ctx;
    while (r->edge != r->edges && (int32_t)(r->fake.now_us - r->edges_us[r->edge]) >= 0) {
        r->level = !r->level;
        r->edge++;
    }
    return r->level;
}

void pins_start(uint32_t now_us)
{
    memset(&pins, 0, sizeof pins);
    fake_init(&pins.fake);
    pins.fake.now_us = now_us;
    pins.fake.busy_until_us = now_us;
    pins.pin = (fathom_pin_t){NULL, get, &pins};
}

void pins_turn(uint32_t in_us)
{
    assert_true(pins.edges < CONTACT_EDGES);
    pins.edges_us[pins.edges++] = pins.fake.now_us + in_us;
}

fathom_status_t pins_poll(void)
{
    fathom_sample_t sample;
    uint8_t untouched[sizeof sample];
    memset(&sample, GUARD, sizeof sample);
    memset(untouched, GUARD, sizeof untouched);
    const fathom_status_t status = fathom_poll(&pins.sensor, &sample);
    if (status == FATHOM_OK) {
        pins.sample = sample;
        pins.samples++;
        assert_int_equal(sample.sequence, (uint16_t)pins.samples);
    } else {
        assert_memory_equal(&sample, untouched, sizeof untouched);
    }
    pins.stales += status == FATHOM_ERR_STALE;
    pins.ports += status == FATHOM_ERR_PORT;
    return status;
}

void pins_run(uint32_t for_us, uint32_t step_us)
{
    for (uint32_t passed_us = 0; passed_us < for_us; passed_us += step_us) {
        pins.fake.now_us += step_us;
        pins_poll();
    }
}

void pins_expect(unsigned samples, uint8_t kind)
{
    assert_int_equal(pins.samples, samples);
    assert_int_equal(pins.sample.kind, kind);
}
