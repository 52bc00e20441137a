/* SPDX-License-Identifier: MIT */
#include "stations/counters.h"

#include <string.h>

/* Those that can end an attempt; the others have no name. */
static const char *const failure_names[FAILURE_KINDS] = {
    [FAILURE_VALUE] = "impossible values", [-FATHOM_ERR_PORT] = "port",
    [-FATHOM_ERR_NO_ANSWER] = "no answer", [-FATHOM_ERR_CHECKSUM] = "damaged",
    [-FATHOM_ERR_EXCEPTION] = "exception", [-FATHOM_ERR_MALFORMED] = "other answer",
    [-FATHOM_ERR_STALE] = "stale",         [FAILURE_KINDS - 1] = "other",
};

const char *tally_failure_name(size_t kind) { return failure_names[kind]; }

static void take(uint16_t *from, uint64_t *attempt, uint64_t *total, size_t count)
{
    for (size_t i = 0; i != count; i++) {
        attempt[i] += from[i];
        total[i] += from[i];
        from[i] = 0;
    }
}

static bool read_port(const port_counts_t *port, channel_t *channel, fathom_posix_line_errors_t *now)
{
    /* Most ports that do not count say so at the first look; a lost one would only say that again. */
    return port->is_there && fathom_posix_line_errors(&channel->port, now) == FATHOM_POSIX_OK;
}

void tally_begin_port(port_counts_t *port, channel_t *channel)
{
    port->is_there = true;
    port->is_there = read_port(port, channel, &port->at);
}

static void take_port(tally_t *tally, port_counts_t *port, channel_t *channel)
{
    fathom_posix_line_errors_t now;
    if (!read_port(port, channel, &now)) return;
    const uint32_t passed[PORT_COUNTERS] = {
        [PORT_PARITY] = now.parity - port->at.parity,
        [PORT_FRAMING] = now.framing - port->at.framing,
        [PORT_OVERRUN] = now.overrun - port->at.overrun,
        [PORT_BREAKS] = now.breaks - port->at.breaks,
    };
    for (size_t i = 0; i != PORT_COUNTERS; i++) {
        tally->attempt.port[i] += passed[i];
        tally->total.port[i] += passed[i];
    }
    port->at = now;
}

void tally_take(tally_t *tally, port_counts_t *port, channel_t *channel, const reader_t *reader)
{
    take(channel->counters, tally->attempt.line, tally->total.line, FATHOM_LINE_COUNTERS);
    if (reader->stream != NULL)
        take(reader->stream->counters, tally->attempt.stream, tally->total.stream, FATHOM_STREAM_COUNTERS);
    if (reader->unit != NULL) {
        take(&reader->unit->answers, tally->attempt.unit + UNIT_ANSWERS, tally->total.unit + UNIT_ANSWERS, 1);
        take(&reader->unit->failures, tally->attempt.unit + UNIT_FAILURES, tally->total.unit + UNIT_FAILURES,
             1);
    }
    take_port(tally, port, channel);
}

void tally_take_late(tally_t *tally, channel_t *channel)
{
    enum { LATE = FATHOM_LINE_LATE_ANSWERS };
    take(&channel->counters[LATE], &tally->attempt.line[LATE], &tally->total.line[LATE], 1);
}

void tally_begin_attempt(tally_t *tally) { memset(&tally->attempt, 0, sizeof tally->attempt); }

void tally_failure(tally_t *tally, fathom_status_t status, const reader_t *reader)
{
    size_t kind = (size_t)-status;
    if (status == FATHOM_ERR_MALFORMED && !reader_was_answered_wrong(reader)) kind = FAILURE_VALUE;
    if (kind >= FAILURE_KINDS || tally_failure_name(kind) == NULL) kind = FAILURE_KINDS - 1;
    tally->failures[kind]++;
}

void tally_time(tally_t *tally, uint32_t took_us)
{
    if (tally->timed++ == 0 || took_us < tally->time_min_us) tally->time_min_us = took_us;
    if (took_us > tally->time_max_us) tally->time_max_us = took_us;
    tally->time_sum_us += took_us;
}

static void add(uint64_t *to, const uint64_t *from, size_t count)
{
    for (size_t i = 0; i != count; i++) to[i] += from[i];
}

void tally_add(tally_t *sum, const tally_t *part)
{
    add(sum->total.line, part->total.line, FATHOM_LINE_COUNTERS);
    add(sum->total.stream, part->total.stream, FATHOM_STREAM_COUNTERS);
    add(sum->total.unit, part->total.unit, UNIT_COUNTERS);
    add(sum->total.port, part->total.port, PORT_COUNTERS);
    add(sum->failures, part->failures, FAILURE_KINDS);
    sum->attempts += part->attempts;
    sum->failed += part->failed;
    sum->readings += part->readings;
    sum->skipped += part->skipped;
    if (part->timed == 0) return;
    if (sum->timed == 0 || part->time_min_us < sum->time_min_us) sum->time_min_us = part->time_min_us;
    if (part->time_max_us > sum->time_max_us) sum->time_max_us = part->time_max_us;
    sum->timed += part->timed;
    sum->time_sum_us += part->time_sum_us;
}
