/* SPDX-License-Identifier: MIT */
#ifndef QUEUE_H
#define QUEUE_H

#include <stddef.h>

#include "mqtt/streams.h"

/* Messages that wait for the broker, the oldest first. It has room for so many messages and so many bytes; where one more
 * does not fit, the oldest are dropped, and counted in their streams. One piece of memory, of which pages that were never
 * needed are not used. */

enum { QUEUE_TEXT = 512 };

typedef struct {
    stream_t *stream;
    uint64_t time_us; /* of the clock, when it was measured */
    uint32_t length;  /* of the text, less than QUEUE_TEXT */
} message_t;

typedef struct {
    unsigned char *memory;
    size_t size;
    size_t begin; /* of the oldest */
    size_t used;
    uint32_t count;
    uint32_t most;
    uint64_t dropped; /* so far */
} queue_t;

/* What a message takes of the bytes besides its text. */
enum { QUEUE_OVERHEAD = sizeof(message_t) };

/* size: so many bytes, at least one whole message. False: there is no memory left. */
bool queue_begin(queue_t *queue, uint32_t most, size_t size);
void queue_end(queue_t *queue);

/* Other bounds. What does not fit any more is dropped. False: there is no memory left, and nothing has changed. */
bool queue_resize(queue_t *queue, uint32_t most, size_t size);

/* message->length bytes of text. */
void queue_put(queue_t *queue, const message_t *message, const char *text);

/* Takes the oldest one out. text: with a 0 at its end. False: there is none. */
bool queue_take(queue_t *queue, message_t *message, char text[QUEUE_TEXT]);

#endif
