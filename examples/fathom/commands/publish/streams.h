/* SPDX-License-Identifier: MIT */
#ifndef STREAMS_H
#define STREAMS_H

#include <stdbool.h>
#include <stdint.h>

/* What is told under one topic since the program's start: its messages are numbered, and those that were dropped counted. A
 * stream is there until the end, also while no sensor has it: one that is named again goes on counting. */
typedef struct stream stream_t;
struct stream {
    const char *topic;
    uint64_t seq;     /* of the last message; 0: none yet */
    uint64_t dropped; /* of them */
    bool is_retained;
    stream_t *next;
};

typedef struct {
    stream_t *first;
} streams_t;

/* The stream of this topic, a new one if need be. NULL: there is no memory left. */
stream_t *streams_get(streams_t *streams, const char *topic);

void streams_end(streams_t *streams);

#endif
