/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fathom/sensor/a05_auto.h"
#include "stream_rig.h"

/*
 * An A05 that sends by itself, its probes moving at random among few values so that frames often hold an FF and
 * look like each other, read by its driver through a line in simulated time. The four samples of a response must
 * be the four of one of the last frames, each in its place. Of some frames one byte is lost or one bit flipped.
 * 5000 frames, or 500 where the loop comes round a thousand times in each; with FATHOM_LONG always 20000.
 */
enum { LENGTH = 10, BYTE_US = 1042, WIRE = 256, KEPT = 4 };

static const uint16_t shown[] = {0x01FF, 0x03FF, 0x05FF, 0x03E8, 0x07D0,
                                 0x07FF, 0x053B, 0x0DEA, 0x0101, 0x00FF};
enum { SHOWN = sizeof shown / sizeof shown[0] };

static struct {
    uint32_t now_us;
    uint32_t next_us; /* when the next byte of the sensor has come */
    uint32_t pause_us;
    unsigned lose, flip; /* one frame in so many */
    uint8_t frame[LENGTH];
    uint16_t probes[KEPT][4]; /* of the frame that is sent, and of those before it */
    uint8_t at;
    uint8_t lost; /* this byte of the frame; LENGTH: none */
    unsigned sent;
    uint8_t wire[WIRE];
    size_t waiting;
} world;

static void make_frame(void)
{
    memmove(world.probes[1], world.probes[0], sizeof world.probes - sizeof world.probes[0]);
    for (unsigned i = 0; i != 4; i++) world.probes[0][i] = shown[rig_random_below(SHOWN)];
    rig_make_frame(world.frame, LENGTH, world.probes[0]);
    world.lost =
        world.lose != 0 && rig_random_below(world.lose) == 0 ? (uint8_t)rig_random_below(LENGTH) : LENGTH;
    if (world.flip != 0 && rig_random_below(world.flip) == 0)
        world.frame[rig_random_below(LENGTH)] ^= (uint8_t)(1u << rig_random_below(8));
}

static void live(uint32_t until_us)
{
    while ((int32_t)(until_us - world.next_us) >= 0) {
        if (world.at == 0) make_frame();
        if (world.at != world.lost && world.waiting != WIRE)
            world.wire[world.waiting++] = world.frame[world.at];
        world.next_us += BYTE_US;
        if (++world.at != LENGTH) continue;
        world.at = 0;
        world.sent++;
        world.next_us += world.pause_us;
    }
    world.now_us = until_us;
}

static int world_read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    size_t length = world.waiting < capacity ? world.waiting : capacity;
    (void)ctx, (void)rx;
    if (length > 1) length = 1 + rig_random_below((uint32_t)length);
    memcpy(bytes, world.wire, length);
    world.waiting -= length;
    memmove(world.wire, world.wire + length, world.waiting);
    return (int)length;
}

static int world_write(void *ctx, const uint8_t *bytes, size_t length)
{
    (void)ctx, (void)bytes, (void)length;
    return -1; /* an automatic sensor is not asked anything */
}

static bool world_sent(void *ctx) { return (void)ctx, true; }

static uint32_t world_now_us(void *ctx) { return (void)ctx, world.now_us; }

typedef struct {
    unsigned right, wrong;
} outcome_t;

static bool was_sent(const uint16_t probes[4])
{
    for (unsigned i = 0; i != KEPT; i++)
        if (memcmp(world.probes[i], probes, sizeof world.probes[i]) == 0) return true;
    return false;
}

static unsigned frames(uint32_t loop_us) { return suite_is_long ? 20000 : loop_us < 1000 ? 500 : 5000; }

static outcome_t run(uint32_t pause_us, uint32_t loop_us, unsigned lose, unsigned flip, uint32_t seed)
{
    static const fathom_uart_t uart = {.read = world_read, .write = world_write, .sent = world_sent};
    static const fathom_clock_t clock = {world_now_us, NULL};
    uint8_t frame[16];
    const fathom_line_parts_t line_parts = {.uart = &uart,
                                            .clock = &clock,
                                            .frame = frame,
                                            .frame_size = sizeof frame,
                                            .echo = FATHOM_LINE_ECHO_OFF,
                                            .marks = fathom_line_marks};
    fathom_line_t line;
    fathom_a05_auto_t sensor;
    outcome_t outcome = {0, 0};
    memset(&world, 0, sizeof world);
    rig_seed(seed);
    world.now_us = UINT32_MAX - 20000000; /* the clock wraps on the way */
    world.next_us = world.now_us + 777;
    world.pause_us = pause_us;
    world.lose = lose;
    world.flip = flip;
    world.lost = LENGTH;
    assert_int_equal(fathom_line_init(&line, &line_parts), FATHOM_OK);
    assert_int_equal(fathom_a05_auto_init(&sensor, &line, NULL), FATHOM_OK);
    const fathom_sensor_t handle = fathom_a05_auto_sensor(&sensor);
    while (world.sent < frames(loop_us)) {
        fathom_sample_t sample;
        fathom_status_t status;
        uint16_t probes[4] = {0};
        live(world.now_us + 1 + rig_random_below(2 * loop_us));
        while ((status = fathom_poll(&handle, &sample)) != FATHOM_PENDING) {
            if (status != FATHOM_OK) continue;
            probes[sample.probe - 1] = sample.distance_mm;
            if (sample.probe != 4) continue;
            if (was_sent(probes))
                outcome.right++;
            else
                outcome.wrong++;
        }
    }
    return outcome;
}

/* Frames of 10.4 ms and pauses of 90 ms, and a loop that sees each pause. */
TEST(with_pauses_seen_no_frame_is_lost_and_none_is_wrong)
{
    static const uint32_t loops_us[] = {100, 1000, 5000, 20000};
    for (size_t i = 0; i != sizeof loops_us / sizeof loops_us[0]; i++) {
        const outcome_t outcome = run(90000, loops_us[i], 0, 0, 1 + (uint32_t)i);
        assert_int_equal(outcome.wrong, 0);
        assert_in_range(outcome.right, frames(loops_us[i]) - 3, frames(loops_us[i]));
    }
}

TEST(with_a_byte_lost_or_a_bit_flipped_in_every_fifth_frame_none_is_wrong)
{
    for (uint32_t seed = 10; seed != 14; seed++) {
        const outcome_t outcome = run(90000, 2000, 10, 10, seed);
        assert_int_equal(outcome.wrong, 0);
        assert_in_range(outcome.right, frames(2000) / 100 * 75, frames(2000) / 100 * 85);
    }
}

/* A loop so slow that it never sees the line silent: then frames are believed only in step with another. */
TEST(without_pauses_seen_shifted_frames_are_not_shown)
{
    for (uint32_t seed = 20; seed != 24; seed++) {
        const outcome_t outcome = run(0, 3000, 50, 50, seed);
        assert_int_equal(outcome.wrong, 0);
        assert_true(outcome.right > frames(3000) / 4);
    }
}
