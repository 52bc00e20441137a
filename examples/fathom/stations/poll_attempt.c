/* SPDX-License-Identifier: MIT */
#include "stations/poll_attempt.h"

uint64_t poll_now_us(const poll_loop_t *loop) { return loop->host->now_us(loop->host->ctx); }

bool poll_is_done(const poll_loop_t *loop, const station_t *station)
{
    const uint32_t count = loop->options.count;
    return count != 0 && station->counters.attempts >= count;
}

bool poll_is_shared(const poll_loop_t *loop) { return loop->options.station_count > 1; }

station_t *poll_end(poll_loop_t *loop) { return loop->options.stations + loop->options.station_count; }

/* ---- what was heard, and of whom ---- */

listener_t *poll_whose(void *ctx)
{
    poll_loop_t *const loop = ctx;
    for (station_t *station = loop->options.stations; station != poll_end(loop); station++)
        if (loop->channel.line.head == &station->reader.unit->request.transaction) return station->listener;
    return NULL;
}

/* The one on this line that has this address; NULL: none. */
static station_t *station_at(poll_loop_t *loop, uint8_t address)
{
    for (station_t *station = loop->options.stations; station != poll_end(loop); station++)
        if (station->address == address) return station;
    return NULL;
}

void poll_take_late(poll_loop_t *loop)
{
    const channel_t *const channel = &loop->channel;
    if (!poll_is_shared(loop) || channel->counters[FATHOM_LINE_LATE_RESPONSES] == 0) return;
    for (station_t *station = loop->options.stations; station != poll_end(loop); station++) {
        evidence_t evidence;
        if (channel->listener.now != station->listener) continue;
        listener_judge(station->listener, station->address, &evidence);
        station_t *const other = evidence.foreign != 0 ? station_at(loop, evidence.foreign_address) : NULL;
        counters_take_late(other != NULL ? &other->counters : &station->counters, &loop->channel);
        return;
    }
}

/* Has another sensor of this line answered? */
static bool others_answer(const poll_loop_t *loop, const station_t *station)
{
    const sensor_options_t *const options = &loop->options;
    for (size_t i = 0; i != options->station_count; i++)
        if (&options->stations[i] != station && options->stations[i].counters.readings != 0) return true;
    return false;
}

/* What others of this line have said late is no evidence of anything else. */
static void judge(poll_loop_t *loop, const station_t *station, evidence_t *evidence)
{
    listener_judge(station->listener, station->mode->has_address ? station->address : 0, evidence);
    if (evidence->foreign == 0 || station_at(loop, evidence->foreign_address) == NULL) return;
    evidence->foreign = 0;
    if (evidence->rest == 0 && evidence->own == 0) evidence->bytes = 0;
}

/* ---- attempts ---- */

/* Is there anything to wait for when the port is lost? */
static bool has_more_to_do(const poll_loop_t *loop, const station_t *station)
{
    const sensor_options_t *const options = &loop->options;
    if (options->count == 0 || station->counters.attempts + 1 < options->count) return true;
    for (size_t i = 0; i != options->station_count; i++)
        if (&options->stations[i] != station && !poll_is_done(loop, &options->stations[i])) return true;
    return false;
}

/* Does more than one probe of this sensor speak? */
static bool has_probes(const poll_loop_t *loop, const station_t *station)
{
    const uint8_t probes = loop->options.reading.probes;
    return station->model->probes > 1 && (probes == 0 || (probes & (probes - 1)) != 0);
}

static void report_failure(poll_loop_t *loop, station_t *station, fathom_status_t status, bool is_first)
{
    failure_t failure = {
        .status = status,
        .model = station->model,
        .reader = &station->reader,
        .channel = &loop->channel,
        .counters = &station->counters,
        .line = &station->line,
        .shared = poll_is_shared(loop) ? station->name : NULL,
        .address = station->address,
        .has_address = station->mode->has_address,
        .others_answer = others_answer(loop, station),
        .waits = loop->options.reconnect && has_more_to_do(loop, station),
        .is_whole = is_first && !reader_has_more(&station->reader) && has_probes(loop, station),
    };
    counters_failure(&station->counters, status, &station->reader);
    judge(loop, station, &failure.evidence);
    station->has_failed = true;
    loop->user->failure(loop->ctx, &failure, station);
}

void poll_begin_attempt(station_t *station)
{
    counters_begin_attempt(&station->counters);
    listener_forget(station->listener);
}

static void end_attempt(const poll_loop_t *loop, station_t *station)
{
    const uint64_t now = poll_now_us(loop);
    station->counters.attempts++;
    if (station->has_failed) station->counters.failed++;
    station->has_failed = false;
    station->answering = false;
    station->next_us += loop->options.interval_us;
    if (station->next_us < now) station->next_us = now; /* what is late is not made up for */
    poll_begin_attempt(station);
}

/*
 * A sensor that sends by itself does not keep the user's interval: what comes between two attempts is dropped,
 * a whole response at a time. The driver of a sensor that is asked keeps the interval itself.
 */
static bool is_early(const poll_loop_t *loop, station_t *station, fathom_status_t status)
{
    if (station->reader.is_paced || station->answering) return false;
    const bool is_first = !station->skipping;
    if (is_first) station->skipping = poll_now_us(loop) < station->next_us;
    if (!station->skipping) return false;
    if (is_first && status != FATHOM_ERR_STALE) station->counters.skipped++;
    station->skipping = reader_has_more(&station->reader);
    poll_begin_attempt(station);
    return true;
}

void poll_take_outcome(poll_loop_t *loop, station_t *station, fathom_status_t status,
                       const fathom_sample_t *sample)
{
    counters_take(&station->counters, &loop->port_counts, &loop->channel, &station->reader);
    if (status != FATHOM_ERR_PORT && is_early(loop, station, status)) return;
    if (status == FATHOM_READY && station->reader.unit != NULL && !station->answering)
        counters_time(&station->counters, fathom_elapsed_us(sample->time_us, station->listener->asked_us));
    const bool is_first = !station->answering;
    station->answering = true;
    if (status == FATHOM_READY) {
        if (loop->user->reading(loop->ctx, station, sample)) station->counters.readings++;
        if (sample->kind != FATHOM_UNKNOWN) station->has_good = true;
    } else {
        report_failure(loop, station, status, is_first);
    }
    if (status == FATHOM_ERR_PORT || !reader_has_more(&station->reader)) end_attempt(loop, station);
}
