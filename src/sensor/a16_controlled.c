/* SPDX-License-Identifier: MIT */
#include "fathom/sensor/a16_controlled.h"

#include "../common.h"

/*
 * The driver of an A16 with controlled output. A trigger makes the edges, a stream finds the frames, and this
 * file decides which frame is the response.
 */

const fathom_model_facts_t fathom_a16_controlled_model = {
    .min_mm = 1,
    .max_mm = FATHOM_A16_MAX_MM,
    .period_ms =
        121, /* "must be greater than 120ms" (A16 3(2)), also by a clock that counts in milliseconds */
    .start = FATHOM_STARTS_FALLING,
    .earliest_ms = 80, /* A16 3(3): 90 to 110 ms, and a margin for the clocks and the frame */
    .latest_ms = 130,
};

/* The greatest time from the trigger to a response that can be told from a time before the trigger. */
#define MAX_RESPONSE_US FATHOM_MAX_DURATION_US

static uint32_t latest_us(const fathom_a16_controlled_t *sensor)
{
    return fathom_dyp_us(sensor->measurement.facts->latest_ms);
}

/*
 * Returns true if bytes that arrived between `came_us` and `time_us` can be the response to the trigger.
 *
 *     trigger   |edge   earliest_us      latest_us
 *     in time   |       |<------------------>|         one time of came_us .. time_us is in here
 *     before  x |                                      time_us is before the edge: never
 *
 * Differences of times wrap, so a time before the edge appears as more than MAX_RESPONSE_US after the edge.
 */
static bool is_in_time(const fathom_a16_controlled_t *sensor, uint32_t time_us)
{
    const uint32_t after_us = fathom_elapsed_us(time_us, sensor->edge_us);
    return sensor->waiting && (after_us >= fathom_dyp_us(sensor->measurement.facts->earliest_ms)) &&
           (after_us <= MAX_RESPONSE_US) &&
           (fathom_elapsed_us(sensor->came_us, sensor->edge_us) <= latest_us(sensor));
}

static void receive(fathom_listener_t *listener, const uint8_t *bytes, uint8_t count, bool after_gap,
                    uint32_t time_us)
{
    fathom_a16_controlled_t *const sensor = (fathom_a16_controlled_t *)listener;
    /* Without time stamps, `time_us` is the time of the line's poll. The bytes may be as old as the previous poll. */
    sensor->came_us = (time_us == sensor->line->polled_us) ? sensor->trigger.polled_us : time_us;
    if (is_in_time(sensor, time_us)) sensor->heard = true;
    fathom_stream_receive(listener, bytes, count, after_gap, time_us);
}

static fathom_status_t judge(fathom_a16_controlled_t *sensor, fathom_sample_t *sample)
{
    fathom_dyp_measurement_t *const measurement = &sensor->measurement;
    if (!is_in_time(sensor, sensor->stream.time_us)) {
        count_one(&sensor->late);
        return FATHOM_PENDING;
    }
    sensor->waiting = false;
    fathom_dyp_stream_decode(fathom_stream_frame(&sensor->stream), measurement->values, 1);
    fathom_dyp_measurement_set(measurement, 1, sensor->stream.time_us);
    return fathom_dyp_measurement_next(measurement, sample);
}

/* Returns the rest of the time in which the response may arrive, at the last update of the trigger. */
static uint32_t response_left_us(const fathom_a16_controlled_t *sensor)
{
    return rest_us(latest_us(sensor), fathom_elapsed_us(sensor->trigger.polled_us, sensor->edge_us));
}

fathom_status_t fathom_a16_controlled_sensor_poll(void *ctx, fathom_sample_t *sample)
{
    fathom_a16_controlled_t *const sensor = ctx;
    fathom_trigger_t *const trigger = &sensor->trigger;
    if (sensor->line == NULL) return FATHOM_ERR_ARGUMENT; /* init did not run, or failed */
    fathom_status_t status = fathom_line_poll(sensor->line);
    fathom_trigger_update(trigger);
    if (status < 0) return status;
    /* Only frames of the stream count. Without a trigger the sensor is silent, and the stream then reports an error. */
    if (fathom_stream_poll(&sensor->stream, trigger->polled_us) == FATHOM_OK) status = judge(sensor, sample);
    if (sensor->waiting && (sensor->stream.candidate == FATHOM_STREAM_NOWHERE) &&
        (response_left_us(sensor) == 0u)) {
        sensor->waiting = false;
        status = sensor->heard ? FATHOM_ERR_CHECKSUM : FATHOM_ERR_NO_RESPONSE;
    }
    const fathom_status_t driven = fathom_trigger_drive(trigger, !sensor->waiting);
    if (driven == FATHOM_OK) {
        sensor->edge_us = trigger->polled_us;
        sensor->waiting = true;
        sensor->heard = false;
        /* What arrived before the edge is read now, and is too early to be the response. */
        (void)fathom_line_poll(sensor->line);
    }
    return ((status != FATHOM_PENDING) || (driven == FATHOM_OK)) ? status : driven;
}

uint32_t fathom_a16_controlled_sensor_due_us(void *ctx)
{
    const fathom_a16_controlled_t *const sensor = ctx;
    const fathom_trigger_t *const trigger = &sensor->trigger;
    if (sensor->line == NULL) return 0;
    const uint32_t until_us = sensor->waiting ? response_left_us(sensor) : trigger->left_us;
    if (sensor->stream.is_new) return 0;
    /* The line knows when the silence after a frame is over: the silence is the listener's gap. */
    return least_us(fathom_trigger_due_us(trigger, until_us), fathom_line_due_us(sensor->line));
}

/* ---- Initialisation ---- */

static void stop_listening(fathom_a16_controlled_t *sensor)
{
    fathom_line_t *const line = sensor->line;
    if (line != NULL) fathom_line_unlisten(line, &sensor->stream.listener);
}

/* Copies the configuration. Returns true if each member is inside its range. */
static bool configure(fathom_a16_controlled_t *sensor, const fathom_a16_controlled_config_t *config)
{
    const fathom_line_t *const line = sensor->line;
    fathom_stream_t *const stream = &sensor->stream;
    fathom_trigger_t *const trigger = &sensor->trigger;
    fathom_dyp_measurement_t *const measurement = &sensor->measurement;
    const fathom_model_facts_t *const facts =
        fathom_dyp_facts_or(config->model, &fathom_a16_controlled_model);
    measurement->facts = facts;
    measurement->values = sensor->values;
    measurement->model = FATHOM_A16;
    measurement->first = 1;
    /* Without a known period the next trigger follows the latest response. */
    trigger->period_us = fathom_dyp_us((uint16_t)or_default(facts->period_ms, facts->latest_ms));
    if (config->period_us > trigger->period_us) trigger->period_us = config->period_us;
    trigger->low_us = facts->trigger_us;
    stream->length = FATHOM_DYP_A16_LENGTH;
    stream->listener.gap_us = config->gap_us;
    stream->storage = sensor->storage;
    stream->listener.stale_us = latest_us(sensor); /* The line drops bytes that are older. */
    if ((line == NULL) || (line->parts == NULL)) return false;
    fathom_dyp_choose_gap(&stream->listener, line);
    trigger->clock = line->parts->clock;
    return (trigger->output.set != NULL) && (facts->latest_ms != 0u) &&
           (facts->earliest_ms <= facts->latest_ms) && fathom_dyp_are_valid(facts) &&
           (fathom_stream_start(stream, clock_us(trigger->clock)) == FATHOM_OK);
}

fathom_status_t fathom_a16_controlled_init(fathom_a16_controlled_t *sensor, fathom_line_t *line,
                                           const fathom_output_t *trigger,
                                           const fathom_a16_controlled_config_t *config)
{
    fathom_status_t status = FATHOM_ERR_ARGUMENT;
    fathom_a16_controlled_config_t zeroed;
    clear(sensor, sizeof *sensor);
    sensor->line = line;
    if (trigger != NULL) sensor->trigger.output = *trigger;
    if (configure(sensor, config_or_zeroed(config, &zeroed, sizeof zeroed))) {
        sensor->stream.listener.receive = receive;
        status = fathom_line_listen(sensor->line, &sensor->stream.listener);
    }
    if (status == FATHOM_OK) status = fathom_trigger_init(&sensor->trigger);
    if (status < 0) {
        stop_listening(sensor);
        clear(sensor, sizeof *sensor);
        return status;
    }
    return FATHOM_OK; /* The trigger is at rest, or will be: FATHOM_PENDING is no error. */
}

fathom_status_t fathom_a16_controlled_deinit(fathom_a16_controlled_t *sensor)
{
    stop_listening(sensor);
    return fathom_trigger_deinit(&sensor->trigger);
}
