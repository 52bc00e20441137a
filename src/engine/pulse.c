/* SPDX-License-Identifier: MIT */
#include "fathom/engine/pulse.h"

#include "../common.h"

/* A poll takes no more pulses than this: noise may come faster than it is read. */
enum { MAX_TAKES = 8 };

static uint8_t kind_of(const fathom_pulse_meter_t *meter, uint32_t width_us)
{
    if (width_us > meter->stuck_us) return FATHOM_FAULT;
    return (width_us < meter->no_target_us) ? FATHOM_TARGET : FATHOM_NO_TARGET;
}

static fathom_status_t take(fathom_pulse_meter_t *meter, fathom_pulse_reading_t *reading)
{
    const fathom_capture_t *const capture = meter->capture;
    fathom_pulse_t pulse;
    for (uint8_t left = MAX_TAKES; left != 0u; left--) {
        const int has = capture->take(capture->ctx, &pulse);
        if (has < 0) return FATHOM_ERR_PORT;
        if (has == 0) {
            if (meter->trigger.left_us != 0u) return FATHOM_PENDING;
            meter->waiting = false;
            if (!pulse.is_high) return FATHOM_ERR_NO_RESPONSE;
            reading->width_us = 0;
            reading->time_us = meter->trigger.polled_us;
            reading->kind = FATHOM_FAULT;
            return FATHOM_READY;
        }
        if (pulse.width_us >= meter->noise_us) {
            meter->waiting = false;
            reading->width_us = pulse.width_us;
            reading->time_us = pulse.end_us;
            reading->kind = kind_of(meter, pulse.width_us);
            return FATHOM_READY;
        }
        count_one(&meter->noises);
    }
    return FATHOM_PENDING;
}

fathom_status_t fathom_pulse_init(fathom_pulse_meter_t *meter, const fathom_pulse_config_t *config)
{
    fathom_trigger_t *const trigger = &meter->trigger;
    const uint32_t cycle_us = config->cycle_us;
    meter->capture = config->capture;
    meter->no_target_us = or_default(config->no_target_us, FATHOM_PULSE_DEFAULT_NO_TARGET_US);
    meter->stuck_us = or_default(config->stuck_us, FATHOM_PULSE_DEFAULT_STUCK_US);
    meter->noise_us = (uint16_t)or_default(config->noise_us, FATHOM_PULSE_DEFAULT_NOISE_US);
    meter->noises = 0;
    meter->waiting = false;
    trigger->output = config->trigger;
    trigger->clock = config->clock;
    trigger->period_us =
        (cycle_us > FATHOM_PULSE_DEFAULT_CYCLE_US) ? cycle_us : FATHOM_PULSE_DEFAULT_CYCLE_US;
    trigger->low_us = config->low_us;
    if ((config->clock == NULL) || (meter->capture == NULL) || (meter->noise_us >= meter->no_target_us) ||
        (meter->no_target_us > meter->stuck_us))
        return FATHOM_ERR_ARGUMENT;
    return fathom_trigger_init(trigger);
}

fathom_status_t fathom_pulse_poll(fathom_pulse_meter_t *meter, fathom_pulse_reading_t *reading)
{
    fathom_trigger_t *const trigger = &meter->trigger;
    const fathom_capture_t *const capture = meter->capture;
    fathom_status_t status = FATHOM_PENDING;
    fathom_trigger_look(trigger);
    if (meter->waiting) status = take(meter, reading);
    if (!meter->waiting && fathom_trigger_is_due(trigger)) capture->arm(capture->ctx);
    const fathom_status_t driven = fathom_trigger_drive(trigger, !meter->waiting);
    if (driven == FATHOM_READY) meter->waiting = true;
    return ((status != FATHOM_PENDING) || (driven == FATHOM_READY)) ? status : driven;
}

uint32_t fathom_pulse_due_us(const fathom_pulse_meter_t *meter)
{
    return fathom_trigger_due_us(&meter->trigger, meter->trigger.left_us);
}

fathom_status_t fathom_pulse_deinit(fathom_pulse_meter_t *meter)
{
    meter->waiting = false;
    return fathom_trigger_deinit(&meter->trigger);
}
