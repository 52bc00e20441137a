/* SPDX-License-Identifier: MIT */
#include "diagnosis/counters.h"

#include <string.h>

static void take(uint16_t *from, uint64_t *attempt, uint64_t *total, size_t count)
{
    for (size_t i = 0; i != count; i++) {
        attempt[i] += from[i];
        total[i] += from[i];
        from[i] = 0;
    }
}

static bool read_port(const port_counts_t *counts, port_t *port, fathom_posix_line_errors_t *now)
{
    /* Most ports that do not count say so at the first look; a lost one would only say that again. */
    return counts->is_there && port->kind == PORT_SERIAL &&
           fathom_posix_line_errors(&port->serial, now) == FATHOM_POSIX_OK;
}

void counters_begin_port(port_counts_t *counts, port_t *port)
{
    counts->is_there = true;
    counts->is_there = read_port(counts, port, &counts->at);
}

static void take_port(counters_t *counters, port_counts_t *counts, port_t *port)
{
    fathom_posix_line_errors_t now;
    if (!read_port(counts, port, &now)) return;
    const uint32_t passed[PORT_COUNTERS] = {
        [PORT_PARITY] = now.parity - counts->at.parity,
        [PORT_FRAMING] = now.framing - counts->at.framing,
        [PORT_OVERRUN] = now.overrun - counts->at.overrun,
        [PORT_BREAKS] = now.breaks - counts->at.breaks,
    };
    for (size_t i = 0; i != PORT_COUNTERS; i++) {
        counters->attempt.port[i] += passed[i];
        counters->total.port[i] += passed[i];
    }
    counts->at = now;
}

reader_counters_t counters_take(counters_t *counters, port_counts_t *counts, port_t *port, reader_t *reader)
{
    reader_counters_t counted;
    reader_take_counters(reader, &counted);
    uint16_t unit[UNIT_COUNTERS] = {[UNIT_RESPONSES] = counted.responses, [UNIT_FAILURES] = counted.failures};
    take(port->counters, counters->attempt.line, counters->total.line, FATHOM_LINE_COUNTERS);
    take(counted.stream, counters->attempt.stream, counters->total.stream, FATHOM_STREAM_COUNTERS);
    take(unit, counters->attempt.unit, counters->total.unit, UNIT_COUNTERS);
    take_port(counters, counts, port);
    return counted;
}

void counters_take_late(counters_t *counters, port_t *port)
{
    enum { LATE = FATHOM_LINE_LATE_RESPONSES };
    take(&port->counters[LATE], &counters->attempt.line[LATE], &counters->total.line[LATE], 1);
}

void counters_begin_attempt(counters_t *counters) { memset(&counters->attempt, 0, sizeof counters->attempt); }

size_t counters_failure_kind(fathom_status_t status, const reader_t *reader)
{
    const size_t kind = (size_t)-status;
    if (status == FATHOM_ERR_MALFORMED && !reader_facts(reader).is_unexpected) return FAILURE_VALUE;
    return kind >= FAILURE_KINDS || status_word_of_failure(kind) == NULL ? FAILURE_KINDS - 1 : kind;
}

void counters_failure(counters_t *counters, fathom_status_t status, const reader_t *reader)
{
    counters->failures[counters_failure_kind(status, reader)]++;
}

void counters_time(counters_t *counters, uint32_t took_us)
{
    if (counters->timed++ == 0 || took_us < counters->time_min_us) counters->time_min_us = took_us;
    if (took_us > counters->time_max_us) counters->time_max_us = took_us;
    counters->time_sum_us += took_us;
}

static void add(uint64_t *to, const uint64_t *from, size_t count)
{
    for (size_t i = 0; i != count; i++) to[i] += from[i];
}

void counters_add(counters_t *sum, const counters_t *part)
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
