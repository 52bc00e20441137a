/* SPDX-License-Identifier: MIT */
#include "reading/poll_attempt.h"

uint64_t poll_now_us(const poll_loop_t *loop) { return loop->host->now_us(loop->host->ctx); }

bool poll_is_done(const poll_loop_t *loop, const station_t *station)
{
    const uint32_t count = loop->options.count;
    return count != 0 && station->counters.attempts >= count;
}

bool poll_is_over(const poll_loop_t *loop)
{
    const host_t *const host = loop->host;
    const uint64_t duration_us = loop->options.duration_us;
    return host->has_ended(host->ctx) || host->is_output_gone(host->ctx) || loop->user->is_over(loop->ctx) ||
           loop->ports_left == 0 || (duration_us != 0 && poll_now_us(loop) - loop->start_us >= duration_us);
}

bool poll_is_shared(const poll_port_t *port) { return port->station_count > 1; }

uint32_t poll_backoff_us(const poll_port_t *port)
{
    return poll_is_shared(port) ? READER_BACKOFF_SHARED_US : READER_BACKOFF_US;
}

listener_t *poll_listener_of(poll_port_t *port, station_t *station)
{
    return poll_is_shared(port) ? &station->own_listener : &port->channel.listener;
}

/* ---- what was heard, and of whom ---- */

listener_t *poll_whose(void *ctx)
{
    const poll_port_t *const port = ctx;
    for (station_t *station = port->stations; station != NULL; station = station->next)
        if (reader_has_sent(station->reader, port->channel.line.head)) return station->listener;
    return NULL;
}

/* The one on this line that has this address; NULL: none. */
static station_t *station_at(const poll_port_t *port, uint8_t address)
{
    for (station_t *station = port->stations; station != NULL; station = station->next)
        if (station->address == address) return station;
    return NULL;
}

void poll_take_late(poll_port_t *port)
{
    const channel_t *const channel = &port->channel;
    if (!poll_is_shared(port) || channel->counters[FATHOM_LINE_LATE_RESPONSES] == 0) return;
    for (station_t *station = port->stations; station != NULL; station = station->next) {
        evidence_t evidence;
        if (channel->listener.now != station->listener) continue;
        listener_judge(station->listener, station->address, &evidence);
        station_t *const other = evidence.foreign != 0 ? station_at(port, evidence.foreign_address) : NULL;
        counters_take_late(other != NULL ? &other->counters : &station->counters, &port->channel);
        return;
    }
}

/* Has another sensor of this line answered? */
static bool others_answer(const poll_port_t *port, const station_t *station)
{
    for (const station_t *other = port->stations; other != NULL; other = other->next)
        if (other != station && other->counters.readings != 0) return true;
    return false;
}

/* What others of this line have said late is no evidence of anything else. */
static void judge(const poll_port_t *port, const station_t *station, evidence_t *evidence)
{
    listener_judge(station->listener, station->mode->has_address ? station->address : 0, evidence);
    if (evidence->foreign == 0 || station_at(port, evidence->foreign_address) == NULL) return;
    evidence->foreign = 0;
    if (evidence->rest == 0 && evidence->own == 0) evidence->bytes = 0;
}

/* ---- attempts ---- */

/* Does more than one probe of this sensor speak? */
static bool has_probes(const station_t *station)
{
    const uint8_t probes = station->settings.probes;
    return station->model->probes > 1 && (probes == 0 || (probes & (probes - 1)) != 0);
}

/* How the attempt has gone so far. */
typedef struct {
    fathom_status_t status;
    bool is_first; /* of the attempt's outcomes */
    bool is_told;
} outcome_t;

static void report_failure(poll_port_t *port, station_t *station, const outcome_t *outcome)
{
    const poll_loop_t *const loop = port->loop;
    failure_t failure = {
        .status = outcome->status,
        .model = station->model,
        .mode = station->mode,
        .reader = station->reader,
        .channel = &port->channel,
        .counters = &station->counters,
        .line = &station->line,
        .shared = loop->options.station_count > 1 ? station->name : NULL,
        .noises = station->pulses.attempt_noises,
        .address = station->address,
        .others_answer = others_answer(port, station),
        .waits = port->waits,
        .is_whole = outcome->is_first && !reader_has_more(station->reader) && has_probes(station),
        .is_told = outcome->is_told,
    };
    counters_failure(&station->counters, outcome->status, station->reader);
    judge(port, station, &failure.evidence);
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
    station->next_us += station->settings.period_us;
    if (station->next_us < now) station->next_us = now; /* what is late is not made up for */
    poll_begin_attempt(station);
}

/*
 * A sensor that sends by itself does not keep the user's interval: what comes between two attempts is dropped,
 * a whole response at a time. The driver of a sensor that is asked keeps the interval itself.
 */
static bool is_early(const poll_loop_t *loop, station_t *station, fathom_status_t status)
{
    if (!mode_is_automatic(station->mode) || station->answering) return false;
    const bool is_first = !station->skipping;
    if (is_first) station->skipping = poll_now_us(loop) < station->next_us;
    if (!station->skipping) return false;
    const bool is_late = status == FATHOM_ERR_STALE || status == FATHOM_ERR_CHECKSUM;
    if (is_first && !is_late) station->counters.skipped++;
    station->skipping = reader_has_more(station->reader);
    poll_begin_attempt(station);
    return true;
}

void poll_take_outcome(poll_port_t *port, station_t *station, fathom_status_t status,
                       const fathom_sample_t *sample)
{
    const poll_loop_t *const loop = port->loop;
    const reader_counters_t counted =
        counters_take(&station->counters, &port->counts, &port->channel, station->reader);
    if (station->mode->has_pulses)
        pulses_take(&station->pulses, &counted, status == FATHOM_OK ? sample : NULL);
    if (status != FATHOM_ERR_PORT && is_early(loop, station, status)) return;
    if (status == FATHOM_OK && mode_is_asked(station->mode) && !station->answering)
        counters_time(&station->counters, fathom_elapsed_us(sample->time_us, station->listener->asked_us));
    const outcome_t outcome = {.status = status, .is_first = !station->answering};
    station->answering = true;
    if (status == FATHOM_OK) {
        if (loop->user->reading(loop->ctx, station, sample)) station->counters.readings++;
        if (sample->kind != FATHOM_UNKNOWN) station->has_good = true;
    } else {
        report_failure(port, station, &outcome);
    }
    if (status == FATHOM_ERR_PORT || !reader_has_more(station->reader)) end_attempt(loop, station);
}

void poll_take_loss(poll_port_t *port, station_t *station, bool is_told)
{
    const outcome_t outcome = {.status = FATHOM_ERR_PORT, .is_told = is_told};
    (void)counters_take(&station->counters, &port->counts, &port->channel, station->reader);
    report_failure(port, station, &outcome);
    end_attempt(port->loop, station);
}
