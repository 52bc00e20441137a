/* SPDX-License-Identifier: MIT */
#include "fathom/a05_auto.h"

enum { ALL_PROBES = 0x0F, AGAIN_US = 1000 };

fathom_status_t fathom_a05_auto_init(fathom_a05_auto_t *sensor, const fathom_a05_auto_config_t *config)
{
    fathom_dyp_auto_t *const base = &sensor->base;
    if (config->probes > ALL_PROBES) return FATHOM_ERR_ARGUMENT;
    base->stream_config.storage = sensor->storage;
    base->stream_config.stale_us = config->stale_us;
    base->stream_config.gap_us = config->gap_us;
    base->stream_config.length = FATHOM_DYP_A05_LENGTH;
    base->answer.values = sensor->values;
    fathom_dyp_window_copy(&base->answer.window, &config->window);
    base->answer.model = FATHOM_A05;
    base->answer.unit = 0;
    base->answer.first = 1;
    base->line = config->line;
    base->probes = config->probes != 0 ? config->probes : ALL_PROBES;
    sensor->select = config->select;
    sensor->selecting = false;
    return fathom_dyp_auto_init(base, FATHOM_A05_MAX_MM);
}

/* ---- the RX pin in the first second ---- */

static uint32_t now_us(const fathom_a05_auto_t *sensor)
{
    const fathom_clock_t *const clock = sensor->base.line->config->clock;
    return clock->now_us(clock->ctx);
}

static fathom_status_t select(const fathom_a05_auto_t *sensor, bool low)
{
    if (sensor->select == NULL) return fathom_line_break(sensor->base.line, low);
    sensor->select->set(sensor->select->ctx, !low);
    return FATHOM_READY;
}

fathom_status_t fathom_a05_auto_power_on(fathom_a05_auto_t *sensor, fathom_a05_value_t value)
{
    fathom_dyp_auto_t *const base = &sensor->base;
    if ((unsigned)value > FATHOM_A05_REAL_TIME) return FATHOM_ERR_ARGUMENT;
    const bool low = value == FATHOM_A05_REAL_TIME;
    /* A TX that nobody holds low is high anyway. */
    const bool is_needed = low || sensor->selecting || sensor->select != NULL;
    const fathom_status_t status = is_needed ? select(sensor, low) : FATHOM_READY;
    if (status != FATHOM_READY) return status == FATHOM_PENDING ? FATHOM_ERR_BUSY : status;
    sensor->selecting = low;
    sensor->select_left_us = FATHOM_A05_SELECT_US;
    sensor->polled_us = now_us(sensor);
    base->answer.left = 0;
    return fathom_stream_init(&base->stream, &base->stream_config, sensor->polled_us);
}

static fathom_status_t end_selection(fathom_a05_auto_t *sensor)
{
    const fathom_status_t status = select(sensor, false);
    if (status == FATHOM_READY) sensor->selecting = false;
    return status;
}

/* FATHOM_PENDING, or what is wrong. */
static fathom_status_t release(fathom_a05_auto_t *sensor)
{
    const uint32_t now = now_us(sensor);
    const uint32_t passed_us = fathom_elapsed_us(now, sensor->polled_us);
    sensor->polled_us = now;
    if (!sensor->selecting || !fathom_run_down(&sensor->select_left_us, passed_us)) return FATHOM_PENDING;
    const fathom_status_t status = end_selection(sensor);
    return status == FATHOM_READY ? FATHOM_PENDING : status;
}

fathom_status_t fathom_a05_auto_deinit(fathom_a05_auto_t *sensor)
{
    fathom_dyp_auto_deinit(&sensor->base);
    return sensor->selecting ? end_selection(sensor) : FATHOM_READY;
}

/* ---- reading ---- */

static fathom_status_t poll(void *ctx, fathom_sample_t *sample)
{
    fathom_a05_auto_t *const sensor = ctx;
    const fathom_sensor_t base = fathom_dyp_auto_sensor(&sensor->base);
    const fathom_status_t rx = release(sensor);
    const fathom_status_t status = base.poll(base.ctx, sample);
    return status != FATHOM_PENDING ? status : rx;
}

static uint32_t due_us(void *ctx)
{
    fathom_a05_auto_t *const sensor = ctx;
    const fathom_sensor_t base = fathom_dyp_auto_sensor(&sensor->base);
    const uint32_t base_us = base.due_us(base.ctx);
    if (!sensor->selecting) return base_us;
    const uint32_t passed_us = fathom_elapsed_us(now_us(sensor), sensor->polled_us);
    uint32_t left_us = sensor->select_left_us != 0 ? sensor->select_left_us : AGAIN_US;
    fathom_run_down(&left_us, passed_us);
    return left_us < base_us ? left_us : base_us;
}

fathom_sensor_t fathom_a05_auto_sensor(fathom_a05_auto_t *sensor)
{
    fathom_sensor_t handle;
    handle.poll = poll;
    handle.due_us = due_us;
    handle.ctx = sensor;
    return handle;
}
