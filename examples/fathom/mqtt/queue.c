/* SPDX-License-Identifier: MIT */
#include "mqtt/queue.h"

#include <stdlib.h>
#include <string.h>

static void count_dropped(queue_t *queue, stream_t *stream)
{
    stream->dropped++;
    queue->dropped++;
}

void queue_drop(queue_t *queue, message_t *message)
{
    count_dropped(queue, message->stream);
    free(message);
}

void queue_set_bounds(queue_t *queue, uint32_t most, size_t bytes)
{
    queue->most = most;
    queue->bytes = bytes;
    while (queue->count > most || queue->used > bytes) queue_drop(queue, queue_take(queue));
}

void queue_put(queue_t *queue, stream_t *stream, uint64_t time_us, const char *text)
{
    const size_t size = sizeof(message_t) + strlen(text) + 1;
    message_t *const message = malloc(size);
    while (queue->count != 0 && (queue->count >= queue->most || queue->bytes - queue->used < size))
        queue_drop(queue, queue_take(queue));
    if (message == NULL) {
        count_dropped(queue, stream);
        return;
    }
    *message = (message_t){.stream = stream, .time_us = time_us, .size = size};
    (void)strcpy(message->text, text);
    if (queue->first == NULL)
        queue->first = message;
    else
        queue->last->next = message;
    queue->last = message;
    queue->used += size;
    queue->count++;
}

message_t *queue_take(queue_t *queue)
{
    message_t *const message = queue->first;
    if (message == NULL) return NULL;
    queue->first = message->next;
    queue->used -= message->size;
    queue->count--;
    return message;
}

void queue_free(queue_t *queue)
{
    while (queue->first != NULL) free(queue_take(queue));
}
