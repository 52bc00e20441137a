/* SPDX-License-Identifier: MIT */
#include "fathom/engine/stream.h"

#include "../common.h"

/*
 * Finds frames in received bytes. stream.h has the rules; their numbers are those of the comments here. The file is in
 * the order of dependence: each function calls only functions above it.
 *
 *     fathom_stream_receive()   silence --> accept the candidate, drop what broke off, begin a run
 *                               loss    --> refuse the candidate, drop what broke off, begin a run
 *         take(), each byte     FF      --> accept the candidate;   any other byte --> refuse it
 *                               the window is valid     --> judge(): where does it stand?
 *                               the window is not valid --> damaged, if a frame must stand there
 *     fathom_stream_poll()      silence --> accept the candidate;   a frame, or stale
 */

/* ---- Counters ---- */

static void count(fathom_stream_t *stream, uint8_t which) { count_one(&stream->counters[which]); }

/* Adds one to a number of bytes that stops at FAR. */
enum { FAR = UINT8_MAX };

static void count_byte(uint8_t *byte_count)
{
    if (*byte_count != FAR) ++*byte_count;
}

/* ---- Candidates ---- */

/*
 * FF or a silence has shown that the candidate is a frame (rule 2). Its place is sure from `least_sure` on (rule 4).
 *
 * The undecided bytes are exactly the candidate: a candidate stands directly after a silence or after a valid window
 * that overlaps no other, so it shares no byte with an accepted frame.
 */
static void accept(fathom_stream_t *stream, fathom_stream_place_t least_sure)
{
    const uint8_t *from = stream->storage;
    uint8_t length = stream->length;
    if (stream->candidate == FATHOM_STREAM_NOWHERE) return;
    stream->is_sure = stream->candidate >= (uint8_t)least_sure;
    stream->candidate = FATHOM_STREAM_NOWHERE;
    stream->undecided_count = 0;
    stream->is_expected = true;
    stream->time_us = stream->candidate_us;
    if (stream->is_new) count(stream, FATHOM_STREAM_MISSED);
    stream->is_new = true;
    count(stream, FATHOM_STREAM_FRAMES);
    for (uint8_t *to = &stream->storage[length]; length != 0u; length--) {
        *to = *from;
        from++;
        to++;
    }
}

/* A byte that is not FF, or a loss, stands after the candidate. */
static void refuse(fathom_stream_t *stream)
{
    if (stream->candidate == FATHOM_STREAM_NOWHERE) return;
    stream->candidate = FATHOM_STREAM_NOWHERE;
    count(stream, FATHOM_STREAM_UNSURE);
}

/* The window is valid. Decides where it stands (rules 1, 3 and 4). A frame is due after a silence or a frame. */
static void judge(fathom_stream_t *stream, bool is_due, uint32_t time_us)
{
    const uint8_t length = stream->length;
    const uint8_t before = stream->relation;
    uint8_t place = FATHOM_STREAM_NOWHERE;
    uint8_t relation = FATHOM_STREAM_APART;
    uint8_t refusal = FATHOM_STREAM_UNSURE;
    if (is_due && (stream->run_count == length)) place = FATHOM_STREAM_AFTER_SILENCE;
    if (stream->step_count < length) {
        relation = FATHOM_STREAM_OVERLAPS;
        refusal = FATHOM_STREAM_AMBIGUOUS;
    } else if ((stream->step_count == length) && (before != FATHOM_STREAM_OVERLAPS)) {
        relation = FATHOM_STREAM_ADJOINS;
        if (before == FATHOM_STREAM_ADJOINS)
            place = FATHOM_STREAM_IN_STEP;
        else if (place == FATHOM_STREAM_NOWHERE)
            place = FATHOM_STREAM_AFTER_WINDOW;
    }
    stream->relation = relation;
    stream->step_count = 0;
    stream->candidate = place;
    stream->candidate_us = time_us;
    if (place == FATHOM_STREAM_NOWHERE) count(stream, refusal);
}

/* ---- Received bytes ---- */

/* The undecided bytes can be in no frame any more. If a frame had to stand there, it broke off (rule 7). */
static void drop_undecided(fathom_stream_t *stream)
{
    if (stream->is_expected && (stream->undecided_count != 0u)) count(stream, FATHOM_STREAM_DAMAGED);
    for (; stream->undecided_count != 0u; stream->undecided_count--)
        count(stream, FATHOM_STREAM_DROPPED_BYTES);
}

/* Begins a run of bytes after a silence or a loss. No window reaches across its beginning. */
static void begin_run(fathom_stream_t *stream, bool is_after_silence)
{
    drop_undecided(stream);
    stream->run_count = 0;
    stream->is_expected = is_after_silence;
}

/* Moves the window on by one byte. */
static void shift(fathom_stream_t *stream, uint8_t byte)
{
    for (uint8_t at = stream->length; at-- != 0u;) {
        const uint8_t before = stream->storage[at];
        stream->storage[at] = byte;
        byte = before;
    }
}

static void take(fathom_stream_t *stream, uint8_t byte, uint32_t time_us)
{
    const uint8_t length = stream->length;
    if (byte == FATHOM_DYP_START)
        accept(stream, FATHOM_STREAM_IN_STEP);
    else
        refuse(stream);
    shift(stream, byte);
    count(stream, FATHOM_STREAM_BYTES);
    count_byte(&stream->run_count);
    count_byte(&stream->step_count);
    if (stream->undecided_count == length)
        count(stream, FATHOM_STREAM_DROPPED_BYTES);
    else
        stream->undecided_count++;
    const bool is_due = stream->is_expected && (stream->undecided_count == length);
    if (is_due) stream->is_expected = false;
    if ((stream->run_count >= length) && fathom_dyp_stream_is_valid(stream->storage, length))
        judge(stream, is_due, time_us);
    else if (is_due)
        count(stream, FATHOM_STREAM_DAMAGED);
}

void fathom_stream_receive(fathom_listener_t *listener, const uint8_t *bytes, uint8_t byte_count,
                           bool after_gap, uint32_t time_us)
{
    fathom_stream_t *const stream = (fathom_stream_t *)listener;
    stream->is_heard = true;
    if (after_gap) {
        accept(stream, FATHOM_STREAM_AFTER_SILENCE);
        begin_run(stream, true);
    } else if (byte_count == 0u) {
        refuse(stream);
        begin_run(stream, false);
        stream->step_count = FAR; /* The place of the next byte is not known. */
    }
    for (; byte_count != 0u; byte_count--) take(stream, *bytes++, time_us);
}

/* ---- Initialisation ---- */

fathom_status_t fathom_stream_start(fathom_stream_t *stream, uint32_t now_us)
{
    fathom_listener_t *const listener = &stream->listener;
    listener->receive = fathom_stream_receive;
    if (listener->gap_us == 0u) listener->gap_us = FATHOM_STREAM_DEFAULT_GAP_US;
    if (listener->stale_us == 0u) listener->stale_us = FATHOM_STREAM_DEFAULT_STALE_US;
    if ((listener->gap_us < FATHOM_STREAM_MIN_GAP_US) || (listener->stale_us > FATHOM_STREAM_MAX_STALE_US))
        return FATHOM_ERR_ARGUMENT;
    stream->since_us = now_us;
    stream->candidate_us = now_us;
    clear(stream->counters, sizeof stream->counters);
    stream->step_count = FAR; /* There is no valid window yet. */
    stream->run_count = 0;
    stream->undecided_count = 0;
    stream->candidate = FATHOM_STREAM_NOWHERE;
    stream->is_expected = false;
    stream->is_heard = false;
    stream->is_new = false;
    return FATHOM_OK;
}

fathom_status_t fathom_stream_init(fathom_stream_t *stream, const fathom_stream_config_t *config,
                                   uint32_t now_us)
{
    if ((config->storage == NULL) ||
        ((config->length != FATHOM_DYP_A16_LENGTH) && (config->length != FATHOM_DYP_A05_LENGTH)))
        return FATHOM_ERR_ARGUMENT;
    stream->listener.gap_us = config->gap_us;
    stream->storage = config->storage;
    stream->listener.stale_us = config->stale_us;
    stream->length = config->length;
    return fathom_stream_start(stream, now_us);
}

/* ---- Polling ---- */

/* Returns true if a frame of this age is no reading any more. */
static bool is_too_old(uint32_t frame_us, uint32_t stale_us)
{
    return rest_us(frame_us, FATHOM_LINE_LATE_US) > stale_us;
}

/* Returns the rest at `now_us` of `us`, which began at `since_us`. */
static uint32_t left_us(uint32_t us, uint32_t since_us, uint32_t now_us)
{
    return rest_us(us, time_since_us(now_us, since_us));
}

fathom_status_t fathom_stream_poll(fathom_stream_t *stream, uint32_t now_us)
{
    const uint32_t stale_us = stream->listener.stale_us;
    fathom_status_t status = FATHOM_OK;
    if (left_us(stream->listener.gap_us, stream->candidate_us, now_us) == 0u)
        accept(stream, FATHOM_STREAM_AFTER_SILENCE);
    if (stream->is_new && is_too_old(time_since_us(now_us, stream->time_us), stale_us)) {
        stream->is_new = false; /* Rule 6: what arrived is too old, and no damage. */
        stream->is_heard = false;
        count(stream, FATHOM_STREAM_MISSED);
    }
    if (!stream->is_new) {
        if (left_us(stale_us, stream->since_us, now_us) != 0u) return FATHOM_PENDING;
        count(stream, FATHOM_STREAM_STALES);
        status = stream->is_heard ? FATHOM_ERR_CHECKSUM : FATHOM_ERR_STALE;
    }
    stream->since_us = now_us;
    stream->is_heard = (status == FATHOM_OK) && (stream->undecided_count != 0u);
    stream->is_new = false;
    return status;
}

uint32_t fathom_stream_due_us(const fathom_stream_t *stream, uint32_t now_us)
{
    if (stream->is_new) return 0;
    const uint32_t stale_us = left_us(stream->listener.stale_us, stream->since_us, now_us);
    if (stream->candidate == FATHOM_STREAM_NOWHERE) return stale_us;
    return least_us(stale_us, left_us(stream->listener.gap_us, stream->candidate_us, now_us));
}
