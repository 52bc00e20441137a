/* SPDX-License-Identifier: MIT */
#include "diagnosis/counters.h"

#include <string.h>

#include "fathom/processing/alarm.h"

/* ---- words ---- */

/* First the kinds of a sample, then the failures that can end an attempt. */
enum { KIND_NEAR = FATHOM_UNKNOWN + 1, KINDS, WORDS = KINDS + FAILURE_KINDS };
static const struct {
    const char *name;
    const char *what;
} words[WORDS] = {
    [FATHOM_TARGET] = {"target", "There is a distance"},
    [FATHOM_NO_TARGET] = {"no_target", "Nothing is in range"},
    [FATHOM_NEAR] = {"too_near", "A target is nearer than the sensor can measure"},
    [KIND_NEAR] = {"near", "A target is nearer than the threshold (switch, relay)"}, /* of a contact */
    [FATHOM_FAR] = {"far", "No target is nearer than the threshold (switch, relay)"},
    [FATHOM_UNKNOWN] = {"unknown", "No known meaning (--means), or all pulses are too short"},
    [FATHOM_FAULT] = {"fault", "The sensor reports a fault"},
#define FAILURE(kind) [KINDS + (kind)]
    FAILURE(FAILURE_VALUE) = {"impossible_values", "No distance, or refused by --window or --means"},
    FAILURE(-FATHOM_ERR_PORT) = {"port", "The port is lost, or the program waits for it"},
    FAILURE(-FATHOM_ERR_NO_RESPONSE) = {"no_response", "The sensor did not respond within --timeout"},
    FAILURE(-FATHOM_ERR_CHECKSUM) = {"damaged", "The bytes have a wrong checksum, or form no frame"},
    FAILURE(-FATHOM_ERR_EXCEPTION) = {"exception", "The sensor refused the request by a Modbus exception"},
    FAILURE(-FATHOM_ERR_MALFORMED) = {"other_response", "The response does not fit the request"},
    FAILURE(-FATHOM_ERR_STALE) = {"stale", "No frame arrived within --timeout (without requests)"},
    FAILURE(-FATHOM_ERR_LINE_BUSY) = {"line_busy", "The line was never silent; no request could be sent"},
    FAILURE(-FATHOM_ERR_OTHER_MASTER) = {"other_master", "Another master sent requests to this sensor"},
    FAILURE(FAILURE_KINDS - 1) = {"other", "Any other failure"},
};

const char *status_word(const model_mode_t *mode, uint8_t kind)
{
    return words[kind == FATHOM_NEAR && mode->is_contact ? KIND_NEAR : kind].name;
}

const char *status_word_of_failure(size_t kind) { return words[KINDS + kind].name; }

const char *alarm_word(uint8_t state)
{
    static const char *const names[] = {[FATHOM_ALARM_ON] = "on",
                                        [FATHOM_ALARM_OFF] = "off",
                                        [FATHOM_ALARM_UNKNOWN] = "unknown",
                                        [FATHOM_ALARM_NO_RESPONSE] = "no_response"};
    return names[state];
}

void status_words_help(FILE *to)
{
    for (size_t i = 0; i != WORDS; i++)
        if (words[i].name != NULL) (void)fprintf(to, "  %-17s %s\n", words[i].name, words[i].what);
}

/* ---- counters ---- */

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
