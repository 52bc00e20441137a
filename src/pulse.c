/* SPDX-License-Identifier: MIT */
#include "fathom/pulse.h"

/* A poll takes no more pulses than this: noise may come faster than it is read. */
enum { MAX_TAKES = 8, AGAIN_US = 1000 };

static uint32_t or_else(uint32_t value, uint32_t otherwise) { return value != 0 ? value : otherwise; }

static uint32_t cycle_us(const fathom_pulse_meter_t *meter)
{
    const uint32_t us = meter->config->cycle_us;
    return us > FATHOM_PULSE_DEFAULT_CYCLE_US ? us : FATHOM_PULSE_DEFAULT_CYCLE_US;
}

static uint16_t low_us(const fathom_pulse_config_t *config)
{
    return (uint16_t)or_else(config->low_us, FATHOM_PULSE_DEFAULT_LOW_US);
}

static uint32_t noise_us(const fathom_pulse_config_t *config)
{
    return or_else(config->noise_us, FATHOM_PULSE_DEFAULT_NOISE_US);
}

static uint32_t no_target_us(const fathom_pulse_config_t *config)
{
    return or_else(config->no_target_us, FATHOM_PULSE_DEFAULT_NO_TARGET_US);
}

static uint32_t stuck_us(const fathom_pulse_config_t *config)
{
    return or_else(config->stuck_us, FATHOM_PULSE_DEFAULT_STUCK_US);
}

static uint32_t now_us(const fathom_pulse_meter_t *meter)
{
    const fathom_clock_t *const clock = meter->config->clock;
    return clock->now_us(clock->ctx);
}

/* FATHOM_PENDING: not yet; said for a second at a time, and then FATHOM_ERR_PORT. */
static fathom_status_t hold(fathom_pulse_meter_t *meter, bool low)
{
    const fathom_pin_t *const trigger = meter->config->trigger;
    const fathom_uart_t *const uart = meter->config->uart;
    if (trigger != NULL) {
        trigger->set(trigger->ctx, !low);
        return FATHOM_READY;
    }
    const int is_done = uart->set_break(uart->ctx, low);
    const bool was_refused = meter->refused;
    meter->refused = is_done == 0;
    if (is_done > 0) return FATHOM_READY;
    if (is_done < 0) return FATHOM_ERR_PORT;
    const uint32_t at_us = now_us(meter);
    if (was_refused && fathom_elapsed_us(at_us, meter->refused_us) < FATHOM_PULSE_REFUSED_US)
        return FATHOM_PENDING;
    meter->refused_us = at_us;
    return was_refused ? FATHOM_ERR_PORT : FATHOM_PENDING;
}

/* The falling edge. The cycle is counted from a look at the clock that comes after it: so it is never too short,
 * whatever interrupts the two. */
static fathom_status_t begin(fathom_pulse_meter_t *meter)
{
    const fathom_capture_t *const capture = meter->config->capture;
    capture->arm(capture->ctx);
    const fathom_status_t status = hold(meter, true);
    if (status != FATHOM_READY) return status;
    meter->polled_us = now_us(meter);
    meter->left_us = cycle_us(meter);
    meter->low_left_us = low_us(meter->config);
    meter->low = true;
    meter->waiting = true;
    return FATHOM_PENDING;
}

/* The rising edge. Some high time must follow, or the next falling edge could be missed. */
static fathom_status_t release(fathom_pulse_meter_t *meter)
{
    const fathom_status_t status = hold(meter, false);
    if (status != FATHOM_READY) return status;
    meter->low = false;
    if (meter->left_us < low_us(meter->config)) meter->left_us = low_us(meter->config);
    return FATHOM_PENDING;
}

static uint8_t kind_of(const fathom_pulse_meter_t *meter, uint32_t width_us)
{
    if (width_us > stuck_us(meter->config)) return FATHOM_FAULT;
    return width_us < no_target_us(meter->config) ? FATHOM_TARGET : FATHOM_NO_TARGET;
}

static fathom_status_t take(fathom_pulse_meter_t *meter, bool over, fathom_pulse_reading_t *reading)
{
    const fathom_capture_t *const capture = meter->config->capture;
    fathom_pulse_t pulse;
    for (uint8_t left = MAX_TAKES; left != 0; left--) {
        const int has = capture->take(capture->ctx, &pulse);
        if (has < 0) return FATHOM_ERR_PORT;
        if (has == 0) {
            if (!over) return FATHOM_PENDING;
            meter->waiting = false;
            if (!pulse.is_high) return FATHOM_ERR_NO_ANSWER;
            reading->width_us = 0;
            reading->time_us = meter->polled_us;
            reading->kind = FATHOM_FAULT;
            return FATHOM_READY;
        }
        if (pulse.width_us >= noise_us(meter->config)) {
            meter->waiting = false;
            reading->width_us = pulse.width_us;
            reading->time_us = pulse.end_us;
            reading->kind = kind_of(meter, pulse.width_us);
            return FATHOM_READY;
        }
        if (meter->noises != UINT16_MAX) meter->noises++;
    }
    return FATHOM_PENDING;
}

fathom_status_t fathom_pulse_init(fathom_pulse_meter_t *meter, const fathom_pulse_config_t *config)
{
    if (config->clock == NULL || config->capture == NULL ||
        (config->trigger == NULL && config->uart == NULL) || noise_us(config) >= no_target_us(config) ||
        no_target_us(config) > stuck_us(config))
        return FATHOM_ERR_ARGUMENT;
    if (config->trigger == NULL && config->uart->set_break == NULL) return FATHOM_ERR_UNSUPPORTED;
    meter->config = config;
    if (config->trigger != NULL) (void)hold(meter, false);
    meter->polled_us = now_us(meter);
    meter->left_us = low_us(config);
    meter->low_left_us = 0;
    meter->noises = 0;
    meter->low = false;
    meter->waiting = false;
    meter->refused = false;
    return FATHOM_READY;
}

fathom_status_t fathom_pulse_poll(fathom_pulse_meter_t *meter, fathom_pulse_reading_t *reading)
{
    const uint32_t at_us = now_us(meter);
    const uint32_t passed_us = fathom_elapsed_us(at_us, meter->polled_us);
    uint32_t low_left_us = meter->low_left_us;
    fathom_status_t status = FATHOM_PENDING;
    fathom_status_t trigger = FATHOM_PENDING;
    meter->polled_us = at_us;
    const bool over = fathom_run_down(&meter->left_us, passed_us);
    fathom_run_down(&low_left_us, passed_us);
    meter->low_left_us = (uint16_t)low_left_us;
    if (meter->waiting) status = take(meter, over, reading);
    if (meter->low && low_left_us == 0) trigger = release(meter);
    if (!meter->waiting && !meter->low && meter->left_us == 0) trigger = begin(meter);
    return status != FATHOM_PENDING ? status : trigger;
}

uint32_t fathom_pulse_due_us(const fathom_pulse_meter_t *meter)
{
    const uint32_t passed_us = fathom_elapsed_us(now_us(meter), meter->polled_us);
    uint32_t due_us = meter->low ? meter->low_left_us : meter->left_us;
    /* it could not be done when it was due: the port was busy */
    if (due_us == 0) due_us = AGAIN_US;
    return due_us > passed_us ? due_us - passed_us : 0;
}

fathom_status_t fathom_pulse_deinit(fathom_pulse_meter_t *meter)
{
    const fathom_status_t status = meter->low ? hold(meter, false) : FATHOM_READY;
    if (status == FATHOM_READY) meter->low = false;
    meter->waiting = false;
    return status;
}
