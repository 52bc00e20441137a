/* SPDX-License-Identifier: MIT */
#include "fake_pin.h"

#include <assert.h>
#include <string.h>

static bool is_past(const fake_pin_t *pin, uint32_t at_us)
{
    return (int32_t)(pin->fake->now_us - at_us) >= 0;
}

static void set(void *ctx, bool high)
{
    fake_pin_t *const pin = ctx;
    if (!high) pin->fake->now_us += pin->delay_us;
    if (!high) pin->delay_us = 0;
    const uint32_t now_us = pin->fake->now_us;
    pin->sets++;
    if (high == pin->level) return;
    pin->level = high;
    if (high) {
        pin->low_us = now_us - pin->fall_us;
        pin->rise_us = now_us;
        return;
    }
    if (pin->has_fallen && now_us - pin->fall_us < pin->least_us) pin->least_us = now_us - pin->fall_us;
    if (pin->has_fallen && now_us - pin->rise_us < pin->least_high_us)
        pin->least_high_us = now_us - pin->rise_us;
    pin->has_fallen = true;
    pin->falls++;
    pin->fall_us = now_us;
    if (pin->response_width_us != 0) fake_pulse(pin, pin->response_after_us, pin->response_width_us);
}

static void arm(void *ctx)
{
    fake_pin_t *const pin = ctx;
    pin->arms++;
    pin->armed_us = pin->fake->now_us;
    while (pin->first != pin->last && is_past(pin, pin->pulses[pin->first % FAKE_PULSES].rise_us))
        pin->first++;
}

static int take(void *ctx, fathom_pulse_t *pulse)
{
    fake_pin_t *const pin = ctx;
    const fake_pulse_t *const next = &pin->pulses[pin->first % FAKE_PULSES];
    const bool any = pin->first != pin->last;
    const bool begun = any && is_past(pin, next->rise_us);
    const bool ended = any && is_past(pin, next->rise_us + next->width_us);
    if (pin->take_fails) return -1;
    pulse->is_high = pin->stuck_high || (begun && !ended);
    if (!ended) return 0;
    pulse->width_us = next->width_us;
    pulse->end_us = next->rise_us + next->width_us;
    pin->first++;
    return 1;
}

void fake_pin_init(fake_pin_t *pin, fake_t *fake)
{
    memset(pin, 0, sizeof *pin);
    pin->fake = fake;
    pin->least_us = pin->least_high_us = UINT32_MAX;
    pin->trigger = (fathom_pin_t){set, NULL, pin};
    pin->capture = (fathom_capture_t){arm, take, pin};
}

void fake_pulse(fake_pin_t *pin, uint32_t in_us, uint32_t width_us)
{
    assert(pin->last - pin->first < FAKE_PULSES);
    pin->pulses[pin->last++ % FAKE_PULSES] = (fake_pulse_t){pin->fake->now_us + in_us, width_us};
}
