/* SPDX-License-Identifier: MIT */
#include "fathom/engine/stream.h"

#include "../common.h"

/* fathom_stream_t.candidate and .last */
enum { FOLLOWS = 1, FIRST = 2, SURE = 3 };
enum { OVERLAPS = 1, STEP = 2 };

static void count(fathom_stream_t *stream, uint8_t which) { count_one(&stream->counters[which]); }

static void count_down(uint8_t *n)
{
    if (*n != 0u) --*n;
}

/* The candidate has ended, by a silence or by another frame, and is a good one. */
static void accept(fathom_stream_t *stream, bool by_silence)
{
    const uint8_t *from = stream->storage;
    uint8_t length = stream->length;
    if (stream->candidate == 0u) return;
    stream->sure =
        (stream->candidate + (by_silence ? 1u : 0u)) >= SURE; /* FIRST and a silence behind it is as good */
    stream->candidate = 0;
    stream->time_us = stream->candidate_us;
    if (stream->fresh) count(stream, FATHOM_STREAM_MISSED);
    stream->fresh = true;
    count(stream, FATHOM_STREAM_FRAMES);
    for (uint8_t *to = &stream->storage[length]; length != 0u; length--) {
        *to = *from;
        from++;
        to++;
    }
}

/* The window holds a valid frame: is this where a frame may stand? */
static void judge(fathom_stream_t *stream, uint32_t time_us)
{
    const uint8_t before = stream->last;
    uint8_t candidate = 0;
    uint8_t last = 0;
    uint8_t why = FATHOM_STREAM_UNSURE;
    if (stream->gap && (stream->to_whole == 1u)) candidate = FIRST;
    if (stream->to_step > 1u) {
        last = OVERLAPS;
        why = FATHOM_STREAM_AMBIGUOUS;
    } else if ((stream->to_step == 1u) && (before != OVERLAPS)) {
        last = STEP;
        if (before == STEP)
            candidate = SURE;
        else if (candidate == 0u)
            candidate = FOLLOWS;
    }
    stream->last = last;
    stream->to_step = (uint8_t)(stream->length + 1u);
    stream->candidate = candidate;
    stream->candidate_us = time_us;
    if (candidate == 0u) count(stream, why);
}

static void take(fathom_stream_t *stream, uint8_t byte, uint32_t time_us)
{
    const uint8_t length = stream->length;
    uint8_t *const window = stream->storage;
    if (byte == FATHOM_DYP_START) {
        accept(stream, false);
    } else if (stream->candidate != 0u) {
        stream->candidate = 0;
        count(stream, FATHOM_STREAM_UNSURE);
    }
    for (uint8_t at = length; at-- != 0u;) {
        const uint8_t before = window[at];
        window[at] = byte;
        byte = before;
    }
    count(stream, FATHOM_STREAM_BYTES);
    count_down(&stream->to_whole);
    count_down(&stream->to_step);
    if ((stream->to_whole <= 1u) && fathom_dyp_stream_valid(window, length)) judge(stream, time_us);
}

void fathom_stream_receive(fathom_listener_t *listener, const uint8_t *bytes, uint8_t count_of_bytes,
                           bool after_gap, uint32_t time_us)
{
    fathom_stream_t *const stream = (fathom_stream_t *)listener;
    if (after_gap) {
        accept(stream, true);
        stream->gap = true;
    } else if (count_of_bytes == 0u) { /* bytes were lost: the place of the next one is not known */
        stream->gap = false;
        stream->candidate = 0;
        stream->to_step = 0;
    }
    if (after_gap || (count_of_bytes == 0u)) stream->to_whole = (uint8_t)(stream->length + 1u);
    for (; count_of_bytes != 0u; count_of_bytes--) take(stream, *bytes++, time_us);
}

void fathom_stream_begin(fathom_stream_t *stream, uint32_t now_us)
{
    stream->listener.receive = fathom_stream_receive;
    if (stream->listener.gap_us == 0u) stream->listener.gap_us = FATHOM_STREAM_DEFAULT_GAP_US;
    if (stream->stale_us == 0u) stream->stale_us = FATHOM_STREAM_DEFAULT_STALE_US;
    stream->since_us = now_us;
    stream->candidate_us = now_us;
    /* one by one: of a loop compilers make a call of memset, which costs more */
    stream->counters[FATHOM_STREAM_FRAMES] = 0;
    stream->counters[FATHOM_STREAM_MISSED] = 0;
    stream->counters[FATHOM_STREAM_AMBIGUOUS] = 0;
    stream->counters[FATHOM_STREAM_UNSURE] = 0;
    stream->counters[FATHOM_STREAM_STALES] = 0;
    stream->counters[FATHOM_STREAM_BYTES] = 0;
    stream->to_whole = (uint8_t)(stream->length + 1u);
    stream->to_step = 0;
    stream->gap = false;
    stream->candidate = 0;
    stream->fresh = false;
}

fathom_status_t fathom_stream_init(fathom_stream_t *stream, const fathom_stream_config_t *config,
                                   uint32_t now_us)
{
    if ((config->storage == NULL) ||
        ((config->length != FATHOM_DYP_A16_LENGTH) && (config->length != FATHOM_DYP_A05_LENGTH)))
        return FATHOM_ERR_ARGUMENT;
    stream->listener.gap_us = config->gap_us;
    stream->storage = config->storage;
    stream->stale_us = config->stale_us;
    stream->length = config->length;
    fathom_stream_begin(stream, now_us);
    return FATHOM_READY;
}

/* What is left at now_us of what has begun at since_us. */
static uint32_t left_us(uint32_t us, uint32_t since_us, uint32_t now_us)
{
    return rest_us(us, fathom_elapsed_us(now_us, since_us));
}

fathom_status_t fathom_stream_poll(fathom_stream_t *stream, uint32_t now_us)
{
    fathom_status_t status = FATHOM_READY;
    if (left_us(stream->listener.gap_us, stream->candidate_us, now_us) == 0u) accept(stream, true);
    if (!stream->fresh) {
        if (left_us(stream->stale_us, stream->since_us, now_us) != 0u) return FATHOM_PENDING;
        count(stream, FATHOM_STREAM_STALES);
        status = FATHOM_ERR_STALE;
    }
    stream->since_us = now_us;
    stream->fresh = false;
    return status;
}

uint32_t fathom_stream_due_us(const fathom_stream_t *stream, uint32_t now_us)
{
    if (stream->fresh) return 0;
    const uint32_t stale_us = left_us(stream->stale_us, stream->since_us, now_us);
    if (stream->candidate == 0u) return stale_us;
    return least_us(stale_us, left_us(stream->listener.gap_us, stream->candidate_us, now_us));
}
