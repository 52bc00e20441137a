/* SPDX-License-Identifier: MIT */
#ifndef QUEUE_H
#define QUEUE_H

#include <stddef.h>

#include "mqtt/streams.h"

/* Messages that wait for the broker, the oldest first, in a list on the heap. If one more exceeds the bounds, the oldest
 * messages are dropped and counted in their streams. */

enum { QUEUE_TEXT = 512 };

typedef struct message message_t;
struct message {
    message_t *next;
    stream_t *stream;
    uint64_t time_us; /* of the reading, by the host's clock */
    size_t size;      /* of the message with its text */
    char text[];
};

typedef struct {
    message_t *first;
    message_t *last;
    size_t used; /* bytes */
    size_t bytes;
    uint32_t count;
    uint32_t most;
    uint64_t dropped; /* since the start */
} queue_t;

/* Sets the bounds, also of a queue in use. */
void queue_set_bounds(queue_t *queue, uint32_t most, size_t bytes);

/* Adds a message of less than QUEUE_TEXT bytes. */
void queue_put(queue_t *queue, stream_t *stream, uint64_t time_us, const char *text);

/* Returns the oldest message, which the caller frees; NULL: there is none. */
message_t *queue_take(queue_t *queue);

/* Counts a message as dropped, and frees it. */
void queue_drop(queue_t *queue, message_t *message);

void queue_free(queue_t *queue);

#endif
