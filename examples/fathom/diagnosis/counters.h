/* SPDX-License-Identifier: MIT */
#ifndef COUNTERS_H
#define COUNTERS_H

#include <stdio.h>

#include "ports/port.h"
#include "sensors/models.h"
#include "sensors/reader.h"

/* ---- the words of `status` and `alarm` in text, JSON, CSV and MQTT ---- */

/* Returns the word for a kind of sample. A contact has its own words. */
const char *status_word(const model_mode_t *mode, uint8_t kind);

/* Failures by kind: -status, and beside it those whose values were refused. The last kind is any other failure. */
enum { FAILURE_VALUE = 0, FAILURE_KINDS = 20 };

/* Returns the word for a failure. NULL if no attempt can end so. */
const char *status_word_of_failure(size_t kind);

/* Returns the word for a fathom_alarm_state_t. */
const char *alarm_word(uint8_t state);

/* Writes a line for each word of `status`. */
void status_words_help(FILE *to);

/* ---- counters ---- */

/* What the port's driver counts, where it does. */
enum { PORT_PARITY = 0, PORT_FRAMING = 1, PORT_OVERRUN = 2, PORT_BREAKS = 3, PORT_COUNTERS = 4 };

/* The counters of a driver that sends requests. */
enum { UNIT_RESPONSES = 0, UNIT_FAILURES = 1, UNIT_COUNTERS = 2 };

/*
 * The library's counters stop at 65535 and count from the initialisation. The tool moves them here after each attempt:
 * so there are those of one attempt, from which its failure is explained, and the sums of all.
 */
typedef struct {
    uint64_t line[FATHOM_LINE_COUNTERS];
    uint64_t stream[FATHOM_STREAM_COUNTERS];
    uint64_t unit[UNIT_COUNTERS];
    uint64_t port[PORT_COUNTERS];
} counts_t;

/* The share of damaged frames of a sensor that sends automatically, in blocks of frames. */
typedef struct {
    uint64_t frames; /* of the stream, when the present block began */
    uint64_t damaged;
    uint32_t bad_frames; /* in the newest blocks in a row that have too many damaged frames, ... */
    uint32_t bad_damaged;
    uint8_t bad_blocks;
    uint8_t good_blocks; /* ... and the number of the others in a row */
    uint8_t reported;    /* the share that was reported, in percent; 0: none */
} damage_t;

/* Invariant: from `total` to `time_sum_us`, all members are uint64_t. counters_add() adds them. */
typedef struct {
    counts_t attempt; /* since counters_begin_attempt */
    counts_t total;
    uint64_t attempts;
    uint64_t failed;
    uint64_t readings;
    uint64_t skipped;                 /* frames that arrived sooner than the interval */
    uint64_t failures[FAILURE_KINDS]; /* each is a line on stderr; four of an a05 may be one failed attempt */
    uint64_t timed; /* responses whose time is in the next three: from the request's start */
    uint64_t time_sum_us;
    uint32_t time_min_us;
    uint32_t time_max_us;
    damage_t damage;
} counters_t;

/* Moves the counters of the line, the sensor and the port. Returns those of the sensor. */
reader_counters_t counters_take(counters_t *counters, port_t *port, reader_t *reader);

/* Takes the line's late responses alone: they are this sensor's. */
void counters_take_late(counters_t *counters, port_t *port);

void counters_begin_attempt(counters_t *counters);

/* Returns the kind of a failure: FAILURE_VALUE, -status, or the last one, "other". */
size_t counters_failure_kind(fathom_status_t status, const reader_t *reader);

void counters_time(counters_t *counters, uint32_t took_us);

/* Returns the share of damaged frames in percent, if more than a few in a hundred are damaged and the user does not know
 * it: once, and again if the share has doubled or is reached again after a minute. A burst does not count. Else 0. */
unsigned counters_take_damage(counters_t *counters);

/* Adds what one sensor has counted to the sums of all; the present attempt is left out. */
void counters_add(counters_t *sum, const counters_t *part);

#endif
