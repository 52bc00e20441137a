/* SPDX-License-Identifier: MIT */
#include "stream_rig.h"

#include <limits.h>
#include <string.h>

#include "suite.h"

enum { BYTE_US = 1042, PAUSE_US = 90000, GAP_US = 5000, LOOP_US = 20000, LONGEST_CHUNK = 25 };

static uint32_t random_state;

void rig_seed(uint32_t seed) { random_state = seed; }

uint32_t rig_random_below(uint32_t n)
{
    random_state = random_state * 1664525u + 1013904223u;
    return (uint32_t)(((uint64_t)(random_state >> 8) * n) >> 24);
}

void rig_make_frame(uint8_t *frame, uint8_t length, const uint16_t *values)
{
    unsigned sum = frame[0] = 0xFF;
    for (uint8_t at = 1; at != length - 1; at++) {
        const uint16_t value = values[(at - 1) / 2];
        frame[at] = (uint8_t)(at % 2 != 0 ? value / 256 : value % 256);
        sum += frame[at];
    }
    frame[length - 1] = (uint8_t)(sum & 0xFF);
}

/* `length` bytes of a ring of `size`, from `at` on. */
static bool is_valid_in_ring(const uint8_t *ring, unsigned size, unsigned at, uint8_t length)
{
    unsigned sum = 0;
    if (ring[at] != 0xFF) return false;
    for (uint8_t i = 0; i != length - 1; i++) {
        sum += ring[at];
        if (++at == size) at = 0;
    }
    return (sum & 0xFF) == ring[at];
}

bool rig_is_valid(const uint8_t *frame, uint8_t length) { return is_valid_in_ring(frame, length, 0, length); }

bool rig_has_two_alignments(const uint8_t *frame, uint8_t length)
{
    for (uint8_t shift = 1; shift != length; shift++)
        if (is_valid_in_ring(frame, length, shift, length)) return true;
    return false;
}

static struct {
    fathom_stream_t stream;
    fathom_stream_config_t config;
    uint8_t storage[FATHOM_STREAM_STORAGE(FATHOM_DYP_MAX_LENGTH)];
    const uint8_t *sent;
    uint8_t length;
    bool gaps;
    unsigned next; /* the first frame that was neither shown nor passed over */
    rig_outcome_t outcome;
} rig;

/*
 * The bytes before `end` have been fed: what may be shown now? With gaps seen the last whole frame; without, the
 * newest that was whole before the byte that shows that it ended, or an older one, but none from before the last
 * that was shown.
 */
static void judge(unsigned end, uint32_t now_us)
{
    const uint8_t *const frame = fathom_stream_frame(&rig.stream);
    if (fathom_stream_poll(&rig.stream, now_us) != FATHOM_OK) return;
    const unsigned whole = (rig.gaps ? end : end - 1) / rig.length;
    const unsigned oldest = rig.gaps && whole > rig.next ? whole - 1 : rig.next;
    for (unsigned at = whole; at-- > oldest;) {
        if (memcmp(frame, rig.sent + at * rig.length, rig.length) != 0) continue;
        if (rig.outcome.right++ == 0) rig.outcome.first = at;
        rig.next = at + 1;
        return;
    }
    rig.outcome.wrong++;
}

static void feed(unsigned at, unsigned count, bool after_gap, uint32_t now_us)
{
    fathom_stream_feed(&rig.stream, rig.sent + at, (uint8_t)count, after_gap, now_us);
    judge(at + count, now_us);
}

static uint32_t arrival_us(unsigned at)
{
    return at * (uint32_t)BYTE_US + (rig.gaps ? at / rig.length * (uint32_t)PAUSE_US : 0);
}

/* A loop that comes round every 20 ms, begun at any time; an empty one has seen a silence. */
static void feed_every_20_ms(unsigned at, unsigned end)
{
    bool silent = rig.gaps && at == 0; /* the pause before the first frame was seen, too */
    uint32_t now_us = arrival_us(at) + rig_random_below(LOOP_US);
    for (; at != end; now_us += LOOP_US) {
        unsigned to = at;
        while (to != end && arrival_us(to) <= now_us) to++;
        if (to != at)
            feed(at, to - at, silent, now_us);
        else
            judge(at, now_us);
        silent = to == at;
        at = to;
    }
    if (rig.gaps) judge(end, now_us);
}

static void feed_chunks(unsigned at, unsigned end, unsigned longest)
{
    for (unsigned count = 0; at != end; at += count) {
        const unsigned left = rig.gaps ? rig.length - at % rig.length : end - at;
        count = longest != 1 ? 1 + rig_random_below(longest) : 1;
        if (count > left) count = left;
        const uint32_t now_us = arrival_us(at + count - 1);
        feed(at, count, rig.gaps && at % rig.length == 0, now_us);
        if (rig.gaps && (at + count) % rig.length == 0) judge(at + count, now_us + GAP_US);
    }
}

rig_outcome_t rig_feed(const uint8_t *sent, unsigned frames, uint8_t length, uint8_t start, bool gaps,
                       int way)
{
    const unsigned end = frames * length;
    rig.config = (fathom_stream_config_t){.storage = rig.storage, .length = length};
    rig.sent = sent;
    rig.length = length;
    rig.gaps = gaps;
    rig.next = start != 0;
    rig.outcome = (rig_outcome_t){0, 0, UINT_MAX, 0, rig.stream.counters};
    memset(rig.storage, 0xFF, sizeof rig.storage);
    assert_in_range(frames, 1, RIG_MAX_FRAMES);
    assert_int_equal(fathom_stream_init(&rig.stream, &rig.config, 0), FATHOM_OK);
    if (way == RIG_EVERY_20_MS)
        feed_every_20_ms(start, end);
    else
        feed_chunks(start, end, way == RIG_BY_BYTE ? 1 : LONGEST_CHUNK);
    for (unsigned at = start; at + length <= end; at++) {
        if (gaps && at % length != 0) continue; /* a frame does not reach across a pause */
        rig.outcome.windows += is_valid_in_ring(sent, end, at, length);
    }
    return rig.outcome;
}
