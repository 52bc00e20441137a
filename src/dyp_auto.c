/* SPDX-License-Identifier: MIT */
#include "fathom/dyp_auto.h"

#include "fathom/dyp_frame.h"

static uint32_t now_us(const fathom_dyp_auto_t *sensor)
{
    const fathom_clock_t *const clock = sensor->line->config->clock;
    return clock->now_us(clock->ctx);
}

fathom_status_t fathom_dyp_auto_init(fathom_dyp_auto_t *sensor, uint16_t default_max_mm)
{
    fathom_status_t status = fathom_dyp_answer_init(&sensor->answer, default_max_mm);
    if (sensor->line == NULL || status < 0) return FATHOM_ERR_ARGUMENT;
    sensor->was_odd = true; /* there is no frame before the first that could say otherwise */
    status = fathom_stream_init(&sensor->stream, &sensor->stream_config, now_us(sensor));
    fathom_line_listen(sensor->line, &sensor->stream.listener);
    return status;
}

void fathom_dyp_auto_deinit(fathom_dyp_auto_t *sensor)
{
    if (sensor->line->listener == &sensor->stream.listener) fathom_line_listen(sensor->line, NULL);
}

/* The first fitted probe, as a bit, whose value is refused; 0: none. */
static uint8_t odd_probe(const fathom_dyp_auto_t *sensor)
{
    const uint16_t *value = sensor->answer.values;
    for (uint8_t bit = 1; bit <= sensor->probes; bit = (uint8_t)(bit << 1), value++)
        if ((sensor->probes & bit) != 0 &&
            fathom_dyp_meaning(&sensor->answer.window, *value) == FATHOM_MEANS_REFUSED)
            return bit;
    return 0;
}

/* The probes of which the newest frame speaks: all that are fitted, or the odd one alone. */
static uint8_t believed(fathom_dyp_auto_t *sensor)
{
    const uint8_t odd = odd_probe(sensor);
    const bool is_whole = odd == 0 || (sensor->stream.sure && sensor->was_odd);
    sensor->was_odd = odd != 0;
    return is_whole ? sensor->probes : odd;
}

/* An exchange that is open makes the line hold bytes back. They are newer than the frame: no silence has ended it. */
static bool is_followed(const fathom_dyp_auto_t *sensor)
{
    return sensor->stream.candidate && sensor->line->have != 0;
}

static fathom_status_t poll(void *ctx, fathom_sample_t *sample)
{
    fathom_dyp_auto_t *const sensor = ctx;
    fathom_dyp_answer_t *const answer = &sensor->answer;
    const fathom_status_t port = fathom_line_poll(sensor->line);
    const fathom_status_t next = fathom_dyp_next(answer, sample);
    if (next != FATHOM_PENDING) return next;
    if (port < 0) return port;
    if (is_followed(sensor)) return FATHOM_PENDING;

    const uint8_t *frame;
    const fathom_status_t status = fathom_stream_poll(&sensor->stream, now_us(sensor), &frame);
    if (status != FATHOM_READY) return status;
    fathom_dyp_frame_decode(frame, answer->values, (uint8_t)(sensor->stream_config.length / 2 - 1));
    fathom_dyp_answer(answer, believed(sensor), sensor->stream.time_us);
    return fathom_dyp_next(answer, sample);
}

static uint32_t due_us(void *ctx)
{
    const fathom_dyp_auto_t *const sensor = ctx;
    if (sensor->answer.left != 0) return 0;
    const uint32_t line_us = fathom_line_due_us(sensor->line);
    if (is_followed(sensor)) return line_us;
    const uint32_t stream_us = fathom_stream_due_us(&sensor->stream, now_us(sensor));
    return line_us < stream_us ? line_us : stream_us;
}

fathom_sensor_t fathom_dyp_auto_sensor(fathom_dyp_auto_t *sensor)
{
    fathom_sensor_t handle;
    handle.poll = poll;
    handle.due_us = due_us;
    handle.ctx = sensor;
    return handle;
}
