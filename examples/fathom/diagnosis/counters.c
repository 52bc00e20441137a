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

static void add(uint64_t *to, const uint64_t *from, size_t size)
{
    for (size_t i = 0; i != size / sizeof *to; i++) to[i] += from[i];
}

static void take(uint16_t *from, uint64_t *to, size_t count)
{
    for (size_t i = 0; i != count; i++) to[i] = from[i];
    memset(from, 0, count * sizeof *from);
}

static void take_port(port_t *port, uint64_t *to)
{
    fathom_posix_line_errors_t now;
    const fathom_posix_line_errors_t *const before = &port->errors;
    if (!port->counts_errors || fathom_posix_line_errors(&port->serial, &now) != FATHOM_POSIX_OK) return;
    to[PORT_PARITY] = now.parity - before->parity; /* which may wrap */
    to[PORT_FRAMING] = now.framing - before->framing;
    to[PORT_OVERRUN] = now.overrun - before->overrun;
    to[PORT_BREAKS] = now.breaks - before->breaks;
    port->errors = now;
}

reader_counters_t counters_take(counters_t *counters, port_t *port, reader_t *reader)
{
    reader_counters_t counted;
    reader_take_counters(reader, &counted);
    counts_t counts = {.unit = {[UNIT_RESPONSES] = counted.responses, [UNIT_FAILURES] = counted.failures}};
    take(port->counters, counts.line, FATHOM_LINE_COUNTERS);
    take(counted.stream, counts.stream, FATHOM_STREAM_COUNTERS);
    take_port(port, counts.port);
    add((uint64_t *)&counters->attempt, (const uint64_t *)&counts, sizeof counts);
    add((uint64_t *)&counters->total, (const uint64_t *)&counts, sizeof counts);
    return counted;
}

void counters_take_late(counters_t *counters, port_t *port)
{
    enum { LATE = FATHOM_LINE_LATE_RESPONSES };
    counters->attempt.line[LATE] += port->counters[LATE];
    counters->total.line[LATE] += port->counters[LATE];
    port->counters[LATE] = 0;
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

/* A block is bad with 3 damaged frames of 50. Two bad blocks in a row with 12 damaged frames are reported, or four with 3
 * each: if 2 in 100 frames are damaged at random, that takes days at ten frames a second. A burst is in one block. */
unsigned counters_take_damage(counters_t *counters)
{
    enum { BLOCK = 50, BAD = 3, LEAST_BLOCKS = 2, LEAST_DAMAGED = 12, GOOD_BLOCKS = 12 };
    damage_t *const damage = &counters->damage;
    const uint64_t *const stream = counters->total.stream;
    const uint32_t damaged = (uint32_t)(stream[FATHOM_STREAM_DAMAGED] - damage->damaged);
    const uint32_t frames = (uint32_t)(stream[FATHOM_STREAM_FRAMES] - damage->frames) + damaged;
    if (frames < BLOCK || counters->readings == 0) return 0;
    damage->damaged = stream[FATHOM_STREAM_DAMAGED];
    damage->frames = stream[FATHOM_STREAM_FRAMES];
    if (damaged * BLOCK < BAD * frames) {
        damage->bad_blocks = 0;
        damage->bad_frames = damage->bad_damaged = 0;
        if (damage->good_blocks != GOOD_BLOCKS && ++damage->good_blocks == GOOD_BLOCKS) damage->reported = 0;
        return 0;
    }
    damage->good_blocks = 0;
    damage->bad_frames += frames;
    damage->bad_damaged += damaged;
    if (++damage->bad_blocks < LEAST_BLOCKS || damage->bad_damaged < LEAST_DAMAGED) return 0;
    const uint8_t share = (uint8_t)((uint64_t)damage->bad_damaged * 100 / damage->bad_frames);
    damage->bad_blocks = 0;
    damage->bad_frames = damage->bad_damaged = 0;
    if (share < 2 * damage->reported) return 0;
    damage->reported = share;
    return share;
}

void counters_add(counters_t *sum, const counters_t *part)
{
    const bool is_first = sum->timed == 0;
    add((uint64_t *)&sum->total, (const uint64_t *)&part->total,
        offsetof(counters_t, time_min_us) - offsetof(counters_t, total));
    if (part->timed == 0) return;
    if (is_first || part->time_min_us < sum->time_min_us) sum->time_min_us = part->time_min_us;
    if (part->time_max_us > sum->time_max_us) sum->time_max_us = part->time_max_us;
}
