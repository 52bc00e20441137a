/* SPDX-License-Identifier: MIT */
#include "sim_bench.h"

/* What a hook is to do with the next frames. */
typedef struct {
    int seen;
    bool last_automatic;
    uint8_t flip; /* bit of byte 3 */
    bool drop, longer;
    uint8_t length; /* 0: as it is */
    uint32_t delay_us;
    uint8_t copy[FATHOM_SIM_MAX_FRAME], copied;
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

static plan_t in, out;
static fathom_sim_faults_t faults;

static void set(uint8_t mode)
{
    memset(&in, 0, sizeof in);
    memset(&out, 0, sizeof out);
    faults = (fathom_sim_faults_t){.outgoing = outgoing, .ctx = &out};
    bench_begin(&bench_9600, false);
    bench.fixed = FIXED(751);
    add_a16(mode, (a16_config_t){.faults = &faults});
}

EACH_BEGINS(set(FATHOM_SIM_A16_MODBUS))
static const suite_t suite = {BENCH_ROUNDS, .set_up = begins};

TEST(a_hook_that_does_nothing_changes_nothing)
{
    transact(A16_ASKED, 200, A16_RESPONSE);
    assert_int_equal(out.seen, 1);
    assert_false(out.last_automatic);
    assert_int_equal(out.copied, 7);
    faults.outgoing = NULL;
    transact(A16_ASKED, 200, A16_RESPONSE);
    assert_int_equal(out.seen, 1);
}

TEST(a_response_can_be_shorter_or_longer)
{
    out.length = 4;
    transact(A16_ASKED, 200, "01 03 02 02");
    out.length = 0;
    out.longer = true;
    for (int i = 0; i < 4; i++) {
        ask(A16_ASKED, 100);
        for (int part = 0; part < 5; part++) wait_ms(100); /* 255 characters: 266 ms */
        assert_int_equal(bench.heard, 255);
        assert_int_equal(bench.bytes[254], 0xEE);
        forget();
    }
}

TEST(automatic_frames_pass_the_hook_too_and_keep_their_period)
{
    set(FATHOM_SIM_A16_AUTO);
    out.flip = 0x01;
    out.delay_us = 30 * MS;
    const uint32_t start_us = bench.now_us;
    wait_ms(250);
    ASSERT_SPAN(bench.end_us[0], start_us, 131042, 131042);
    ASSERT_SPAN(bench.end_us[4], start_us, 231042, 231042);
    expect("FF 02 EF F1 FF 02 EF F1");
    assert_true(out.last_automatic);
    out.drop = true;
    hear(500, "");
    assert_int_equal(out.seen, 7);
}

TEST(a_frame_delayed_over_its_period_skips_those_it_covers)
{
    set(FATHOM_SIM_A16_AUTO);
    out.delay_us = 250 * MS;
    const uint32_t start_us = bench.now_us;
    wait_ms(1000);
    /* due at 100, leaves at 350; at 354 the one of 200 is overdue and leaves 250 later; and so on */
    assert_int_equal(bench.heard, 12);
    ASSERT_SPAN(bench.end_us[0], start_us, 351042, 351042);
    ASSERT_SPAN(bench.end_us[4], start_us, 605208, 605209);
    forget();
    out.delay_us = 0;
    wait_ms(260);
    /* the delayed one at 1108, one that was due meanwhile, that of 1200: no burst of what was missed */
    assert_int_equal(bench.heard, 12);
    forget();
    wait_ms(145);
    ASSERT_SPAN(bench.end_us[0], start_us, 1301042, 1301042);
    assert_int_equal(bench.heard, 8);
}

TEST(a_delay_counts_from_the_end_of_the_frame_before)
{
    set(FATHOM_SIM_A16_AUTO);
    out.delay_us = 30 * MS;
    const uint32_t start_us = bench.now_us;
    ask(A16_ASKED, 180); /* answered between 113 and 128 ms, the frame lasts from 130 to 134 */
    ASSERT_SPAN(bench.end_us[4], start_us, 165208, 165209);
    expect(A16_FRAME A16_RESPONSE);
}

TEST(a_request_can_be_missed_or_heard_wrong)
{
    faults.outgoing = NULL;
    faults.incoming = incoming;
    faults.ctx = &in;
    in.drop = true;
    transact(A16_ASKED, 200, "");
    assert_int_equal(bench.a16.device.counters.requests + bench.a16.device.counters.crc_errors, 0);
    in.drop = false;
    in.flip = 0x80;
    transact(A16_ASKED, 200, "");
    COUNTED(.crc_errors = 1);
    in.flip = 0;
    transact(A16_ASKED, 200, A16_RESPONSE);
    assert_int_equal(in.seen, 3);
}
