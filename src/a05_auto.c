/* SPDX-License-Identifier: MIT */
#include "fathom/a05_auto.h"

enum { ALL_PROBES = 0x0F };

fathom_status_t fathom_a05_auto_init(fathom_a05_auto_t *sensor, const fathom_a05_auto_config_t *config)
{
    fathom_dyp_auto_t *const base = &sensor->base;
    if (config->probes > ALL_PROBES) return FATHOM_ERR_ARGUMENT;
    base->stream_config.storage = sensor->storage;
    base->stream_config.stale_us = config->stale_us;
    base->stream_config.gap_us = config->gap_us;
    base->stream_config.length = FATHOM_DYP_A05_LENGTH;
    base->answer.values = sensor->values;
    base->answer.window.min_mm = config->window.min_mm;
    base->answer.window.max_mm = config->window.max_mm;
    base->answer.model = FATHOM_A05;
    base->answer.unit = 0;
    base->answer.first = 1;
    base->line = config->line;
    base->probes = config->probes != 0 ? config->probes : ALL_PROBES;
    return fathom_dyp_auto_init(base, FATHOM_A05_MAX_MM);
}

void fathom_a05_auto_deinit(fathom_a05_auto_t *sensor) { fathom_dyp_auto_deinit(&sensor->base); }

fathom_sensor_t fathom_a05_auto_sensor(fathom_a05_auto_t *sensor)
{
    return fathom_dyp_auto_sensor(&sensor->base);
}
