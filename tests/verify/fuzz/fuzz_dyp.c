/* SPDX-License-Identifier: MIT */
#include "fathom/engine/stream.h"
#include "fuzz.h"

/* stream.h. proof/wp proves the codecs for every input. */

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

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const uint32_t stale_us[] = {100000, FATHOM_STREAM_DEFAULT_STALE_US};
    fuzz_begin(data, size);
    const uint8_t part = fuzz_byte();
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
    return 0;
}
