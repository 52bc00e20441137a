/* SPDX-License-Identifier: MIT */
/* The relay output of the simulated A05: measuring, the rule of the relay, and the bounces of the contact. */
#include <string.h>

#include "internal/switches.h"

enum { PROBES = 4, BOUNCE_US = 700 };

/* What a resistor to the supply makes of the contact that is wired, the other end of which is at ground. */
static bool is_high(const fathom_sim_a05_t *a05) { return a05->is_closed == a05->normally_closed; }

static void wait(fathom_sim_a05_t *a05, uint32_t now_us)
{
    const uint32_t until_us =
        a05->bounces_left != 0 ? now_us + BOUNCE_US : a05->measure_us; /* bounces end before the next one */
    fathom_sim_device_set_alarm(&a05->device, FATHOM_SIM_ALARM_PIN, until_us);
}

static bool is_near(fathom_sim_a05_t *a05, uint32_t now_us, bool *is_equal)
{
    bool is_any = false;
    *is_equal = false;
    for (uint8_t probe = 1; probe <= PROBES; probe++) {
        if ((a05->probes >> (probe - 1) & 1) == 0) continue;
        const int32_t value = fathom_sim_device_measure(&a05->device, probe, now_us);
        if (value > 0 && value < a05->threshold_mm) is_any = true;
        if (value == a05->threshold_mm) *is_equal = true;
    }
    return is_any;
}

/* The relay may not move again before hold_us have passed. */
static void measure(fathom_sim_a05_t *a05, uint32_t now_us)
{
    bool is_equal;
    const bool closes = is_near(a05, now_us, &is_equal);
    const bool holds = fathom_elapsed_us(now_us, a05->moved_us) < a05->hold_us && a05->is_young;
    a05->is_young = holds;
    if (holds || closes == a05->is_closed || (!closes && is_equal)) return;
    a05->is_closed = closes;
    a05->moved_us = now_us;
    a05->is_young = true;
    a05->bounces_left = a05->bounces;
}

static void alarm(fathom_sim_device_t *device, uint32_t now_us)
{
    fathom_sim_a05_t *const a05 = fathom_sim_a05_of(device);
    if (a05->bounces_left != 0) {
        a05->bounces_left--;
    } else {
        measure(a05, now_us);
        a05->measure_us += a05->every_us;
    }
    /* it ends where it belongs */
    fathom_sim_device_set_level(device, is_high(a05) == (a05->bounces_left % 2 == 0), now_us);
    wait(a05, now_us);
}

static void power_on(fathom_sim_device_t *device, uint32_t now_us)
{
    fathom_sim_a05_t *const a05 = fathom_sim_a05_of(device);
    a05->is_closed = a05->is_young = false; /* a relay without power has dropped */
    a05->bounces_left = 0;
    a05->measure_us = now_us + device->start_us + a05->every_us;
    fathom_sim_device_set_level(device, is_high(a05), now_us);
    wait(a05, now_us);
}

void fathom_sim_a05_relay_init(fathom_sim_a05_t *a05, const fathom_sim_a05_config_t *config)
{
    static const fathom_sim_model_t model = {.power_on = power_on, .alarm = alarm, .broadcast = 0xFF};
    fathom_sim_device_t *const device = &a05->device;
    memset(a05, 0, sizeof *a05);
    device->model = &model;
    device->faults = config->faults;
    device->scene = config->scene;
    device->settings.baud = 9600;
    device->settings.stop_bits = 1;
    device->start_us = config->start_us;
    device->random = config->seed;
    a05->every_us = fathom_sim_or_else(config->period_us, 300000);
    a05->hold_us = fathom_sim_or_else(config->hold_us, 1000000);
    a05->threshold_mm = (uint16_t)fathom_sim_or_else(config->threshold_mm, 1000);
    a05->probes = config->probes != 0 ? config->probes : 0x0F;
    a05->bounces = config->bounces;
    a05->normally_closed = config->normally_closed;
    device->off_high = is_high(a05); /* it drops */
}
