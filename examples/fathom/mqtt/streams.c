/* SPDX-License-Identifier: MIT */
#include "mqtt/streams.h"

#include <stdlib.h>
#include <string.h>

static stream_t *find(const streams_t *streams, const char *topic)
{
    stream_t *stream = streams->first;
    while (stream != NULL && strcmp(stream->topic, topic) != 0) stream = stream->next;
    return stream;
}

stream_t *streams_want(streams_t *streams, const char *topic, stream_kind_t kind, const sensor_t *sensor)
{
    stream_t *stream = find(streams, topic);
    const bool is_new = stream == NULL || stream->sensor != sensor;
    if (stream == NULL) {
        stream = calloc(1, sizeof *stream + strlen(topic) + 1);
        if (stream == NULL) return NULL;
        (void)strcpy(stream->topic, topic);
        stream->next = streams->first;
        streams->first = stream;
    }
    stream->kind = kind;
    stream->sensor = sensor;
    stream->is_retained = kind != STREAM_READINGS; /* and an alarm, which the caller knows */
    stream->is_wanted = true;
    if (is_new) stream->is_due = true;
    return stream;
}

void streams_forget(streams_t *streams)
{
    for (stream_t *stream = streams->first; stream != NULL; stream = stream->next) stream->is_wanted = false;
}

void streams_clean(streams_t *streams)
{
    for (stream_t *stream = streams->first; stream != NULL; stream = stream->next)
        if (!stream->is_wanted) stream->sensor = NULL;
}

void streams_repeat(streams_t *streams)
{
    for (stream_t *stream = streams->first; stream != NULL; stream = stream->next)
        if (stream->is_wanted) stream->is_due = true;
}

void streams_make_due(streams_t *streams, stream_kind_t kind)
{
    for (stream_t *stream = streams->first; stream != NULL; stream = stream->next)
        if (stream->is_wanted && stream->kind == kind) stream->is_due = true;
}

stream_t *streams_due(const streams_t *streams, stream_kind_t kind)
{
    stream_t *stream = streams->first;
    while (stream != NULL && !(stream->is_wanted && stream->is_due && stream->kind == kind))
        stream = stream->next;
    return stream;
}

stream_t *streams_gone(const streams_t *streams)
{
    stream_t *stream = streams->first;
    while (stream != NULL && (stream->is_wanted || !stream->is_known || !stream->is_retained))
        stream = stream->next;
    return stream;
}

void streams_free(streams_t *streams)
{
    while (streams->first != NULL) {
        stream_t *const stream = streams->first;
        streams->first = stream->next;
        free(stream);
    }
}
