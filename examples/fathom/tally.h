/* SPDX-License-Identifier: MIT */
#ifndef TALLY_H
#define TALLY_H

#include <stdio.h>

#include "channel.h"
#include "readers.h"

/*
 * The library's counters stop at 65535 and run from the beginning. Here they are taken out after each attempt:
 * so there are those of one attempt, from which its failure is explained, and the sums of all.
 */
typedef struct {
    uint64_t line[FATHOM_LINE_COUNTERS];
    uint64_t stream[FATHOM_STREAM_COUNTERS];
} counts_t;

typedef struct {
    counts_t attempt; /* since tally_begin_attempt */
    counts_t total;
    uint64_t attempts;
    uint64_t failed;
    uint64_t readings;
} tally_t;

/* Takes the counters out of the line and the stream and adds them. */
void tally_take(tally_t *tally, channel_t *channel, const reader_t *reader);

void tally_begin_attempt(tally_t *tally);

/* The sums, in two lines or less; what is 0 is left out. */
void tally_print(const tally_t *tally, FILE *to);

#endif
