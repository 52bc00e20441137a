/* SPDX-License-Identifier: MIT */
#include "bench.h"

#include <string.h>

#include "sim/a16.h"
#include "sim/scene.h"

enum { MS = 1000 };

/* What a hook is to do with the next frames. */
typedef struct {
    int seen;
    bool last_automatic;
    uint8_t flip; /* bit of byte 3 */
    bool drop;
    bool longer;
    uint8_t length; /* 0: as it is */
    uint32_t delay_us;
    uint8_t copy[FATHOM_SIM_MAX_FRAME];
    uint8_t copied;
} plan_t;

static void outgoing(void *ctx, fathom_sim_frame_t *frame)
{
    plan_t *const plan = (plan_t *)ctx;
    plan->seen++;
    plan->last_automatic = frame->automatic;
    assert_int_equal(frame->delay_us, 0);
    memcpy(plan->copy, frame->bytes, frame->length);
    plan->copied = frame->length;
    frame->bytes[3] = (uint8_t)(frame->bytes[3] ^ plan->flip);
    frame->delay_us = plan->delay_us;
    if (plan->length != 0) frame->length = plan->length;
    if (plan->longer) {
        memset(frame->bytes + frame->length, 0xEE, (size_t)(FATHOM_SIM_MAX_FRAME - frame->length));
        frame->length = FATHOM_SIM_MAX_FRAME;
    }
    if (plan->drop) frame->length = 0;
}

static void incoming(void *ctx, fathom_sim_frame_t *frame)
{
    plan_t *const plan = (plan_t *)ctx;
    plan->seen++;
    frame->bytes[3] = (uint8_t)(frame->bytes[3] ^ plan->flip);
    if (plan->drop) frame->length = 0;
}

typedef struct {
    bench_t bench;
    plan_t in, out;
    fathom_sim_faults_t faults;
    fathom_sim_fixed_t fixed;
    fathom_sim_a16_t a16;
} stage_t;

static void set(stage_t *s, uint8_t mode)
{
    memset(s, 0, sizeof *s);
    fathom_sim_a16_config_t config = {.mode = mode, .faults = &s->faults};
    bench_init(&s->bench, &bench_9600);
    s->fixed.value[0] = 751;
    config.scene = fathom_sim_fixed(&s->fixed);
    s->faults.ctx = &s->out;
    s->faults.outgoing = outgoing;
    fathom_sim_a16_init(&s->a16, &config);
    bench_attach(&s->bench, &s->a16.device);
}

#define REQUEST 0x01, 0x03, 0x01, 0x01, 0x00, 0x01, 0xD4, 0x36
#define ANSWER  0x01, 0x03, 0x02, 0x02, 0xEF, 0xF8, 0xA8

static const suite_t suite = {BENCH_ROUNDS};

TEST(a_hook_that_does_nothing_changes_nothing)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_MODBUS);
    ASK(&s.bench, 200 * MS, REQUEST);
    EXPECT(&s.bench, ANSWER);
    assert_int_equal(s.out.seen, 1);
    assert_false(s.out.last_automatic);
    assert_int_equal(s.out.copied, 7);
    s.faults.outgoing = NULL;
    ASK(&s.bench, 200 * MS, REQUEST);
    EXPECT(&s.bench, ANSWER);
    assert_int_equal(s.out.seen, 1);
}

TEST(an_answer_can_come_after_a_time_out_and_keeps_the_device_busy)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_MODBUS);
    s.out.delay_us = 700 * MS;
    const uint32_t end_us = ASK(&s.bench, 400 * MS, REQUEST);
    EXPECT_SILENCE(&s.bench);
    ASK(&s.bench, 500 * MS, REQUEST); /* the host asks again, in vain */
    ASSERT_SPAN(s.bench.end_us[0], end_us, 805 * MS, 822 * MS);
    EXPECT(&s.bench, ANSWER);
    bench_wait(&s.bench, 2000 * MS);
    EXPECT_SILENCE(&s.bench);
    assert_int_equal(s.a16.device.counters.requests, 1);
    assert_int_equal(s.a16.device.counters.unheard, 8);
}

TEST(a_bit_can_be_flipped)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_MODBUS);
    s.out.flip = 0x10;
    ASK(&s.bench, 200 * MS, REQUEST);
    EXPECT(&s.bench, 0x01, 0x03, 0x02, 0x12, 0xEF, 0xF8, 0xA8);
}

TEST(an_answer_can_be_lost_and_the_device_is_free_at_once)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_MODBUS);
    s.out.drop = true;
    ASK(&s.bench, 130 * MS, REQUEST);
    EXPECT_SILENCE(&s.bench);
    assert_int_equal(s.a16.device.counters.answered, 1);
    s.out.drop = false;
    ASK(&s.bench, 200 * MS, REQUEST);
    EXPECT(&s.bench, ANSWER);
}

TEST(an_answer_can_be_shorter_or_longer)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_MODBUS);
    s.out.length = 4;
    ASK(&s.bench, 200 * MS, REQUEST);
    EXPECT(&s.bench, 0x01, 0x03, 0x02, 0x02);
    s.out.length = 0;
    s.out.longer = true;
    for (int i = 0; i < 4; i++) {
        ASK(&s.bench, 100 * MS, REQUEST);
        for (int part = 0; part < 5; part++) bench_wait(&s.bench, 100 * MS); /* 255 characters: 266 ms */
        assert_int_equal(s.bench.heard, 255);
        assert_int_equal(s.bench.bytes[254], 0xEE);
        bench_forget(&s.bench);
    }
}

TEST(automatic_frames_pass_the_hook_too_and_keep_their_period)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_AUTO);
    s.out.flip = 0x01;
    s.out.delay_us = 30 * MS;
    const uint32_t start_us = s.bench.now_us;
    bench_wait(&s.bench, 250 * MS);
    ASSERT_SPAN(s.bench.end_us[0], start_us, 131042, 131042);
    ASSERT_SPAN(s.bench.end_us[4], start_us, 231042, 231042);
    EXPECT(&s.bench, 0xFF, 0x02, 0xEF, 0xF1, 0xFF, 0x02, 0xEF, 0xF1);
    assert_true(s.out.last_automatic);
    s.out.drop = true;
    bench_wait(&s.bench, 500 * MS);
    EXPECT_SILENCE(&s.bench);
    assert_int_equal(s.out.seen, 7);
}

TEST(a_frame_delayed_over_its_period_skips_those_it_covers)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_AUTO);
    s.out.delay_us = 250 * MS;
    const uint32_t start_us = s.bench.now_us;
    bench_wait(&s.bench, 1000 * MS);
    /* due at 100, leaves at 350; at 354 the one of 200 is overdue and leaves 250 later; and so on */
    assert_int_equal(s.bench.heard, 12);
    ASSERT_SPAN(s.bench.end_us[0], start_us, 351042, 351042);
    ASSERT_SPAN(s.bench.end_us[4], start_us, 605208, 605209);
    bench_forget(&s.bench);
    s.out.delay_us = 0;
    bench_wait(&s.bench, 260 * MS);
    /* the delayed one at 1108, one that was due meanwhile, that of 1200: no burst of what was missed */
    assert_int_equal(s.bench.heard, 12);
    bench_forget(&s.bench);
    bench_wait(&s.bench, 145 * MS);
    ASSERT_SPAN(s.bench.end_us[0], start_us, 1301042, 1301042);
    assert_int_equal(s.bench.heard, 8);
}

TEST(a_delay_counts_from_the_end_of_the_frame_before)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_AUTO);
    s.out.delay_us = 30 * MS;
    const uint32_t start_us = s.bench.now_us;
    ASK(&s.bench, 180 * MS, REQUEST); /* answered between 113 and 128 ms, the frame lasts from 130 to 134 */
    ASSERT_SPAN(s.bench.end_us[4], start_us, 165208, 165209);
    EXPECT(&s.bench, 0xFF, 0x02, 0xEF, 0xF0, ANSWER);
}

TEST(a_request_can_be_missed_or_heard_wrong)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_MODBUS);
    s.faults.outgoing = NULL;
    s.faults.incoming = incoming;
    s.faults.ctx = &s.in;
    s.in.drop = true;
    ASK(&s.bench, 200 * MS, REQUEST);
    EXPECT_SILENCE(&s.bench);
    assert_int_equal(s.a16.device.counters.requests + s.a16.device.counters.crc_errors, 0);
    s.in.drop = false;
    s.in.flip = 0x80;
    ASK(&s.bench, 200 * MS, REQUEST);
    EXPECT_SILENCE(&s.bench);
    assert_int_equal(s.a16.device.counters.crc_errors, 1);
    s.in.flip = 0;
    ASK(&s.bench, 200 * MS, REQUEST);
    EXPECT(&s.bench, ANSWER);
    assert_int_equal(s.in.seen, 3);
}
