/* SPDX-License-Identifier: MIT */
#include "fathom/sensor/internal/dyp_auto.h"

#include "../common.h"

/*
 * The common part of a16_auto.c and a05_auto.c. A stream finds the frames; this file fetches the newest one
 * and its errors.
 */

/* Four periods between two measurements, in microseconds. */
static uint32_t periods_us(const fathom_model_facts_t *facts) { return facts->period_ms * UINT32_C(4000); }

fathom_status_t fathom_dyp_auto_init(fathom_dyp_auto_t *sensor)
{
    fathom_line_t *const line = sensor->line;
    fathom_listener_t *const listener = &sensor->stream.listener;
    const fathom_model_facts_t *const facts = sensor->measurement.facts;
    if ((line == NULL) || (line->parts == NULL)) return FATHOM_ERR_ARGUMENT;
    fathom_dyp_choose_gap(listener, line);
    if (listener->stale_us == 0u) listener->stale_us = FATHOM_STREAM_DEFAULT_STALE_US + periods_us(facts);
    if (!fathom_dyp_are_valid(facts) ||
        (fathom_stream_start(&sensor->stream, clock_us(line->parts->clock)) < 0))
        return FATHOM_ERR_ARGUMENT;
    return fathom_line_listen(line, listener);
}

void fathom_dyp_auto_deinit(fathom_dyp_auto_t *sensor)
{
    fathom_line_t *const line = sensor->line;
    if (line != NULL) fathom_line_unlisten(line, &sensor->stream.listener);
}

/* Returns true if the line holds back bytes that are newer than the candidate, because they may be a response. Then no
 * silence has ended the candidate. */
static bool is_followed(const fathom_dyp_auto_t *sensor)
{
    return (sensor->stream.candidate != FATHOM_STREAM_NOWHERE) && fathom_line_holds_bytes(sensor->line);
}

/* Stores the values of the newest frame. Returns 0 if all of them were stored already. fathom_dyp_stream_decode() would
 * need room for the new values beside the old ones. */
static unsigned store_values(const fathom_stream_t *stream, uint16_t *values)
{
    const uint8_t *frame = fathom_stream_frame(stream);
    unsigned changed = 0;
    for (unsigned left = (stream->length / 2u) - 1u; left != 0u; left--) {
        const uint16_t value = (uint16_t)((frame[1] * 256u) + frame[2]);
        changed |= (unsigned)*values ^ value;
        *values = value;
        values++;
        frame += 2;
    }
    return changed;
}

/* Three quarters of the period between two measurements, in microseconds. */
static uint32_t repeat_us(const fathom_model_facts_t *facts) { return facts->period_ms * UINT32_C(750); }

fathom_status_t fathom_dyp_auto_take(fathom_dyp_auto_t *sensor)
{
    fathom_stream_t *const stream = &sensor->stream;
    fathom_dyp_measurement_t *const measurement = &sensor->measurement;
    if (sensor->line == NULL) return FATHOM_ERR_ARGUMENT; /* init did not run, or failed */
    fathom_status_t status = fathom_line_poll(sensor->line);
    if ((status < 0) || is_followed(sensor)) return status;
    status = fathom_stream_poll(stream, sensor->line->polled_us);
    if (status != FATHOM_OK) return status;
    /* No frame precedes the first one, whose sequence is 0. */
    if ((store_values(stream, measurement->values) == 0u) && (measurement->sequence != 0u) &&
        (fathom_elapsed_us(stream->time_us, measurement->time_us) < repeat_us(measurement->facts)))
        measurement->left = 1; /* the same measurement again */
    else
        fathom_dyp_measurement_set(measurement, 1, stream->time_us);
    return FATHOM_OK;
}

uint32_t fathom_dyp_auto_due_us(const fathom_dyp_auto_t *sensor)
{
    const fathom_line_t *const line = sensor->line;
    const fathom_stream_t *const stream = &sensor->stream;
    if (line == NULL) return 0;
    if (is_followed(sensor)) return fathom_line_due_us(line);
    if (stream->is_new) return 0;
    /* The line knows when the silence after a frame is over: the silence is the listener's gap. */
    const uint32_t passed_us = time_since_us(clock_us(line->parts->clock), stream->since_us);
    return least_us(fathom_line_due_us(line), rest_us(stream->listener.stale_us, passed_us));
}
