/* SPDX-License-Identifier: MIT */
#include "second_damage.h"

#include "second_why.h"

#include <string.h>

#include "suite.h"

damage_heard_t damage_heard;

/* ---- Frames ---- */

enum { SLOWEST_LOOP_US = 20000 };

static struct {
    uint64_t since_us;    /* the driver counts stale_us from here */
    uint64_t next_event;  /* the first event of the log that was not counted yet */
    uint64_t first_bytes; /* number of bytes that had arrived at the beginning */
    uint32_t stale_us;
} at;

/* The byte `back` bytes before the newest one. */
#define RIG_BYTE(back)                                                                                       \
    (judge.rig->bytes[(judge.rig->first + judge.rig->count + RIG_BYTES - 1 - (back)) % RIG_BYTES])

/* Returns true if the ring still has this byte, and it arrived after damage_begin(). */
static bool has_byte(size_t back)
{
    return back < RIG_BYTES && back < judge.rig->received_count - at.first_bytes;
}

/* Returns true if a byte arrived less than `age_us` before now, but not in the last `newest_us`. */
static bool is_heard(uint64_t age_us, uint64_t newest_us)
{
    for (size_t back = 0; has_byte(back) && RIG_BYTE(back).end_us + age_us > judge.rig->now_us; back++) {
        if (RIG_BYTE(back).end_us + newest_us <= judge.rig->now_us) return true;
    }
    return false;
}

static bool is_sum_right(const uint8_t *bytes, size_t length)
{
    if (is_hps()) {
        return bytes[0] == judge.rig->device.address && bytes[1] == 0x03 && bytes[2] == 8 &&
               second_wire_crc16(bytes, length) == 0;
    }
    return bytes[0] == 0xFF && second_wire_sum8(bytes, length - 1) == bytes[length - 1];
}

/* Copies the bytes that arrived in the time of a frame. Returns false if the port marked a byte, or if the number of
 * bytes is not that of the frame. */
static bool get_frame(const second_event_t *frame, uint8_t bytes[SECOND_FRAME_MAX], bool *is_clean)
{
    size_t length = 0;
    *is_clean = true;
    for (size_t back = 0; has_byte(back) && RIG_BYTE(back).end_us > frame->start_us; back++) {
        if (RIG_BYTE(back).end_us > frame->end_us) continue;
        if (RIG_BYTE(back).is_foreign || RIG_BYTE(back).flags != 0 || length == frame->raw_len) return false;
        if (RIG_BYTE(back).is_wrong) *is_clean = false;
        length++;
        bytes[frame->raw_len - length] = RIG_BYTE(back).value;
    }
    return length == frame->raw_len;
}

frame_state_t damage_of(const second_event_t *frame, uint8_t bytes[SECOND_FRAME_MAX])
{
    bool is_clean;
    if (!get_frame(frame, bytes, &is_clean)) return FRAME_DAMAGED;
    if (is_clean) return FRAME_CLEAN;
    return is_sum_right(bytes, frame->raw_len) ? FRAME_UNSEEN : FRAME_DAMAGED;
}

uint16_t damage_value(const uint8_t *frame, unsigned probe)
{
    const uint8_t *value = frame + (is_hps() ? 3 : 2 * probe - 1);
    return (uint16_t)(value[0] << 8 | value[1]);
}

/* Returns true if a driver can count this damaged frame. */
static bool is_countable(const second_event_t *frame)
{
    uint8_t bytes[SECOND_FRAME_MAX];
    bool is_clean;
    enum { HEAD = 3 };
    return get_frame(frame, bytes, &is_clean) && (!is_hps() || memcmp(bytes, frame->raw, HEAD) == 0);
}

/* Counts the frames that have ended. */
static void count_frames(void)
{
    const second_device_t *d = &judge.rig->device;
    for (; at.next_event < second_log_count(d); at.next_event++) {
        uint8_t bytes[SECOND_FRAME_MAX];
        const second_event_t *e = second_log_at(d, at.next_event);
        if (e == NULL || e->kind != SECOND_EVENT_MEASUREMENT) continue;
        if (e->end_us > judge.rig->now_us) return;
        const frame_state_t state = damage_of(e, bytes);
        damage_heard.frames[state]++;
        if (state == FRAME_DAMAGED && is_countable(e)) damage_heard.countable++;
    }
}

/* ---- Outcomes ---- */

void damage_begin(uint32_t stale_us)
{
    memset(&damage_heard, 0, sizeof damage_heard);
    at.since_us = judge.rig->now_us;
    at.next_event = second_log_count(&judge.rig->device);
    at.first_bytes = judge.rig->received_count;
    at.stale_us = stale_us;
}

/* Returns true if the device sent an odd value, or if the checksum does not show the damage of a frame. */
static bool may_be_malformed(void)
{
    const second_device_t *d = &judge.rig->device;
    const reason_t why = judge_why(FATHOM_ERR_MALFORMED);
    if (why == BECAUSE_STRENGTH || why == BECAUSE_NO_DISTANCE) return true;
    for (uint64_t i = second_log_count(d); i-- > 0;) {
        uint8_t bytes[SECOND_FRAME_MAX];
        const second_event_t *e = second_log_at(d, i);
        if (e == NULL || e->time_us + 1000000 < at.since_us) return false;
        if (e->kind == SECOND_EVENT_MEASUREMENT && damage_of(e, bytes) == FRAME_UNSEEN) return true;
    }
    return false;
}

/* Returns true if a byte arrived that the driver must have heard since its newest outcome. */
static bool has_heard(void)
{
    static const uint32_t loops_us[RIG_LOOPS] = {
        [RIG_EVERY_1_MS] = 1000, [RIG_EVERY_7_MS] = 7000, [RIG_EVERY_20_MS] = 20000};
    if (at.stale_us != 0) return is_heard(judge.rig->now_us - at.since_us, 0);
    /* A response is in time from 80 to 130 ms after the trigger. */
    return is_heard(50000, loops_us[judge.rig->loop]);
}

static void judge_error(fathom_status_t status)
{
    /* If the next byte ended the frame, and not a silence, undecided bytes arrived before the sample. */
    const uint32_t undecided_us = judge.rig->loop == RIG_EVERY_20_MS ? SLOWEST_LOOP_US : 0;
    switch (status) {
    case FATHOM_ERR_CHECKSUM:
        damage_heard.damage_errors++;
        if (!is_heard(judge.rig->now_us - at.since_us + undecided_us, 0))
            judge_finding("'damaged', and the wire was silent", status);
        break;
    case FATHOM_ERR_STALE:
    case FATHOM_ERR_NO_RESPONSE:
        damage_heard.stale_errors++;
        if (has_heard()) judge_finding("'nothing arrived', and bytes arrived", status);
        break;
    case FATHOM_ERR_MALFORMED:
        if (!may_be_malformed()) judge_finding("'malformed', and no such frame arrived", status);
        break;
    default:
        judge_finding("an error that damage does not explain", status);
        break;
    }
}

static void judge_outcome(fathom_status_t status, const fathom_sample_t *sample)
{
    if (status == FATHOM_OK) {
        damage_heard.readings++;
        judge_sample(sample);
    } else {
        judge_error(status);
    }
    /* In hps167s_auto only a sample or a stale error starts this time. */
    if (status != FATHOM_ERR_MALFORMED || !is_hps()) at.since_us = judge.rig->now_us;
    judge_begin_again();
}

void damage_poll(const fathom_sensor_t *sensor, uint64_t us)
{
    const uint64_t end_us = judge.rig->now_us + us;
    while (judge.rig->now_us < end_us) {
        fathom_sample_t sample;
        const fathom_status_t status = fathom_poll(sensor, &sample);
        count_frames();
        if (status != FATHOM_PENDING) {
            judge_outcome(status, &sample);
            continue;
        }
        if (at.stale_us != 0 && judge.rig->now_us > at.since_us + at.stale_us + SLOWEST_LOOP_US) {
            judge_finding("no outcome, and it is stale", status);
            at.since_us = judge.rig->now_us;
        }
        rig_pass(judge.rig, fathom_due_us(sensor, 1));
    }
}

/* Returns the number of bytes that arrived without a mark of the port. */
static unsigned unmarked_bytes(void)
{
    return (unsigned)(judge.rig->received_count - at.first_bytes) - judge.rig->marked_count;
}

/*
 * Each byte is in an accepted frame, counted as dropped, or one of at most `length` bytes that are not decided yet. A
 * loop of 20 ms may see no silence. Then a stream does not know where a frame should stand (stream.h).
 */
void damage_end(damage_counted_t c)
{
    const damage_heard_t *h = &damage_heard;
    const unsigned length = is_hps() ? 13 : is_a05() ? 10 : 4;
    const unsigned good = h->frames[FRAME_CLEAN] + h->frames[FRAME_UNSEEN];
    /* The end of the life cuts one frame off. A frame directly before or behind the zeros may be refused. */
    const unsigned refused = judge.rig->zeros_until_us == 0 ? 1 : 2;
    const unsigned rest = unmarked_bytes() - length * c.frames;
    if (c.frames > good) judge_finding("more frames than arrived", (int)c.frames);
    if (c.dropped_bytes > rest || c.dropped_bytes + length < rest)
        judge_finding("the dropped bytes are not those in no frame", (int)c.dropped_bytes);
    if (judge.rig->damage == RIG_ONE_BIT && h->frames[FRAME_UNSEEN] != 0)
        judge_finding("a single wrong bit that the checksum does not see", (int)h->frames[FRAME_UNSEEN]);
    if (judge.rig->loop == RIG_EVERY_20_MS) return;
    if (c.frames + refused < good) judge_finding("frames that arrived well were refused", (int)c.frames);
    if (c.damaged < h->countable) judge_finding("damaged frames were not counted", (int)c.damaged);
    const bool may_break_apart = judge.rig->damage == RIG_LOSSES; /* each piece is counted */
    if (c.damaged > h->frames[FRAME_DAMAGED] + 1 && !may_break_apart)
        judge_finding("more damaged frames than arrived were counted", (int)c.damaged);
}
