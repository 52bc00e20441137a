/* SPDX-License-Identifier: MIT */
#include "tally.h"

#include <inttypes.h>
#include <string.h>

/* Also the members of the JSON object, with underscores for spaces. */
static const char *const line_names[FATHOM_LINE_COUNTERS] = {
    [FATHOM_LINE_ANSWERS] = "answers",
    [FATHOM_LINE_DROPPED_BYTES] = "bytes of no frame",
    [FATHOM_LINE_PORT_ERRORS] = "port errors",
    [FATHOM_LINE_NO_ANSWERS] = "requests without an answer",
    [FATHOM_LINE_CHECKSUM_ERRORS] = "damaged answers",
    [FATHOM_LINE_EXCEPTIONS] = "exceptions",
    [FATHOM_LINE_MALFORMED] = "answers that do not fit",
    [FATHOM_LINE_LATE_ANSWERS] = "late answers",
    [FATHOM_LINE_STRAYS] = "frames that nobody asked for",
    [FATHOM_LINE_BAD_BYTES] = "bad bytes",
};

static const char *const stream_names[FATHOM_STREAM_COUNTERS] = {
    [FATHOM_STREAM_FRAMES] = "frames",
    [FATHOM_STREAM_MISSED] = "missed frames",
    [FATHOM_STREAM_AMBIGUOUS] = "ambiguous frames",
    [FATHOM_STREAM_UNSURE] = "unsure frames",
    [FATHOM_STREAM_STALES] = "stale",
    [FATHOM_STREAM_BYTES] = "bytes",
};

static const char *const unit_names[UNIT_COUNTERS] = {
    [UNIT_ANSWERS] = "answers",
    [UNIT_FAILURES] = "failures",
};

static const char *const port_names[PORT_COUNTERS] = {
    [PORT_PARITY] = "parity errors",
    [PORT_FRAMING] = "framing errors",
    [PORT_OVERRUN] = "overruns",
    [PORT_BREAKS] = "breaks",
};

/* Those that can end an attempt; the others have no name. */
static const char *const failure_names[FAILURE_KINDS] = {
    [FAILURE_VALUE] = "impossible values", [-FATHOM_ERR_PORT] = "port",
    [-FATHOM_ERR_NO_ANSWER] = "no answer", [-FATHOM_ERR_CHECKSUM] = "damaged",
    [-FATHOM_ERR_EXCEPTION] = "exception", [-FATHOM_ERR_MALFORMED] = "other answer",
    [-FATHOM_ERR_STALE] = "stale",         [FAILURE_KINDS - 1] = "other",
};

static void take(uint16_t *from, uint64_t *attempt, uint64_t *total, size_t count)
{
    for (size_t i = 0; i != count; i++) {
        attempt[i] += from[i];
        total[i] += from[i];
        from[i] = 0;
    }
}

static bool read_port(tally_t *tally, channel_t *channel, fathom_posix_line_errors_t *now)
{
    /* Most ports that do not count say so at the first look; a lost one would only say that again. */
    return tally->has_port && fathom_posix_line_errors(&channel->port, now) == FATHOM_POSIX_OK;
}

void tally_begin_port(tally_t *tally, channel_t *channel)
{
    tally->has_port = true;
    tally->has_port = read_port(tally, channel, &tally->port_at);
}

static void take_port(tally_t *tally, channel_t *channel)
{
    fathom_posix_line_errors_t now;
    if (!read_port(tally, channel, &now)) return;
    const uint32_t passed[PORT_COUNTERS] = {
        [PORT_PARITY] = now.parity - tally->port_at.parity,
        [PORT_FRAMING] = now.framing - tally->port_at.framing,
        [PORT_OVERRUN] = now.overrun - tally->port_at.overrun,
        [PORT_BREAKS] = now.breaks - tally->port_at.breaks,
    };
    for (size_t i = 0; i != PORT_COUNTERS; i++) {
        tally->attempt.port[i] += passed[i];
        tally->total.port[i] += passed[i];
    }
    tally->port_at = now;
}

void tally_take(tally_t *tally, channel_t *channel, const reader_t *reader)
{
    take(channel->line.counters, tally->attempt.line, tally->total.line, FATHOM_LINE_COUNTERS);
    if (reader->stream != NULL)
        take(reader->stream->counters, tally->attempt.stream, tally->total.stream, FATHOM_STREAM_COUNTERS);
    if (reader->unit != NULL) {
        take(&reader->unit->answers, tally->attempt.unit + UNIT_ANSWERS, tally->total.unit + UNIT_ANSWERS, 1);
        take(&reader->unit->failures, tally->attempt.unit + UNIT_FAILURES, tally->total.unit + UNIT_FAILURES,
             1);
    }
    take_port(tally, channel);
}

void tally_begin_attempt(tally_t *tally) { memset(&tally->attempt, 0, sizeof tally->attempt); }

void tally_failure(tally_t *tally, fathom_status_t status, const reader_t *reader)
{
    size_t kind = (size_t)-status;
    if (status == FATHOM_ERR_MALFORMED && !reader_was_answered_wrong(reader)) kind = FAILURE_VALUE;
    if (kind >= FAILURE_KINDS || failure_names[kind] == NULL) kind = FAILURE_KINDS - 1;
    tally->failures[kind]++;
}

void tally_time(tally_t *tally, uint32_t took_us)
{
    if (tally->timed++ == 0 || took_us < tally->time_min_us) tally->time_min_us = took_us;
    if (took_us > tally->time_max_us) tally->time_max_us = took_us;
    tally->time_sum_us += took_us;
}

/* ---- what is told of it ---- */

enum { GROUPS = 5 };

typedef struct {
    const char *name;
    const char *const *names;
    const uint64_t *counts;
    size_t count;
    bool is_there; /* it means something for this sensor and port */
} group_t;

static void get_groups(group_t groups[GROUPS], const tally_t *tally, bool is_asked)
{
    const counts_t *const total = &tally->total;
    const group_t all[GROUPS] = {
        {"failures", failure_names, tally->failures, FAILURE_KINDS, true},
        {"line", line_names, total->line, FATHOM_LINE_COUNTERS, true},
        {"stream", stream_names, total->stream, FATHOM_STREAM_COUNTERS, !is_asked},
        {"unit", unit_names, total->unit, UNIT_COUNTERS, is_asked},
        {"port", port_names, total->port, PORT_COUNTERS, tally->has_port},
    };
    memcpy(groups, all, sizeof all);
}

static bool print(FILE *to, const uint64_t *counts, const char *const *names, size_t count, bool is_first)
{
    for (size_t i = 0; i != count; i++) {
        if (counts[i] == 0) continue;
        (void)fprintf(to, "%s%s %" PRIu64, is_first ? "fathom: line: " : ", ", names[i], counts[i]);
        is_first = false;
    }
    return is_first;
}

static void print_sums(const tally_t *tally, FILE *to)
{
    (void)fprintf(to, "fathom: attempts %" PRIu64 ", failed %" PRIu64 ", readings %" PRIu64 "\n",
                  tally->attempts, tally->failed, tally->readings);
}

void tally_print(const tally_t *tally, FILE *to)
{
    print_sums(tally, to);
    bool is_empty = print(to, tally->total.stream, stream_names, FATHOM_STREAM_COUNTERS, true);
    is_empty = print(to, tally->total.line, line_names, FATHOM_LINE_COUNTERS, is_empty);
    if (!is_empty) (void)fputs("\n", to);
}

static double mean_us(const tally_t *tally)
{
    return tally->timed != 0 ? (double)tally->time_sum_us / (double)tally->timed : 0;
}

void tally_print_all(const tally_t *tally, FILE *to, uint64_t requests, bool is_asked)
{
    group_t groups[GROUPS];
    get_groups(groups, tally, is_asked);
    print_sums(tally, to);
    (void)fprintf(to, "fathom: requests %" PRIu64 ", skipped frames %" PRIu64 ", reconnects %" PRIu64 "\n",
                  requests, tally->skipped, tally->reconnects);
    for (size_t g = 0; g != GROUPS; g++) {
        const group_t *const group = &groups[g];
        const char *gap = ": ";
        if (!group->is_there) continue;
        (void)fprintf(to, "fathom: %s", group->name);
        for (size_t i = 0; i != group->count; i++) {
            if (group->names[i] == NULL) continue;
            (void)fprintf(to, "%s%s %" PRIu64, gap, group->names[i], group->counts[i]);
            gap = ", ";
        }
        (void)fputs("\n", to);
    }
    if (tally->timed != 0)
        (void)fprintf(to, "fathom: time to answer: shortest %.1f ms, mean %.1f ms, longest %.1f ms\n",
                      tally->time_min_us / 1000.0, mean_us(tally) / 1000.0, tally->time_max_us / 1000.0);
}

/* A member's name: spaces become underscores. */
static void print_name(FILE *to, const char *name)
{
    (void)fputc('"', to);
    for (; *name != '\0'; name++) (void)fputc(*name == ' ' ? '_' : *name, to);
    (void)fputs("\":", to);
}

void tally_print_json(const tally_t *tally, FILE *to, uint64_t requests, bool is_asked, uint64_t time_us)
{
    group_t groups[GROUPS];
    get_groups(groups, tally, is_asked);
    (void)fprintf(to,
                  "{\"time_us\":%" PRIu64 ",\"attempts\":%" PRIu64 ",\"failed\":%" PRIu64
                  ",\"readings\":%" PRIu64 ",\"requests\":%" PRIu64 ",\"skipped_frames\":%" PRIu64
                  ",\"reconnects\":%" PRIu64,
                  time_us, tally->attempts, tally->failed, tally->readings, requests, tally->skipped,
                  tally->reconnects);
    for (size_t g = 0; g != GROUPS; g++) {
        const group_t *const group = &groups[g];
        const char *gap = "{";
        (void)fputs(",", to);
        print_name(to, group->name);
        if (!group->is_there) {
            (void)fputs("null", to);
            continue;
        }
        for (size_t i = 0; i != group->count; i++) {
            if (group->names[i] == NULL) continue;
            (void)fputs(gap, to);
            print_name(to, group->names[i]);
            (void)fprintf(to, "%" PRIu64, group->counts[i]);
            gap = ",";
        }
        (void)fputs("}", to);
    }
    if (tally->timed != 0)
        (void)fprintf(to,
                      ",\"answer_us\":{\"answers\":%" PRIu64 ",\"min\":%" PRIu32
                      ",\"mean\":%.0f,\"max\":%" PRIu32 "}}\n",
                      tally->timed, tally->time_min_us, mean_us(tally), tally->time_max_us);
    else
        (void)fputs(",\"answer_us\":null}\n", to);
}
