/* SPDX-License-Identifier: MIT */
#include "tally.h"

#include <inttypes.h>
#include <string.h>

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

static void take(uint16_t *from, uint64_t *attempt, uint64_t *total, size_t count)
{
    for (size_t i = 0; i != count; i++) {
        attempt[i] += from[i];
        total[i] += from[i];
        from[i] = 0;
    }
}

void tally_take(tally_t *tally, channel_t *channel, const reader_t *reader)
{
    take(channel->line.counters, tally->attempt.line, tally->total.line, FATHOM_LINE_COUNTERS);
    if (reader->stream != NULL)
        take(reader->stream->counters, tally->attempt.stream, tally->total.stream, FATHOM_STREAM_COUNTERS);
}

void tally_begin_attempt(tally_t *tally) { memset(&tally->attempt, 0, sizeof tally->attempt); }

static bool print(FILE *to, const uint64_t *counts, const char *const *names, size_t count, bool is_first)
{
    for (size_t i = 0; i != count; i++) {
        if (counts[i] == 0) continue;
        (void)fprintf(to, "%s%s %" PRIu64, is_first ? "fathom: line: " : ", ", names[i], counts[i]);
        is_first = false;
    }
    return is_first;
}

void tally_print(const tally_t *tally, FILE *to)
{
    (void)fprintf(to, "fathom: attempts %" PRIu64 ", failed %" PRIu64 ", readings %" PRIu64 "\n",
                  tally->attempts, tally->failed, tally->readings);
    bool is_empty = print(to, tally->total.stream, stream_names, FATHOM_STREAM_COUNTERS, true);
    is_empty = print(to, tally->total.line, line_names, FATHOM_LINE_COUNTERS, is_empty);
    if (!is_empty) (void)fputs("\n", to);
}
