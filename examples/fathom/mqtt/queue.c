/* SPDX-License-Identifier: MIT */
#include "mqtt/queue.h"

#include <stdlib.h>
#include <string.h>

bool queue_begin(queue_t *queue, uint32_t most, size_t size)
{
    memset(queue, 0, sizeof *queue);
    queue->memory = malloc(size);
    queue->size = size;
    queue->most = most;
    return queue->memory != NULL;
}

void queue_end(queue_t *queue)
{
    free(queue->memory);
    memset(queue, 0, sizeof *queue);
}

/* ---- bytes, which may go round the end ---- */

static void put_bytes(queue_t *queue, const void *bytes, size_t length)
{
    const size_t at = (queue->begin + queue->used) % queue->size;
    const size_t first = length < queue->size - at ? length : queue->size - at;
    memcpy(queue->memory + at, bytes, first);
    memcpy(queue->memory, (const unsigned char *)bytes + first, length - first);
    queue->used += length;
}

static void take_bytes(queue_t *queue, void *bytes, size_t length)
{
    const size_t first = length < queue->size - queue->begin ? length : queue->size - queue->begin;
    memcpy(bytes, queue->memory + queue->begin, first);
    memcpy((unsigned char *)bytes + first, queue->memory, length - first);
    queue->begin = (queue->begin + length) % queue->size;
    queue->used -= length;
}

/* ---- messages ---- */

static void drop_oldest(queue_t *queue)
{
    message_t message;
    char text[QUEUE_TEXT];
    (void)queue_take(queue, &message, text);
    message.stream->dropped++;
    queue->dropped++;
}

void queue_put(queue_t *queue, const message_t *message, const char *text)
{
    const size_t needed = sizeof *message + message->length;
    while (queue->count != 0 && (queue->count >= queue->most || queue->size - queue->used < needed))
        drop_oldest(queue);
    put_bytes(queue, message, sizeof *message);
    put_bytes(queue, text, message->length);
    queue->count++;
}

bool queue_take(queue_t *queue, message_t *message, char text[QUEUE_TEXT])
{
    if (queue->count == 0) return false;
    take_bytes(queue, message, sizeof *message);
    take_bytes(queue, text, message->length);
    text[message->length] = '\0';
    queue->count--;
    if (queue->count == 0) queue->begin = 0;
    return true;
}

bool queue_resize(queue_t *queue, uint32_t most, size_t size)
{
    queue_t other;
    message_t message;
    char text[QUEUE_TEXT];
    if (most == queue->most && size == queue->size) return true;
    if (!queue_begin(&other, most, size)) return false;
    while (queue_take(queue, &message, text)) queue_put(&other, &message, text);
    other.dropped += queue->dropped;
    queue_end(queue);
    *queue = other;
    return true;
}
