/* SPDX-License-Identifier: MIT */
#include "fathom/processing/median.h"

#include "../common.h"

/*
 * The median of a window of samples, and the gate in front of it. The window stays in order of arrival; the
 * median is searched at each sample.
 */

/* The window has the millimetres of each sample. NEARER and FARTHER stand for samples without a distance. */
enum { NEARER = 0 };
#define FARTHER UINT16_MAX

static bool is_configuration(const fathom_median_config_t *config)
{
    return (config->window != NULL) && (config->count >= FATHOM_MEDIAN_MIN_COUNT) &&
           (config->count <= FATHOM_MEDIAN_MAX_COUNT) &&
           ((config->unknown_us <= FATHOM_MAX_DURATION_US) || (config->unknown_us == FATHOM_NO_DEADLINE));
}

fathom_status_t fathom_median_init(fathom_median_t *median, const fathom_median_config_t *config)
{
    fathom_median_config_t *const own = &median->config;
    clear(median, sizeof *median);
    if (!is_configuration(config)) return FATHOM_ERR_ARGUMENT;
    copy(own, config, sizeof *own);
    /* Assigned again, because an analyser does not follow a pointer through copied bytes. */
    own->window = config->window;
    own->unknown_us = or_default(own->unknown_us, FATHOM_MEDIAN_DEFAULT_UNKNOWN_US);
    if (own->gate_row == 0u) own->gate_row = FATHOM_MEDIAN_DEFAULT_GATE_ROW;
    return FATHOM_OK;
}

static bool is_initialised(const fathom_median_t *median) { return median->config.window != NULL; }

static bool is_full(const fathom_median_t *median) { return median->have == median->config.count; }

static bool is_spike(const fathom_median_t *median, uint16_t mm)
{
    const uint32_t gate_mm = median->config.gate_mm;
    const uint16_t value = median->value;
    if ((gate_mm == 0u) || !is_full(median)) return false;
    return ((mm == FARTHER) != (value == FARTHER)) || (mm > (value + gate_mm)) || (value > (mm + gate_mm));
}

/* Returns the median of a full window: less than half of the samples are nearer, and not more than half are farther. */
static uint16_t middle_of(const fathom_median_t *median)
{
    const uint8_t count = median->config.count;
    const uint8_t before = (uint8_t)((count - 1u) / 2u);
    const uint16_t *at = median->config.window;
    const uint16_t *const last = &at[count - 1u];
    for (; at < last; at++) {
        uint8_t nearer = 0;
        uint8_t as_near = 0;
        for (uint8_t i = 0; i < count; i++) {
            if (median->config.window[i] < *at) nearer++;
            if (median->config.window[i] <= *at) as_near++;
        }
        if ((nearer <= before) && (as_near > before)) break;
    }
    return *at; /* One sample is the median: the last one if none of the others is. */
}

bool fathom_median_advance(fathom_median_t *median, uint32_t now_us)
{
    const uint32_t passed_us = fathom_elapsed_us(now_us, median->fed_us);
    /* A difference above half of what the clock counts is a time before the sample. */
    if ((median->have == 0u) || (passed_us <= median->config.unknown_us) || (passed_us > (UINT32_MAX / 2u)))
        return false;
    median->have = 0;
    return true;
}

/* Adds a sample that counts. Returns true if there is a median. */
static bool take(fathom_median_t *median, uint16_t mm, uint32_t time_us)
{
    (void)fathom_median_advance(median, time_us);
    median->fed_us = time_us;
    if (is_spike(median, mm)) {
        if (median->row != median->config.gate_row) {
            median->row++;
            count_one(&median->dropped);
            return false;
        }
        median->have = 0;
    }
    median->row = 0;
    median->config.window[median->next] = mm;
    median->next++;
    if (median->next >= median->config.count) median->next = 0;
    if (!is_full(median)) median->have++;
    if (!is_full(median)) return false;
    median->value = middle_of(median);
    return true;
}

bool fathom_median_add_sample(fathom_median_t *median, const fathom_sample_t *sample, fathom_sample_t *out)
{
    uint16_t mm = NEARER;
    uint8_t kind = FATHOM_TARGET;
    if (!is_initialised(median)) return false;
    if (sample->kind == FATHOM_TARGET)
        mm = sample->distance_mm;
    else if ((sample->kind == FATHOM_NO_TARGET) || (sample->kind == FATHOM_FAR))
        mm = FARTHER;
    else if (sample->kind != FATHOM_NEAR)
        return false;
    if (!take(median, mm, sample->time_us)) return false;
    mm = median->value;
    if (mm == NEARER) kind = FATHOM_NEAR;
    if (mm == FARTHER) {
        kind = FATHOM_NO_TARGET;
        mm = 0;
    }
    copy(out, sample, sizeof *out);
    if (out->kind != kind) out->interference = false;
    out->kind = kind;
    out->distance_mm = mm;
    return true;
}
