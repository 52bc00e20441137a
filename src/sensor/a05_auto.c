/* SPDX-License-Identifier: MIT */
/*
 * The driver of an A05 that sends without a request. It selects the values by the RX pin, and decides which probes of a
 * frame are believed.
 */
#include "fathom/sensor/a05_auto.h"

#include "../common.h"

enum { ALL_PROBES = 0x0F };

/* Time until the next attempt to end the break, in microseconds. */
enum { AGAIN_US = 1000 };

const fathom_model_facts_t fathom_a05_auto_model = {.min_mm = 1, .max_mm = FATHOM_A05_MAX_MM};

fathom_status_t fathom_a05_auto_init(fathom_a05_auto_t *sensor, fathom_line_t *line,
                                     const fathom_a05_auto_config_t *config)
{
    fathom_dyp_auto_t *const base = &sensor->base;
    fathom_a05_auto_config_t zeroed;
    fathom_status_t status = FATHOM_ERR_ARGUMENT;
    clear(sensor, sizeof *sensor);
    config = config_or_zeroed(config, &zeroed, sizeof zeroed);
    base->stream.length = FATHOM_DYP_A05_LENGTH;
    base->stream.listener.gap_us = config->gap_us;
    base->stream.storage = sensor->storage;
    base->stream.listener.stale_us = config->stale_us;
    base->measurement.values = sensor->values;
    base->measurement.facts = fathom_dyp_facts_or(config->model, &fathom_a05_auto_model);
    base->measurement.model = FATHOM_A05;
    base->measurement.first = 1;
    base->line = line;
    sensor->probes = (uint8_t)or_default(config->probes, ALL_PROBES);
    sensor->was_odd = true; /* No good frame precedes the first one. */
    sensor->select = config->select;
    if (config->probes <= ALL_PROBES) status = fathom_dyp_auto_init(base);
    if (status != FATHOM_OK) {
        fathom_dyp_auto_deinit(base);
        clear(sensor, sizeof *sensor);
    }
    return status;
}

/* ---- The RX pin in the first second after power-on ---- */

fathom_status_t fathom_a05_auto_select(fathom_a05_auto_t *sensor, fathom_dyp_value_t value)
{
    fathom_dyp_auto_t *const base = &sensor->base;
    if ((base->line == NULL) || ((unsigned)value > FATHOM_REAL_TIME)) return FATHOM_ERR_ARGUMENT;
    const bool low = value == FATHOM_REAL_TIME;
    uint8_t level = FATHOM_OUTPUT_REST;
    if (low)
        level = FATHOM_OUTPUT_LOW;
    else if (sensor->selecting)
        level = FATHOM_OUTPUT_HIGH;
    const bool is_needed = low || (sensor->select.set != NULL);
    const fathom_status_t status = is_needed ? fathom_output_set(&sensor->select, level) : FATHOM_OK;
    if (status != FATHOM_OK) return (status == FATHOM_PENDING) ? FATHOM_ERR_BUSY : status;
    sensor->selecting = low;
    sensor->select_left_us = FATHOM_A05_SELECT_US;
    sensor->polled_us = clock_us(base->line->parts->clock);
    base->measurement.left = 0;
    return fathom_stream_start(&base->stream, sensor->polled_us);
}

static fathom_status_t end_selection(fathom_a05_auto_t *sensor)
{
    const fathom_status_t status = fathom_output_set(&sensor->select, FATHOM_OUTPUT_HIGH);
    if (status == FATHOM_OK) sensor->selecting = false;
    return status;
}

/* Makes RX high when its time is over. Returns FATHOM_PENDING, or the error of the output. */
static fathom_status_t release(fathom_a05_auto_t *sensor)
{
    const uint32_t now_us = clock_us(sensor->base.line->parts->clock);
    const uint32_t passed_us = fathom_elapsed_us(now_us, sensor->polled_us);
    sensor->polled_us = now_us;
    if (!sensor->selecting || !fathom_count_down(&sensor->select_left_us, passed_us)) return FATHOM_PENDING;
    const fathom_status_t status = end_selection(sensor);
    return (status == FATHOM_OK) ? FATHOM_PENDING : status;
}

fathom_status_t fathom_a05_auto_deinit(fathom_a05_auto_t *sensor)
{
    fathom_dyp_auto_deinit(&sensor->base);
    return sensor->selecting ? end_selection(sensor) : FATHOM_OK;
}

/* ---- Polling ---- */

/* Returns the bit of the first fitted probe whose value is refused (it is odd), or 0 if there is none. */
static uint8_t odd_probe(const fathom_a05_auto_t *sensor)
{
    const uint16_t *value = sensor->values;
    for (uint8_t bit = 1; bit <= sensor->probes; bit = (uint8_t)(bit << 1)) {
        if (((sensor->probes & bit) != 0u) &&
            (fathom_dyp_meaning(sensor->base.measurement.facts, *value) == FATHOM_MEANS_REFUSED))
            return bit;
        value++;
    }
    return 0;
}

/*
 * Returns the probes whose values of the newest frame are returned: all fitted probes, or only the odd one, whose value
 * is refused.
 *
 * If the place of a frame is not sure, an odd value can mean that the frame is out of step and its distances are
 * permuted. After good frames, damage is more likely than an odd probe, and the sum of 8 bits does not see one in 256
 * of the damaged frames. So a frame with an odd value is believed if its place is sure and the frame before had an odd
 * value too.
 */
static uint8_t believed(fathom_a05_auto_t *sensor)
{
    const uint8_t odd = odd_probe(sensor);
    const bool is_whole = (odd == 0u) || (sensor->base.stream.is_sure && sensor->was_odd);
    sensor->was_odd = odd != 0u;
    return is_whole ? sensor->probes : odd;
}

fathom_status_t fathom_a05_auto_sensor_poll(void *ctx, fathom_sample_t *sample)
{
    fathom_a05_auto_t *const sensor = ctx;
    fathom_dyp_measurement_t *const measurement = &sensor->base.measurement;
    if (sensor->base.line == NULL) return FATHOM_ERR_ARGUMENT;
    const fathom_status_t rx = release(sensor);
    fathom_status_t status = fathom_dyp_measurement_next(measurement, sample);
    if (status != FATHOM_PENDING) return status;
    status = fathom_dyp_auto_take(&sensor->base);
    if (status == FATHOM_OK) {
        measurement->left = believed(sensor);
        status = fathom_dyp_measurement_next(measurement, sample);
    }
    return (status != FATHOM_PENDING) ? status : rx;
}

uint32_t fathom_a05_auto_sensor_due_us(void *ctx)
{
    const fathom_a05_auto_t *const sensor = ctx;
    if (sensor->base.measurement.left != 0u) return 0;
    const uint32_t base_us = fathom_dyp_auto_due_us(&sensor->base);
    if (!sensor->selecting) return base_us;
    const uint32_t now_us = clock_us(sensor->base.line->parts->clock);
    const uint32_t left_us = or_default(sensor->select_left_us, AGAIN_US);
    return least_us(base_us, rest_us(left_us, fathom_elapsed_us(now_us, sensor->polled_us)));
}
