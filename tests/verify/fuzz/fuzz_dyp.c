/* SPDX-License-Identifier: MIT */
#include "fathom/codec/dyp_55aa.h"
#include "fathom/codec/dyp_stream.h"
#include "fathom/engine/stream.h"
#include "fuzz.h"

/* dyp_55aa.h, dyp_stream.h and stream.h. The first byte says which part. */

/* ---- 55 AA ---- */

enum { START = 0x55, SECOND = 0xAA };

/* A05 2(3). */
static uint8_t length_of(uint8_t command)
{
    if (command == 1) return 13;
    if (command == 3) return 5;
    return command >= 0x10 && command <= 0x13 ? 7 : 0;
}

static void check_bytes(const uint8_t *bytes, uint8_t have)
{
    const uint8_t length = fathom_dyp_55aa_frame_length(bytes, have);
    bool begins = bytes[0] == START && (have < 2 || bytes[1] == SECOND);
    if (begins && have >= 4) begins = length_of(bytes[3]) != 0;
    PROMISE(begins || length == 0, "dyp_55aa.h: 0: no response begins like this");
    if (!begins || have < 4) {
        PROMISE(!begins || length > have || length == 0, "dyp_55aa.h: > have: more are needed to know");
        return;
    }
    PROMISE(length == length_of(bytes[3]) || bytes[2] == 0 || bytes[2] == 0xFF,
            "dyp_55aa.h: the length of a response");
    PROMISE(fathom_dyp_55aa_is_valid(bytes, have) == (fuzz_sum(bytes, have - 1u) == bytes[have - 1]),
            "dyp_55aa.h: do they end in the sum of those before?");
    if (length == 0 || have < length) return;
    uint16_t values[4];
    uint8_t back[13];
    memset(values, FUZZ_GUARD, sizeof values);
    uint8_t frame[13];
    memcpy(frame, bytes, length);
    frame[length - 1] = fuzz_sum(frame, length - 1u);
    fathom_dyp_55aa_decode(frame, values);
    const uint8_t count = fathom_dyp_55aa_value_count(bytes[3]);
    PROMISE(count == (length - 5) / 2, "dyp_55aa.h: how many distances");
    for (uint8_t i = 0; i != count; i++)
        PROMISE(values[i] == fuzz_word_at(frame + 4 + 2 * i), "dyp_55aa.h: the distances, as they were sent");
    PROMISE(fuzz_is_guard(values + count, 2u * (size_t)(4 - count)), "dyp_55aa.h: no other is written");
    PROMISE(fathom_dyp_55aa_encode_response(back, frame[2], frame[3], values) == length &&
                memcmp(back, frame, length) == 0,
            "dyp_55aa.h: what was read is written as the same bytes");
}

static void codec_55aa(void)
{
    const uint8_t address = fuzz_byte();
    const uint8_t command = fuzz_byte();
    PROMISE(fathom_dyp_55aa_response_length(command) == length_of(command),
            "dyp_55aa.h: 13, 7 or 5; 0: no command");
    uint8_t *const request = fuzz_guarded(5);
    PROMISE(fathom_dyp_55aa_encode_request(request, address, command) == 5, "dyp_55aa.h: 5 bytes");
    PROMISE(request[0] == START && request[1] == SECOND && request[2] == address && request[3] == command &&
                request[4] == fuzz_sum(request, 4),
            "dyp_55aa.h: 55 AA ADDRESS COMMAND SUM");
    free(request);
    size_t have;
    uint8_t *const bytes = fuzz_rest(20, &have);
    for (size_t i = 1; i <= have; i++) {
        uint8_t *const seen = fuzz_copy(bytes, i);
        check_bytes(seen, (uint8_t)i);
        free(seen);
    }
    free(bytes);
}

/* ---- FF ... SUM ---- */

static void codec_stream(uint8_t part)
{
    const uint8_t probes = (part & 4) != 0 ? 4 : 1;
    const uint8_t length = (uint8_t)(2 * probes + 2);
    uint8_t *const frame = fuzz_guarded(length);
    uint16_t *const values = fuzz_guarded(2u * probes);
    uint8_t back[10];
    for (uint8_t i = 0; i != length; i++) frame[i] = fuzz_byte();
    if ((part & 8) != 0) frame[0] = 0xFF;
    if ((part & 16) != 0) frame[length - 1] = fuzz_sum(frame, length - 1u);
    const bool is_valid = frame[0] == 0xFF && frame[length - 1] == fuzz_sum(frame, length - 1u);
    PROMISE(fathom_dyp_checksum(frame, length) == fuzz_sum(frame, length),
            "dyp_stream.h: the low byte of the sum");
    PROMISE(fathom_dyp_stream_is_valid(frame, length) == is_valid, "dyp_stream.h: FF, and their sum");
    fathom_dyp_stream_decode(frame, values, probes);
    for (uint8_t i = 0; i != probes; i++)
        PROMISE(values[i] == fuzz_word_at(frame + 1 + 2 * i),
                "dyp_stream.h: the distances, as they were sent");
    PROMISE(fathom_dyp_stream_encode(back, values, probes) == length, "dyp_stream.h: 4 or 10");
    if (is_valid)
        PROMISE(memcmp(back, frame, length) == 0, "dyp_stream.h: what was read is written as the same bytes");
    free(values);
    free(frame);
}

/* ---- the engine ---- */

enum { MOST = 256, GAP_US = 5000 };

static struct {
    fathom_stream_t stream;
    uint32_t now_us;
    uint32_t fed_us;   /* when bytes were fed last */
    uint32_t since_us; /* the last outcome */
    uint32_t stale_us;
    size_t count;
    uint8_t length;
    uint8_t bytes[MOST];    /* all that was fed, ... */
    uint32_t time_us[MOST]; /* ... when, ... */
    bool after_gap[MOST];   /* ... and whether after a silence that was said, ... */
    bool after_loss[MOST];  /* ... or a loss */
    size_t given;           /* frames up to here were given */
} world;

static bool is_frame(size_t at)
{
    const uint8_t *const frame = world.bytes + at;
    if (frame[0] != 0xFF || frame[world.length - 1] != fuzz_sum(frame, world.length - 1u)) return false;
    for (size_t i = at + 1; i != at + world.length; i++)
        if (world.after_loss[i]) return false;
    return true;
}

/* stream.h: in a believable place, and what comes next shows that it has ended. */
static bool is_believable(size_t at)
{
    const size_t end = at + world.length;
    const bool is_first = world.after_gap[at];
    const bool is_upon = at >= world.length && !world.after_loss[at] && is_frame(at - world.length);
    const bool is_ended = end == world.count ? fathom_elapsed_us(world.now_us, world.fed_us) >= GAP_US
                                             : world.after_gap[end] || world.bytes[end] == 0xFF;
    return (is_first || is_upon) && is_ended;
}

static void check_frame(void)
{
    const uint8_t *const frame = fathom_stream_frame(&world.stream);
    for (size_t at = world.count; at-- != 0;) {
        if (at + world.length > world.count || memcmp(world.bytes + at, frame, world.length) != 0) continue;
        if (!is_frame(at) || !is_believable(at) ||
            world.time_us[at + world.length - 1] != world.stream.time_us)
            continue;
        PROMISE(at + world.length > world.given, "stream.h: each frame is given once");
        world.given = at + world.length;
        return;
    }
    fuzz_broken(__FILE__, __LINE__,
                "stream.h: a frame is believed only in a believable place, and where it has ended");
}

static fathom_status_t poll(void)
{
    const fathom_status_t status = fathom_stream_poll(&world.stream, world.now_us);
    if (status == FATHOM_OK) check_frame();
    if (status == FATHOM_ERR_STALE || status == FATHOM_ERR_CHECKSUM)
        PROMISE(fathom_elapsed_us(world.now_us, world.since_us) >= world.stale_us,
                "stream.h: an error after stale_us");
    else
        PROMISE(status == FATHOM_OK || status == FATHOM_PENDING, "stream.h: what poll returns");
    if (status != FATHOM_PENDING) world.since_us = world.now_us;
    return status;
}

static void feed(uint8_t how)
{
    uint8_t bytes[16];
    uint8_t count = (uint8_t)(1 + (how >> 4));
    const bool is_late = fathom_elapsed_us(world.now_us, world.fed_us) >= GAP_US;
    const bool after_gap = (how & 8) != 0 && is_late;
    if (world.count + count + 10 > MOST) return;
    for (uint8_t i = 0; i != count; i++) bytes[i] = fuzz_byte();
    if ((how & 4) != 0 && count >= 4) { /* what ends in its sum is rare */
        bytes[count - 4] = 0xFF;
        bytes[count - 1] = fuzz_sum(bytes + count - 4, 3);
    }
    for (uint8_t i = 0; i != count; i++) {
        world.time_us[world.count] = world.now_us;
        world.after_gap[world.count] = after_gap && i == 0;
        world.bytes[world.count++] = bytes[i];
        world.after_loss[world.count] = world.after_gap[world.count] = false;
    }
    fathom_stream_feed(&world.stream, bytes, count, after_gap, world.now_us);
    /* stream.h has one time for what came together: that of the last byte */
    world.fed_us = world.now_us;
}

/* Until the next outcome nothing comes: it is due exactly then. */
static void wait_for_outcome(void)
{
    const uint32_t due_us = fathom_stream_due_us(&world.stream, world.now_us);
    PROMISE(due_us <= world.stale_us, "stream.h: it is stale then at the latest");
    if (due_us > 1) {
        world.now_us += due_us - 1;
        PROMISE(poll() == FATHOM_PENDING, "stream.h: due_us: nothing before");
        world.now_us += 1;
    } else {
        world.now_us += due_us;
    }
    PROMISE(poll() != FATHOM_PENDING, "stream.h: due_us: OK or STALE then");
}

static void engine(uint8_t part)
{
    static const uint32_t stale_us[] = {100000, FATHOM_STREAM_DEFAULT_STALE_US};
    world.length = (part & 4) != 0 ? 10 : 4;
    world.stale_us = stale_us[part >> 3 & 1];
    world.count = world.given = 0;
    world.after_gap[0] = world.after_loss[0] = false;
    world.now_us = world.since_us = (uint32_t)fuzz_word() << 16;
    world.fed_us = world.now_us;
    uint8_t *const storage = fuzz_guarded(FATHOM_STREAM_STORAGE(world.length));
    const fathom_stream_config_t config = {
        .storage = storage, .stale_us = part >> 3 & 1 ? 0 : world.stale_us, .length = world.length};
    PROMISE(fathom_stream_init(&world.stream, &config, world.now_us) == FATHOM_OK, "stream.h: init");
    while (fuzz_more()) {
        const uint8_t how = fuzz_byte();
        switch (how & 3) {
        case 0:
            feed(how);
            break;
        case 1:
            world.now_us += (how & 4) != 0 ? fuzz_byte() * 500u : 1042;
            break;
        case 2:
            wait_for_outcome();
            break;
        default:
            if ((how & 4) == 0) {
                (void)poll();
                break;
            }
            fathom_stream_feed(&world.stream, NULL, 0, false, world.now_us);
            world.after_loss[world.count] = true;
        }
    }
    wait_for_outcome();
    free(storage);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_begin(data, size);
    const uint8_t part = fuzz_byte();
    if (part % 4 == 0) codec_55aa();
    if (part % 4 == 1) codec_stream(part);
    if (part % 4 >= 2) engine(part);
    return 0;
}
