/* SPDX-License-Identifier: MIT */
#include "commands/publish/streams.h"

#include <stdlib.h>
#include <string.h>

stream_t *streams_get(streams_t *streams, const char *topic)
{
    stream_t *stream = streams->first;
    while (stream != NULL && strcmp(stream->topic, topic) != 0) stream = stream->next;
    if (stream != NULL) return stream;
    const size_t size = strlen(topic) + 1;
    stream = calloc(1, sizeof *stream + size);
    if (stream == NULL) return NULL;
    stream->topic = memcpy(stream + 1, topic, size);
    stream->next = streams->first;
    streams->first = stream;
    return stream;
}

void streams_end(streams_t *streams)
{
    while (streams->first != NULL) {
        stream_t *const stream = streams->first;
        streams->first = stream->next;
        free(stream);
    }
}
