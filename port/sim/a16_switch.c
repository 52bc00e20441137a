/* SPDX-License-Identifier: MIT */
/*
 * The switch output of the simulated A16 (A16 4(2)). A number of nearer or farther measurements in a row changes its
 * level.
 */
#include "internal/switches.h"

/* A16 4(2) */
enum { NEARER_IN_A_ROW = 3, FARTHER_IN_A_ROW = 5, POSITIVE = 1 };

static void drive(fathom_sim_a16_t *a16, uint32_t now_us)
{
    fathom_sim_device_set_level(&a16->device, a16->is_near == (a16->polarity == POSITIVE), now_us);
}

/* One more in this row and none in the other; a distance that is neither ends both. */
static void measure(fathom_sim_a16_t *a16, uint32_t now_us)
{
    const int32_t value = fathom_sim_device_measure(&a16->device, 1, now_us);
    const bool nothing = value <= 0 || value >= 0xFFFD; /* nothing there, in one of the sensor's words */
    const int32_t threshold_mm = (int32_t)a16->threshold_mm;
    const bool nearer = !nothing && value < threshold_mm;
    const bool farther = nothing || value > threshold_mm;
    a16->nearer = nearer ? (uint8_t)(a16->nearer + 1) : 0;
    a16->farther = farther ? (uint8_t)(a16->farther + 1) : 0;
    if (a16->nearer == NEARER_IN_A_ROW) {
        a16->is_near = true;
        a16->nearer = 0;
    }
    if (a16->farther == FARTHER_IN_A_ROW) {
        a16->is_near = false;
        a16->farther = 0;
    }
}

static void measure_next(fathom_sim_a16_t *a16)
{
    fathom_sim_device_set_alarm(&a16->device, FATHOM_SIM_ALARM_PIN, a16->measure_us);
}

void fathom_sim_a16_switch_power_on(fathom_sim_device_t *device, uint32_t now_us)
{
    fathom_sim_a16_t *const a16 = fathom_sim_a16_of(device);
    a16->is_near = false; /* until it has decided; the datasheet does not say */
    a16->nearer = a16->farther = 0;
    a16->measure_us = now_us + device->start_us + a16->every_us;
    drive(a16, now_us);
    measure_next(a16);
}

void fathom_sim_a16_switch_alarm(fathom_sim_device_t *device, uint32_t now_us)
{
    fathom_sim_a16_t *const a16 = fathom_sim_a16_of(device);
    if (fathom_sim_until_us(a16->measure_us, now_us) == 0) {
        measure(a16, now_us);
        a16->measure_us += a16->every_us;
    }
    drive(a16, now_us);
    measure_next(a16);
}

void fathom_sim_a16_switch_obey(fathom_sim_a16_t *a16)
{
    fathom_sim_device_set_alarm(&a16->device, FATHOM_SIM_ALARM_PIN, a16->device.heard_us);
}
