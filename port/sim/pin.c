/* SPDX-License-Identifier: MIT */
/* The pins of a simulated device for the HAL: the level and the pulses of TX, and the level of RX. */
#include "pin.h"

#include <string.h>

/* ---- what the host sees of TX ---- */

static void pulse_ended(fathom_sim_pins_t *pins, uint32_t now_us)
{
    if (pins->waiting == FATHOM_SIM_PULSES) {
        if (pins->lost != UINT16_MAX) pins->lost++;
        return;
    }
    fathom_pulse_t *const pulse = &pins->pulses[(pins->first + pins->waiting) % FATHOM_SIM_PULSES];
    const uint32_t began_us = fathom_sim_clock_stamp_us(pins->clock, pins->began_us);
    pulse->end_us = fathom_sim_clock_stamp_us(pins->clock, now_us);
    pulse->width_us = fathom_elapsed_us(pulse->end_us, began_us);
    pins->waiting++;
}

static bool at_host(const fathom_sim_pins_t *pins, bool high)
{
    return pins->wire == FATHOM_SIM_WIRE_WHOLE ? high : pins->wire == FATHOM_SIM_WIRE_HIGH;
}

static void watch(void *ctx, bool high, uint32_t now_us)
{
    fathom_sim_pins_t *const pins = (fathom_sim_pins_t *)ctx;
    high = at_host(pins, high);
    if (high == pins->high) return;
    pins->high = high;
    if (!high && pins->began) pulse_ended(pins, now_us);
    pins->began = high && pins->armed;
    pins->began_us = now_us;
    if (pins->on_edge != NULL)
        pins->on_edge(pins->on_edge_ctx, high, fathom_sim_clock_stamp_us(pins->clock, now_us));
}

void fathom_sim_tx_wire(fathom_sim_pins_t *pins, fathom_sim_tx_wire_t wire)
{
    fathom_sim_run(pins->line, pins->clock->now_us);
    pins->wire = (uint8_t)wire;
    watch(pins, pins->device->tx_high, pins->clock->now_us);
}

/* ---- the HAL ---- */

static void set(void *ctx, bool high)
{
    const fathom_sim_pins_t *const pins = (const fathom_sim_pins_t *)ctx;
    fathom_sim_run(pins->line, pins->clock->now_us);
    fathom_sim_device_hold_rx(pins->device, FATHOM_SIM_HELD_BY_PIN, !high, pins->clock->now_us);
}

static bool get(void *ctx)
{
    const fathom_sim_pins_t *const pins = (const fathom_sim_pins_t *)ctx;
    fathom_sim_run(pins->line, pins->clock->now_us);
    return at_host(pins, fathom_sim_device_level(pins->device, pins->clock->now_us));
}

static void arm(void *ctx)
{
    fathom_sim_pins_t *const pins = (fathom_sim_pins_t *)ctx;
    fathom_sim_run(pins->line, pins->clock->now_us);
    pins->armed = true;
    pins->began = false;
    pins->waiting = 0;
}

static int take(void *ctx, fathom_pulse_t *pulse)
{
    fathom_sim_pins_t *const pins = (fathom_sim_pins_t *)ctx;
    fathom_sim_run(pins->line, pins->clock->now_us);
    pulse->is_high = pins->high;
    if (pins->waiting == 0) return 0;
    *pulse = pins->pulses[pins->first];
    pulse->is_high = pins->high;
    pins->first = (uint8_t)((pins->first + 1) % FATHOM_SIM_PULSES);
    pins->waiting--;
    return 1;
}

void fathom_sim_pins_init(fathom_sim_pins_t *pins, fathom_sim_device_t *device, fathom_sim_line_t *line,
                          fathom_sim_clock_t *clock)
{
    memset(pins, 0, sizeof *pins);
    pins->line = line;
    pins->device = device;
    pins->clock = clock;
    fathom_sim_clock_add(clock, line);
    fathom_sim_run(line, clock->now_us);
    pins->high = device->tx_high;
    device->watch = watch;
    device->watch_ctx = pins;
}

fathom_pin_t fathom_sim_rx_pin(fathom_sim_pins_t *pins)
{
    const fathom_pin_t hal = {set, NULL, pins};
    return hal;
}

fathom_pin_t fathom_sim_tx_pin(fathom_sim_pins_t *pins)
{
    const fathom_pin_t hal = {NULL, get, pins};
    return hal;
}

fathom_capture_t fathom_sim_capture(fathom_sim_pins_t *pins)
{
    const fathom_capture_t hal = {arm, take, pins};
    return hal;
}
