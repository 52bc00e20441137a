/* SPDX-License-Identifier: MIT */
#ifndef STREAMS_H
#define STREAMS_H

#include <stdbool.h>
#include <stdint.h>

#include "reading/site.h"

/* Topics, and what the broker knows about them. */

typedef enum {
    STREAM_STATUS,       /* of the publisher: online or offline */
    STREAM_DISCOVERY,    /* how Home Assistant finds an entity of a sensor */
    STREAM_AVAILABILITY, /* of a sensor */
    STREAM_COUNTERS,     /* of a sensor */
    STREAM_PUBLISHER,    /* how the publisher is */
    STREAM_READINGS      /* of a probe */
} stream_kind_t;

/* Everything that is published under one topic since the start of the program. A stream stays until the end, also while
 * no sensor has it: a sensor that is named again goes on with its numbers. */
typedef struct stream stream_t;
struct stream {
    stream_t *next;
    stream_kind_t kind;
    const sensor_t *sensor; /* while is_wanted; NULL: of the publisher */
    unsigned bit;           /* of a discovery message */
    uint64_t seq;           /* of the last message; 0: none yet */
    uint64_t dropped;       /* messages */
    bool is_retained;
    bool is_wanted; /* a sensor has it, or the publisher */
    bool is_due;    /* the broker does not know the present state of a retained topic */
    bool is_known;  /* the broker may have a retained message */
    char topic[];
};

typedef struct {
    stream_t *first;
} streams_t;

/* Returns the stream of this topic, a new one if needed, and marks it as wanted. If the stream is new or belonged to
 * another sensor, it is due. NULL: no memory left. */
stream_t *streams_want(streams_t *streams, const char *topic, stream_kind_t kind, const sensor_t *sensor);

/* Before the wanted streams are named anew: none is wanted any more. Afterwards: streams without a sensor have none. */
void streams_forget(streams_t *streams);
void streams_clean(streams_t *streams);

/* A client that has just connected: every wanted retained stream is due, whatever the broker still knows. */
void streams_repeat(streams_t *streams);

/* All wanted streams of this kind are due. */
void streams_make_due(streams_t *streams, stream_kind_t kind);

/* Returns a wanted stream of this kind that is due; NULL: none is. */
stream_t *streams_due(const streams_t *streams, stream_kind_t kind);

/* Returns a stream that is not wanted and may have a retained message, which is to be deleted; NULL: there is none. */
stream_t *streams_gone(const streams_t *streams);

void streams_free(streams_t *streams);

#endif
