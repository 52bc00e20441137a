/* SPDX-License-Identifier: MIT */
#include "fathom/sensor/a16_auto.h"

#include "../common.h"

/*
 * The driver of an A16 with automatic output. dyp_auto.c finds the frames; this file selects the value that
 * the module sends.
 */

const fathom_model_facts_t fathom_a16_auto_model = {.min_mm = 1, .max_mm = FATHOM_A16_MAX_MM};

fathom_status_t fathom_a16_auto_init(fathom_a16_auto_t *sensor, fathom_line_t *line,
                                     const fathom_a16_auto_config_t *config)
{
    fathom_dyp_auto_t *const base = &sensor->base;
    fathom_a16_auto_config_t zeroed;
    clear(sensor, sizeof *sensor);
    config = config_or_zeroed(config, &zeroed, sizeof zeroed);
    base->stream.length = FATHOM_DYP_A16_LENGTH;
    base->stream.listener.gap_us = config->gap_us;
    base->stream.storage = sensor->storage;
    base->stream.listener.stale_us = config->stale_us;
    base->measurement.facts = fathom_dyp_facts_or(config->model, &fathom_a16_auto_model);
    base->measurement.values = sensor->values;
    base->measurement.model = FATHOM_A16;
    base->measurement.first = 1;
    base->line = line;
    sensor->select = config->select;
    sensor->value = FATHOM_PROCESSED;
    fathom_status_t status = fathom_dyp_auto_init(base);
    if ((status == FATHOM_OK) && ((sensor->select.set != NULL) || (config->value != FATHOM_PROCESSED)))
        status = fathom_a16_auto_select(sensor, (fathom_dyp_value_t)config->value);
    if (status != FATHOM_OK) {
        fathom_dyp_auto_deinit(base);
        clear(sensor, sizeof *sensor);
    }
    return (status == FATHOM_PENDING) ? FATHOM_ERR_BUSY : status;
}

fathom_status_t fathom_a16_auto_select(fathom_a16_auto_t *sensor, fathom_dyp_value_t value)
{
    if ((sensor->base.line == NULL) || ((unsigned)value > FATHOM_REAL_TIME)) return FATHOM_ERR_ARGUMENT;
    /* The level is FATHOM_OUTPUT_HIGH or _LOW. If TX was not held low, only a pin is driven. */
    const bool is_driven = (value != FATHOM_PROCESSED) || (sensor->value != FATHOM_PROCESSED);
    const uint8_t level = (uint8_t)(is_driven ? (unsigned)value : (unsigned)FATHOM_OUTPUT_REST);
    const fathom_status_t status = fathom_output_set(&sensor->select, level);
    if (status == FATHOM_OK) sensor->value = (uint8_t)value;
    return status;
}

fathom_status_t fathom_a16_auto_deinit(fathom_a16_auto_t *sensor)
{
    fathom_dyp_auto_deinit(&sensor->base);
    if (sensor->value == FATHOM_PROCESSED) return FATHOM_OK;
    const fathom_status_t status = fathom_output_set(&sensor->select, FATHOM_OUTPUT_FREE);
    if (status == FATHOM_OK) sensor->value = FATHOM_PROCESSED;
    return status;
}

fathom_status_t fathom_a16_auto_sensor_poll(void *ctx, fathom_sample_t *sample)
{
    fathom_a16_auto_t *const sensor = ctx;
    const fathom_status_t status = fathom_dyp_auto_take(&sensor->base);
    return (status == FATHOM_OK) ? fathom_dyp_measurement_next(&sensor->base.measurement, sample) : status;
}

uint32_t fathom_a16_auto_sensor_due_us(void *ctx)
{
    const fathom_a16_auto_t *const sensor = ctx;
    return fathom_dyp_auto_due_us(&sensor->base);
}
