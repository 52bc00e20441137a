/* SPDX-License-Identifier: MIT */
#include "fathom/a16_auto.h"

fathom_status_t fathom_a16_auto_init(fathom_a16_auto_t *sensor, const fathom_a16_auto_config_t *config)
{
    fathom_dyp_auto_t *const base = &sensor->base;
    base->stream_config.storage = sensor->storage;
    base->stream_config.stale_us = config->stale_us;
    base->stream_config.gap_us = config->gap_us;
    base->stream_config.length = FATHOM_DYP_A16_LENGTH;
    base->answer.values = sensor->values;
    fathom_dyp_window_copy(&base->answer.window, &config->window);
    base->answer.model = FATHOM_A16;
    base->answer.unit = 0;
    base->answer.first = 1;
    base->line = config->line;
    base->probes = 1;
    sensor->select = config->select;
    sensor->real_time = false;
    fathom_status_t status = fathom_dyp_auto_init(base, FATHOM_A16_MAX_MM);
    if (status < 0 || (sensor->select == NULL && !config->real_time)) return status;
    status = fathom_a16_auto_select(sensor, config->real_time);
    if (status == FATHOM_READY) return status;
    fathom_dyp_auto_deinit(base);
    return status == FATHOM_PENDING ? FATHOM_ERR_BUSY : status;
}

fathom_status_t fathom_a16_auto_select(fathom_a16_auto_t *sensor, bool real_time)
{
    fathom_status_t status = FATHOM_READY;
    if (sensor->select != NULL)
        sensor->select->set(sensor->select->ctx, !real_time);
    else
        status = fathom_line_break(sensor->base.line, real_time);
    if (status == FATHOM_READY) sensor->real_time = real_time;
    return status;
}

fathom_status_t fathom_a16_auto_deinit(fathom_a16_auto_t *sensor)
{
    const bool is_break = sensor->select == NULL && sensor->real_time;
    fathom_dyp_auto_deinit(&sensor->base);
    return is_break ? fathom_a16_auto_select(sensor, false) : FATHOM_READY;
}

fathom_sensor_t fathom_a16_auto_sensor(fathom_a16_auto_t *sensor)
{
    return fathom_dyp_auto_sensor(&sensor->base);
}
