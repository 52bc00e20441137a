/* SPDX-License-Identifier: MIT */
#include "fathom/engine/pulse.h"

#include "../common.h"

/*
 * A meter triggers a sensor again and again and measures its pulse. Each cycle has one outcome:
 *
 *   trigger  ____          __________________________          ____
 *                |________|                          |________|
 *   capture    arm                  ____           arm
 *   output   ______________________|    |_________________________
 *                |<---------------- cycle_us ------->|
 *                |<- is_waiting ------->|
 *
 * A pulse of at least noise_us ends the wait. Otherwise the end of the cycle ends it, whatever the capture holds: noise
 * may arrive faster than polls take it.
 */

/* A poll takes at most this number of pulses. */
enum { MAX_TAKES = 16 };

static uint8_t kind_of(const fathom_pulse_meter_t *meter, uint32_t width_us)
{
    if (width_us > meter->stuck_us) return FATHOM_FAULT;
    return (width_us < meter->no_target_us) ? FATHOM_TARGET : FATHOM_NO_TARGET;
}

static fathom_status_t set_reading(fathom_pulse_reading_t *reading, uint8_t kind, uint32_t width_us,
                                   uint32_t time_us)
{
    reading->width_us = width_us;
    reading->time_us = time_us;
    reading->kind = kind;
    return FATHOM_OK;
}

/* The cycle is over and no pulse has ended the wait. */
static fathom_status_t end_cycle(fathom_pulse_meter_t *meter, bool is_high, fathom_pulse_reading_t *reading)
{
    const uint32_t now_us = meter->trigger.polled_us;
    meter->is_waiting = false;
    if (meter->short_us != 0u) return set_reading(reading, FATHOM_UNKNOWN, meter->short_us, now_us);
    return is_high ? set_reading(reading, FATHOM_FAULT, 0, now_us) : FATHOM_ERR_NO_RESPONSE;
}

static void note_short(fathom_pulse_meter_t *meter, uint32_t width_us)
{
    count_one(&meter->noises);
    if ((width_us >= FATHOM_PULSE_SHORT_US) && (width_us > meter->short_us))
        meter->short_us = (uint16_t)width_us;
}

static fathom_status_t take(fathom_pulse_meter_t *meter, fathom_pulse_reading_t *reading)
{
    const fathom_capture_t *const capture = meter->capture;
    fathom_pulse_t pulse;
    for (uint8_t left = MAX_TAKES; left != 0u; left--) {
        const int taken = capture->take(capture->ctx, &pulse);
        if (taken < 0) return FATHOM_ERR_PORT;
        if (taken == 0) break;
        if (time_since_us(clock_us(meter->trigger.clock), pulse.end_us) > FATHOM_PULSE_STALE_US) {
            count_one(&meter->stales);
            meter->is_waiting = false;
            return FATHOM_ERR_STALE;
        }
        if (pulse.width_us >= meter->noise_us) {
            meter->is_waiting = false;
            return set_reading(reading, kind_of(meter, pulse.width_us), pulse.width_us, pulse.end_us);
        }
        note_short(meter, pulse.width_us);
    }
    return (meter->trigger.left_us != 0u) ? FATHOM_PENDING : end_cycle(meter, pulse.is_high, reading);
}

/* Returns true if each member that the caller has set is inside its range. */
static bool is_valid(const fathom_pulse_meter_t *meter)
{
    const fathom_capture_t *const capture = meter->capture;
    return (capture != NULL) && (capture->arm != NULL) && (capture->take != NULL) &&
           (meter->noise_us < meter->no_target_us) && (meter->no_target_us <= meter->stuck_us) &&
           (meter->stuck_us <= meter->trigger.period_us);
}

fathom_status_t fathom_pulse_init(fathom_pulse_meter_t *meter)
{
    fathom_status_t status = FATHOM_ERR_ARGUMENT;
    meter->short_us = 0;
    meter->noises = 0;
    meter->stales = 0;
    meter->is_waiting = false;
    if (is_valid(meter)) status = fathom_trigger_init(&meter->trigger);
    if (status != FATHOM_OK) clear(meter, sizeof *meter);
    return status;
}

fathom_status_t fathom_pulse_poll(fathom_pulse_meter_t *meter, fathom_pulse_reading_t *reading)
{
    fathom_trigger_t *const trigger = &meter->trigger;
    const fathom_capture_t *const capture = meter->capture;
    fathom_status_t status = FATHOM_PENDING;
    if (capture == NULL) return FATHOM_ERR_ARGUMENT;
    fathom_trigger_update(trigger);
    if (meter->is_waiting) status = take(meter, reading);
    if (!meter->is_waiting && fathom_trigger_is_due(trigger)) capture->arm(capture->ctx);
    const fathom_status_t driven = fathom_trigger_drive(trigger, !meter->is_waiting);
    if (driven == FATHOM_OK) {
        meter->is_waiting = true;
        meter->short_us = 0;
        return status;
    }
    return (status != FATHOM_PENDING) ? status : driven;
}

uint32_t fathom_pulse_due_us(const fathom_pulse_meter_t *meter)
{
    if (meter->capture == NULL) return 0;
    return fathom_trigger_due_us(&meter->trigger, meter->trigger.left_us);
}

fathom_status_t fathom_pulse_deinit(fathom_pulse_meter_t *meter)
{
    meter->is_waiting = false;
    return fathom_trigger_deinit(&meter->trigger);
}
