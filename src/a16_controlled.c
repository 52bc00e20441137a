/* SPDX-License-Identifier: MIT */
#include "fathom/a16_controlled.h"

enum { AGAIN_US = 1000 };

static uint32_t or_else(uint32_t value, uint32_t otherwise) { return value != 0 ? value : otherwise; }

static uint32_t least(uint32_t a, uint32_t b) { return a < b ? a : b; }

static uint32_t now_us(const fathom_a16_controlled_t *sensor)
{
    const fathom_clock_t *const clock = sensor->line->config->clock;
    return clock->now_us(clock->ctx);
}

/* ---- the trigger ---- */

static fathom_status_t hold(const fathom_a16_controlled_t *sensor, bool low)
{
    const fathom_pin_t *const trigger = sensor->trigger;
    if (trigger == NULL) return fathom_line_break(sensor->line, low);
    trigger->set(trigger->ctx, !low);
    return FATHOM_READY;
}

/* The falling edge. What follows is counted from a look at the clock that comes after it: so the period is never too
 * short, whatever interrupts the two. */
static void begin(fathom_a16_controlled_t *sensor)
{
    sensor->edge_us = now_us(sensor);
    sensor->polled_us = sensor->edge_us;
    sensor->left_us = sensor->period_us;
    sensor->low_left_us = sensor->low_us;
    sensor->answer_left_us = sensor->latest_us;
    sensor->low = true;
    sensor->waiting = true;
    sensor->heard = false;
}

/* The rising edge. Some high time must follow, or the next falling edge could be missed. */
static void release(fathom_a16_controlled_t *sensor)
{
    sensor->low = false;
    if (sensor->left_us < sensor->low_us) sensor->left_us = sensor->low_us;
}

/* Drives the trigger where it is time to. A port that is busy is asked again by the next poll; `over`: it was to have
 * begun by now. The line counts the time for the end. */
static fathom_status_t drive(fathom_a16_controlled_t *sensor, bool over)
{
    const bool was_low = sensor->low;
    if (was_low ? sensor->low_left_us != 0 : sensor->waiting || sensor->left_us != 0) return FATHOM_PENDING;
    const fathom_status_t status = hold(sensor, !was_low);
    if (status == FATHOM_ERR_PORT) return FATHOM_ERR_PORT;
    if (status == FATHOM_READY && was_low) {
        release(sensor);
    } else if (status == FATHOM_READY) {
        begin(sensor);
    } else if (!was_low && sensor->answer_left_us == 0) {
        sensor->answer_left_us = FATHOM_LINE_SEND_US;
        if (over) return FATHOM_ERR_PORT;
    }
    return FATHOM_PENDING;
}

/* ---- the answer ---- */

/* Did what came last, between came_us and time_us, come in time? What came before the edge is far beyond latest_us. */
static bool is_in_time(const fathom_a16_controlled_t *sensor, uint32_t time_us)
{
    return sensor->waiting && fathom_elapsed_us(time_us, sensor->edge_us) >= sensor->earliest_us &&
           fathom_elapsed_us(sensor->came_us, sensor->edge_us) <= sensor->latest_us;
}

static void receive(fathom_listener_t *listener, const uint8_t *bytes, uint8_t count, bool after_gap,
                    uint32_t time_us)
{
    fathom_a16_controlled_t *const sensor = (fathom_a16_controlled_t *)listener;
    /* a port without time stamps: the line says the time of its poll */
    sensor->came_us = time_us == sensor->line->polled_us ? sensor->polled_us : time_us;
    if (is_in_time(sensor, time_us)) sensor->heard = true;
    fathom_stream_feed(&sensor->stream, bytes, count, after_gap, time_us);
}

static fathom_status_t judge(fathom_a16_controlled_t *sensor, const uint8_t *frame, fathom_sample_t *sample)
{
    fathom_dyp_answer_t *const answer = &sensor->answer;
    if (!is_in_time(sensor, sensor->stream.time_us)) {
        if (sensor->late != UINT16_MAX) sensor->late++;
        return FATHOM_PENDING;
    }
    sensor->waiting = false;
    sensor->answer_left_us = 0;
    fathom_dyp_frame_decode(frame, answer->values, 1);
    fathom_dyp_answer(answer, 1, sensor->stream.time_us);
    return fathom_dyp_next(answer, sample);
}

static fathom_status_t poll(void *ctx, fathom_sample_t *sample)
{
    fathom_a16_controlled_t *const sensor = ctx;
    const fathom_status_t port = fathom_line_poll(sensor->line);
    const uint32_t at_us = now_us(sensor);
    const uint32_t passed_us = fathom_elapsed_us(at_us, sensor->polled_us);
    const uint8_t *frame;
    fathom_status_t status = FATHOM_PENDING;
    sensor->polled_us = at_us;
    fathom_run_down(&sensor->left_us, passed_us);
    fathom_run_down(&sensor->low_left_us, passed_us);
    const bool over = sensor->answer_left_us != 0 && fathom_run_down(&sensor->answer_left_us, passed_us);
    if (port < 0) return port;
    /* its deadline means nothing here: who is not asked is silent */
    if (fathom_stream_poll(&sensor->stream, at_us, &frame) == FATHOM_READY)
        status = judge(sensor, frame, sample);
    if (sensor->waiting && sensor->answer_left_us == 0 && !sensor->stream.candidate) {
        sensor->waiting = false;
        status = sensor->heard ? FATHOM_ERR_CHECKSUM : FATHOM_ERR_NO_ANSWER;
    }
    const fathom_status_t trigger = drive(sensor, over);
    return status != FATHOM_PENDING ? status : trigger;
}

static uint32_t due_us(void *ctx)
{
    const fathom_a16_controlled_t *const sensor = ctx;
    const uint32_t at_us = now_us(sensor);
    const uint32_t passed_us = fathom_elapsed_us(at_us, sensor->polled_us);
    uint32_t due = sensor->waiting ? sensor->answer_left_us : sensor->left_us;
    if (sensor->low) due = least(due, sensor->low_left_us);
    if (due == 0) due = AGAIN_US; /* the port was busy, or a frame waits for its end */
    due = due > passed_us ? due - passed_us : 0;
    due = least(due, fathom_line_due_us(sensor->line));
    return least(due, fathom_stream_due_us(&sensor->stream, at_us));
}

/* ---- setting up ---- */

fathom_status_t fathom_a16_controlled_init(fathom_a16_controlled_t *sensor,
                                           const fathom_a16_controlled_config_t *config)
{
    const uint32_t least_us = FATHOM_A16_CONTROLLED_DEFAULT_PERIOD_US;
    fathom_dyp_answer_t *const answer = &sensor->answer;
    sensor->listener.receive = receive;
    sensor->line = config->line;
    sensor->trigger = config->trigger;
    sensor->period_us = config->period_us > least_us ? config->period_us : least_us;
    sensor->earliest_us = or_else(config->earliest_us, FATHOM_A16_CONTROLLED_DEFAULT_EARLIEST_US);
    sensor->latest_us = or_else(config->latest_us, FATHOM_A16_CONTROLLED_DEFAULT_LATEST_US);
    sensor->low_us = (uint16_t)or_else(config->low_us, FATHOM_A16_CONTROLLED_DEFAULT_LOW_US);
    answer->values = sensor->values;
    fathom_dyp_window_copy(&answer->window, &config->window);
    answer->model = FATHOM_A16;
    answer->unit = 0;
    answer->first = 1;
    if (fathom_dyp_answer_init(answer, FATHOM_A16_MAX_MM) < 0 || sensor->line == NULL ||
        sensor->earliest_us > sensor->latest_us)
        return FATHOM_ERR_ARGUMENT;
    if (sensor->trigger == NULL && sensor->line->config->uart->set_break == NULL)
        return FATHOM_ERR_UNSUPPORTED;

    sensor->edge_us = now_us(sensor);
    sensor->polled_us = sensor->edge_us;
    sensor->came_us = sensor->edge_us;
    sensor->left_us = sensor->low_us;
    sensor->low_left_us = 0;
    sensor->answer_left_us = 0;
    sensor->late = 0;
    sensor->low = false;
    sensor->waiting = false;
    sensor->heard = false;
    sensor->stream_config.storage = sensor->storage;
    sensor->stream_config.stale_us = UINT32_MAX;
    sensor->stream_config.gap_us = config->gap_us;
    sensor->stream_config.length = FATHOM_DYP_A16_LENGTH;
    (void)fathom_stream_init(&sensor->stream, &sensor->stream_config, sensor->polled_us);
    sensor->listener.gap_us = sensor->stream.listener.gap_us;
    if (sensor->trigger != NULL) (void)hold(sensor, false);
    fathom_line_listen(sensor->line, &sensor->listener);
    return FATHOM_READY;
}

fathom_status_t fathom_a16_controlled_deinit(fathom_a16_controlled_t *sensor)
{
    const fathom_status_t status = sensor->low ? hold(sensor, false) : FATHOM_READY;
    if (status == FATHOM_READY) sensor->low = false;
    if (sensor->line->listener == &sensor->listener) fathom_line_listen(sensor->line, NULL);
    return status;
}

fathom_sensor_t fathom_a16_controlled_sensor(fathom_a16_controlled_t *sensor)
{
    fathom_sensor_t handle;
    handle.poll = poll;
    handle.due_us = due_us;
    handle.ctx = sensor;
    return handle;
}
