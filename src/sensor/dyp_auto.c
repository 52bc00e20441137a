/* SPDX-License-Identifier: MIT */
#include "fathom/sensor/dyp_auto.h"

#include "../common.h"
#include "fathom/codec/dyp_stream.h"

fathom_status_t fathom_dyp_auto_init(fathom_dyp_auto_t *sensor, uint16_t default_max_mm)
{
    fathom_line_t *const line = sensor->line;
    const fathom_status_t status = fathom_dyp_measurement_init(&sensor->measurement, default_max_mm);
    if (line == NULL) return FATHOM_ERR_ARGUMENT;
    fathom_stream_begin(&sensor->stream, clock_us(line->config->clock));
    return status;
}

void fathom_dyp_auto_deinit(fathom_dyp_auto_t *sensor)
{
    if (sensor->line->listener == &sensor->stream.listener) fathom_line_listen(sensor->line, NULL);
}

/* A transaction that is open makes the line hold bytes back. They are newer than the frame: no silence has ended it. */
static bool is_followed(const fathom_dyp_auto_t *sensor)
{
    return (sensor->stream.candidate != 0u) && (sensor->line->have != 0u);
}

fathom_status_t fathom_dyp_auto_take(fathom_dyp_auto_t *sensor)
{
    fathom_stream_t *const stream = &sensor->stream;
    fathom_dyp_measurement_t *const measurement = &sensor->measurement;
    fathom_status_t status = fathom_line_poll(sensor->line);
    if ((status < 0) || is_followed(sensor)) return status;
    status = fathom_stream_poll(stream, sensor->line->polled_us);
    if (status != FATHOM_READY) return status;
    fathom_dyp_stream_decode(fathom_stream_frame(stream), measurement->values,
                             (uint8_t)((stream->length / 2u) - 1u));
    fathom_dyp_measurement_set(measurement, 1, stream->time_us);
    return FATHOM_READY;
}

uint32_t fathom_dyp_auto_due_us(const fathom_dyp_auto_t *sensor)
{
    const fathom_line_t *const line = sensor->line;
    const fathom_stream_t *const stream = &sensor->stream;
    if (is_followed(sensor)) return fathom_line_due_us(line);
    if (stream->fresh) return 0;
    /* The line knows when the silence behind a frame is over: it is the listener's gap. */
    const uint32_t passed_us = fathom_elapsed_us(clock_us(line->config->clock), stream->since_us);
    return least_us(fathom_line_due_us(line), rest_us(stream->stale_us, passed_us));
}
