/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_STREAM_RIG_H
#define FATHOM_TESTS_STREAM_RIG_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/engine/stream.h"

/* Frames that a sensor sends by itself, made and judged by the datasheets' formula alone, and a stream that reads
 * them from any byte on, in portions. */

enum { RIG_MAX_FRAMES = 40 };

/* How the bytes reach the stream. */
enum { RIG_BY_BYTE, RIG_IN_CHUNKS, RIG_EVERY_20_MS, RIG_WAYS };

typedef struct {
    unsigned right;   /* readings that are the frame that they should be */
    unsigned wrong;   /* all others */
    unsigned first;   /* which frame was shown first; UINT_MAX: none */
    unsigned windows; /* places with a right sum in all that was fed, found by brute force */
    const uint16_t *counters;
} rig_outcome_t;

void rig_seed(uint32_t seed);
uint32_t rig_random_below(uint32_t n);

/* FF, `length - 2` bytes of values, high bytes first, and their sum. */
void rig_make_frame(uint8_t *frame, uint8_t length, const uint16_t *values);

bool rig_is_valid(const uint8_t *frame, uint8_t length);

/* Can the frame, held still, be read at another byte too? */
bool rig_has_two_alignments(const uint8_t *frame, uint8_t length);

/*
 * Feeds `frames` (<= RIG_MAX_FRAMES) frames of `length` bytes, which stand one behind the other in `sent`, from byte
 * `start` (< length) on, and polls after every portion. gaps: there is a pause of 90 ms between frames, and it is
 * seen; else there is none.
 */
rig_outcome_t rig_feed(const uint8_t *sent, unsigned frames, uint8_t length, uint8_t start, bool gaps,
                       int way);

#endif
