/* SPDX-License-Identifier: MIT */
#include "fathom/stream.h"

enum { SURE_STEPS = 2 };

static void count(fathom_stream_t *stream, uint8_t which)
{
    if (stream->counters[which] != UINT16_MAX) stream->counters[which]++;
}

static uint8_t one_more(uint8_t n) { return n != UINT8_MAX ? (uint8_t)(n + 1) : n; }

static uint32_t stale_us(const fathom_stream_t *stream)
{
    const uint32_t us = stream->config->stale_us;
    return us != 0 ? us : FATHOM_STREAM_DEFAULT_STALE_US;
}

/* The storage holds the last `length` bytes in a ring, the oldest at stream->oldest, and behind it the newest
 * good frame. This straightens the ring. */
static void copy_ring(const fathom_stream_t *stream, uint8_t *to)
{
    const uint8_t length = stream->config->length;
    uint8_t at = stream->oldest;
    for (uint8_t left = length; left != 0; left--) {
        *to++ = stream->config->storage[at];
        if (++at == length) at = 0;
    }
}

/* What comes after the candidate is known: is it the end of a frame? */
static void decide(fathom_stream_t *stream, bool is_end, bool is_silence)
{
    if (!stream->candidate) return;
    stream->candidate = false;
    if (!is_end) {
        count(stream, FATHOM_STREAM_UNSURE);
        return;
    }
    copy_ring(stream, stream->config->storage + stream->config->length);
    if (stream->fresh) count(stream, FATHOM_STREAM_MISSED);
    count(stream, FATHOM_STREAM_FRAMES);
    stream->fresh = true;
    stream->sure = (is_silence && stream->first) || stream->steps >= SURE_STEPS;
    stream->time_us = stream->candidate_us;
}

/* The ring holds a valid frame: is this where a frame may stand? */
static void judge(fathom_stream_t *stream, uint32_t time_us)
{
    const uint8_t length = stream->config->length;
    const bool is_step = stream->since == length && !stream->doubtful;
    stream->first = stream->gap && stream->run == length;
    stream->steps = is_step ? one_more(stream->steps) : 0;
    if (stream->first || is_step) {
        stream->candidate = true;
        stream->candidate_us = time_us;
    } else {
        count(stream, stream->since < length ? FATHOM_STREAM_AMBIGUOUS : FATHOM_STREAM_UNSURE);
    }
    stream->doubtful = stream->since < length;
    stream->since = 0;
}

static void take(fathom_stream_t *stream, uint8_t byte, uint32_t time_us)
{
    const uint8_t length = stream->config->length;
    uint8_t *const ring = stream->config->storage;
    uint8_t frame[FATHOM_DYP_MAX_LENGTH];
    decide(stream, byte == FATHOM_DYP_START, false);
    ring[stream->oldest] = byte;
    if (++stream->oldest == length) stream->oldest = 0;
    count(stream, FATHOM_STREAM_BYTES);
    stream->run = one_more(stream->run);
    stream->since = one_more(stream->since);
    if (stream->run < length || ring[stream->oldest] != FATHOM_DYP_START) return;
    copy_ring(stream, frame);
    if (fathom_dyp_frame_valid(frame, length)) judge(stream, time_us);
}

void fathom_stream_feed(fathom_stream_t *stream, const uint8_t *bytes, uint8_t count_of_bytes, bool after_gap,
                        uint32_t time_us)
{
    if (after_gap) {
        decide(stream, true, true);
        stream->run = 0;
        stream->gap = true;
    } else if (count_of_bytes == 0) { /* some were lost: the next one is in no known place */
        stream->gap = false;
        stream->candidate = false;
        stream->since = UINT8_MAX;
    }
    for (; count_of_bytes != 0; count_of_bytes--) take(stream, *bytes++, time_us);
}

static void listen(fathom_listener_t *listener, const uint8_t *bytes, uint8_t count_of_bytes, bool after_gap,
                   uint32_t time_us)
{
    fathom_stream_feed((fathom_stream_t *)listener, bytes, count_of_bytes, after_gap, time_us);
}

fathom_status_t fathom_stream_init(fathom_stream_t *stream, const fathom_stream_config_t *config,
                                   uint32_t now_us)
{
    if (config->storage == NULL ||
        (config->length != FATHOM_DYP_A16_LENGTH && config->length != FATHOM_DYP_A05_LENGTH))
        return FATHOM_ERR_ARGUMENT;
    stream->listener.receive = listen;
    stream->listener.gap_us = config->gap_us != 0 ? config->gap_us : FATHOM_STREAM_DEFAULT_GAP_US;
    stream->config = config;
    stream->polled_us = now_us;
    stream->left_us = stale_us(stream);
    stream->time_us = now_us;
    stream->candidate_us = now_us;
    /* volatile: or compilers make it a call of memset, which costs more than all of this. */
    for (volatile uint16_t *c = stream->counters; c != stream->counters + FATHOM_STREAM_COUNTERS; c++) *c = 0;
    stream->oldest = 0;
    stream->run = 0;
    stream->since = UINT8_MAX;
    stream->gap = false;
    stream->candidate = false;
    stream->fresh = false;
    return FATHOM_READY;
}

/* How long the line must go on being silent until that ends the candidate. */
static uint32_t silence_left_us(const fathom_stream_t *stream, uint32_t now_us)
{
    const uint32_t passed_us = fathom_elapsed_us(now_us, stream->candidate_us);
    const uint32_t gap_us = stream->listener.gap_us;
    return gap_us > passed_us ? gap_us - passed_us : 0;
}

fathom_status_t fathom_stream_poll(fathom_stream_t *stream, uint32_t now_us, const uint8_t **frame)
{
    const bool over = fathom_run_down(&stream->left_us, fathom_elapsed_us(now_us, stream->polled_us));
    stream->polled_us = now_us;
    if (silence_left_us(stream, now_us) == 0) decide(stream, true, true);
    if (!stream->fresh && !over) return FATHOM_PENDING;
    stream->left_us = stale_us(stream);
    if (!stream->fresh) {
        count(stream, FATHOM_STREAM_STALES);
        return FATHOM_ERR_STALE;
    }
    stream->fresh = false;
    *frame = stream->config->storage + stream->config->length;
    return FATHOM_READY;
}

uint32_t fathom_stream_due_us(const fathom_stream_t *stream, uint32_t now_us)
{
    const uint32_t passed_us = fathom_elapsed_us(now_us, stream->polled_us);
    if (stream->fresh || stream->left_us <= passed_us) return 0;
    const uint32_t deadline_us = stream->left_us - passed_us;
    const uint32_t silence_us = silence_left_us(stream, now_us);
    return stream->candidate && silence_us < deadline_us ? silence_us : deadline_us;
}
