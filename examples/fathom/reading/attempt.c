/* SPDX-License-Identifier: MIT */
#include "reading/attempt.h"

#include <stdlib.h>

#include "diagnosis/status_word.h"

bool attempt_was_last(const loop_t *loop, const sensor_t *sensor)
{
    const uint32_t count = loop->site.count;
    return count != 0 && sensor->counters.attempts >= count;
}

static bool is_shared(const line_t *line) { return line->settings.station_count > 1; }

uint32_t attempt_backoff_us(const line_t *line)
{
    return is_shared(line) ? READER_BACKOFF_SHARED_US : READER_BACKOFF_US;
}

listener_t *attempt_listener(line_t *line, sensor_t *sensor)
{
    if (is_shared(line) && sensor->own_listener == NULL)
        sensor->own_listener = calloc(1, sizeof *sensor->own_listener);
    return sensor->own_listener != NULL ? sensor->own_listener : &line->port.listener;
}

/* ---- what was received, and from whom ---- */

listener_t *attempt_whose(void *ctx)
{
    const line_t *const line = ctx;
    if (!is_shared(line)) return NULL;
    for (sensor_t *sensor = line->sensors; sensor != NULL; sensor = sensor->next)
        if (reader_has_sent(sensor->reader, line->port.line.head)) return sensor->listener;
    return NULL;
}

/* The sensor with this address on the line; NULL: none. */
static sensor_t *sensor_at(const line_t *line, uint8_t address)
{
    for (sensor_t *sensor = line->sensors; sensor != NULL; sensor = sensor->next)
        if (sensor->address == address) return sensor;
    return NULL;
}

void attempt_count_late(line_t *line)
{
    const port_t *const port = &line->port;
    if (!is_shared(line) || port->counters[FATHOM_LINE_LATE_RESPONSES] == 0) return;
    for (sensor_t *sensor = line->sensors; sensor != NULL; sensor = sensor->next) {
        evidence_t evidence;
        if (port->listener.now != sensor->listener) continue;
        listener_judge(sensor->listener, sensor->address, &evidence);
        sensor_t *const other = evidence.foreign != 0 ? sensor_at(line, evidence.foreign_address) : NULL;
        counters_take_late(other != NULL ? &other->counters : &sensor->counters, &line->port);
        return;
    }
}

/* Returns true if another sensor on this line gave a reading. */
static bool others_answer(const line_t *line, const sensor_t *sensor)
{
    for (const sensor_t *other = line->sensors; other != NULL; other = other->next)
        if (other != sensor && other->counters.readings != 0) return true;
    return false;
}

/* A late response of another sensor that is read on this line is no evidence of a stranger. */
static void judge(const line_t *line, const sensor_t *sensor, evidence_t *evidence)
{
    listener_judge(sensor->listener, sensor->mode->has_address ? sensor->address : 0, evidence);
    if (evidence->foreign == 0 || sensor_at(line, evidence->foreign_address) == NULL) return;
    evidence->foreign = 0;
    if (evidence->rest == 0 && evidence->own == 0) evidence->bytes = 0;
}

/* ---- reports ---- */

static void report(void *ctx, sensor_t *sensor, const result_t *result)
{
    const loop_t *const loop = ctx;
    const uint64_t time_us = loop_sample_us(loop, result->sample.time_us);
    const reading_t reading = {.sensor = sensor,
                               .status = FATHOM_OK,
                               .result = result,
                               .time_us = time_us,
                               .utc_us = loop_utc_us(loop, time_us)};
    loop->sink->reading(loop->ctx, &reading);
}

results_to_t attempt_results(loop_t *loop) { return (results_to_t){report, loop}; }

/* probe: 0 if the failure is not of one alone. */
static void report_failure(loop_t *loop, sensor_t *sensor, const failure_t *failure, size_t kind,
                           uint8_t probe)
{
    const result_t result = {.sample = {.time_us = (uint32_t)loop_now_us(loop),
                                        .kind = FATHOM_UNKNOWN,
                                        .address = sensor->address,
                                        .probe = sensor->model->probes == 1 ? 1 : probe}};
    const uint64_t time_us = loop_sample_us(loop, result.sample.time_us);
    const reading_t reading = {.sensor = sensor,
                               .status = failure != NULL ? failure->status : FATHOM_ERR_PORT,
                               .failure = status_word_of_failure(kind),
                               .evidence = failure,
                               .result = &result,
                               .time_us = time_us,
                               .utc_us = loop_utc_us(loop, time_us)};
    loop->sink->reading(loop->ctx, &reading);
}

void attempt_absent(line_t *line, sensor_t *sensor)
{
    report_failure(line->loop, sensor, NULL, (size_t)-FATHOM_ERR_PORT, 0);
}

/* ---- attempts ---- */

/* Returns true if the sensor delivers more than one probe. */
static bool has_probes(const sensor_t *sensor)
{
    const uint8_t probes = sensor->settings.probes;
    return sensor->model->probes > 1 && (probes == 0 || (probes & (probes - 1)) != 0);
}

/* is_first: of the outcomes of this attempt. */
static void fail(line_t *line, sensor_t *sensor, fathom_status_t status, bool is_first, bool is_known)
{
    loop_t *const loop = line->loop;
    const results_to_t to = attempt_results(loop);
    const size_t kind = counters_failure_kind(status, sensor->reader);
    failure_t failure = {
        .status = status,
        .model = sensor->model,
        .mode = sensor->mode,
        .reader = sensor->reader,
        .port = &line->port,
        .counters = &sensor->counters,
        .line = &sensor->line,
        .shared = loop->site.sensor_count > 1 ? sensor->name : NULL,
        .noises = sensor->pulses.attempt_noises,
        .address = sensor->address,
        .others_answer = others_answer(line, sensor),
        .waits = line->waits,
        .is_whole = is_first && !reader_has_more(sensor->reader) && has_probes(sensor),
        .is_told = is_known,
    };
    counters_failure(&sensor->counters, status, sensor->reader);
    judge(line, sensor, &failure.evidence);
    sensor->has_failed = true;
    report_failure(loop, sensor, &failure, kind,
                   status == FATHOM_ERR_MALFORMED ? reader_facts(sensor->reader).refused_probe : 0);
    results_failure(sensor, status, (uint32_t)loop_now_us(loop), &to);
}

void attempt_start(sensor_t *sensor)
{
    counters_begin_attempt(&sensor->counters);
    listener_forget(sensor->listener);
}

static void end(const loop_t *loop, sensor_t *sensor)
{
    const uint64_t now_us = loop_now_us(loop);
    sensor->counters.attempts++;
    if (sensor->has_failed) sensor->counters.failed++;
    sensor->has_failed = false;
    sensor->answering = false;
    sensor->next_us += sensor->settings.period_us;
    if (sensor->next_us < now_us) sensor->next_us = now_us; /* no attempts in a burst after a delay */
    attempt_start(sensor);
}

/*
 * A sensor that sends by itself does not keep the user's interval: the responses between two attempts are dropped as a
 * whole. The driver of a sensor that is asked keeps the interval itself.
 */
static bool is_early(const loop_t *loop, sensor_t *sensor, fathom_status_t status)
{
    if (!mode_is_automatic(sensor->mode) || sensor->answering) return false;
    const bool is_first = !sensor->skipping;
    if (is_first) sensor->skipping = loop_now_us(loop) < sensor->next_us;
    if (!sensor->skipping) return false;
    const bool is_late = status == FATHOM_ERR_STALE || status == FATHOM_ERR_CHECKSUM;
    if (is_first && !is_late) sensor->counters.skipped++;
    sensor->skipping = reader_has_more(sensor->reader);
    attempt_start(sensor);
    return true;
}

static void succeed(loop_t *loop, sensor_t *sensor, const fathom_sample_t *sample)
{
    const results_to_t to = attempt_results(loop);
    results_sample(sensor, sample, &to);
    sensor->counters.readings++;
    if (sample->kind != FATHOM_UNKNOWN) sensor->has_good = true;
}

void attempt_outcome(line_t *line, sensor_t *sensor, fathom_status_t status, const fathom_sample_t *sample)
{
    loop_t *const loop = line->loop;
    const reader_counters_t counted =
        counters_take(&sensor->counters, &line->counts, &line->port, sensor->reader);
    if (sensor->mode->has_pulses) pulses_add(&sensor->pulses, &counted, status == FATHOM_OK ? sample : NULL);
    if (status != FATHOM_ERR_PORT && is_early(loop, sensor, status)) return;
    if (status == FATHOM_OK && mode_is_asked(sensor->mode) && !sensor->answering)
        counters_time(&sensor->counters, fathom_elapsed_us(sample->time_us, sensor->listener->asked_us));
    const bool is_first = !sensor->answering;
    sensor->answering = true;
    if (status == FATHOM_OK)
        succeed(loop, sensor, sample);
    else
        fail(line, sensor, status, is_first, false);
    if (status == FATHOM_ERR_PORT || !reader_has_more(sensor->reader)) end(loop, sensor);
}

void attempt_lost(line_t *line, sensor_t *sensor, bool is_known)
{
    (void)counters_take(&sensor->counters, &line->counts, &line->port, sensor->reader);
    fail(line, sensor, FATHOM_ERR_PORT, false, is_known);
    end(line->loop, sensor);
}
