/* SPDX-License-Identifier: MIT */
/* What the HPS-167S does unasked, while it warms up, and without data from inside: all of them options. */
#include <string.h>

#include "bench.h"
#include "sim/fault.h"
#include "sim/hps167s.h"
#include "sim/scene.h"

enum { MS = 1000 };

typedef struct {
    bench_t bench;
    fathom_sim_fixed_t fixed;
    fathom_sim_hps167s_t hps;
} stage_t;

static void set(stage_t *stage, fathom_sim_hps167s_config_t config)
{
    bench_init(&stage->bench, &bench_19200);
    stage->fixed.value[0] = 2083;
    config.scene = fathom_sim_fixed(&stage->fixed);
    fathom_sim_hps167s_init(&stage->hps, &config);
    bench_attach(&stage->bench, &stage->hps.device);
}

/* The answer to #5 of the datasheet's example, the abnormal packet, and an exception to 03. */
#define EXAMPLE   0x01, 0x03, 0x08, 0x08, 0x23, 0xDC, 0xB2, 0x07, 0x01, 0x00, 0x00, 0xFD, 0x41
#define ABNORMAL  0x01, 0x03, 0x08, 0xFF, 0xFF, 0x00, 0x00, 0x00, 0xFF, 0xFF, 0xFF, 0xE4, 0x5C
#define EXCEPTION 0x01, 0x83, 0x04, 0x40, 0xF3
#define MEASURE   0x01, 0x03, 0x00, 0x08, 0x00, 0x04, 0xC5, 0xCB
#define READ_2    0x01, 0x03, 0x00, 0x02, 0x00, 0x04, 0xE5, 0xC9
#define ANSWER_2  0x01, 0x03, 0x08, 0xFF, 0xFF, 0x00, 0x00, 0x00, 0x00, 0xB4, 0x01, 0x63, 0x1C
enum { FRAME = 13, CHARACTER_US = 573, SILENCE_US = 2005 }; /* 11 bits, and 3.5 of them, at 19200 */

static const suite_t suite = {BENCH_ROUNDS};

/* ---- unasked: "continuous output" (#10, #15) ---- */

TEST(it_sends_by_itself_as_an_option)
{
    stage_t s;
    set(&s, (fathom_sim_hps167s_config_t){.unasked_us = 100 * MS});
    const uint32_t start_us = s.bench.now_us;
    for (int i = 0; i < 51; i++) bench_wait(&s.bench, 20 * MS); /* a loop that comes round every 20 ms */
    assert_int_equal(s.bench.heard, 10 * FRAME);
    for (size_t i = 0; i < 10; i++) {
        assert_memory_equal(s.bench.bytes + FRAME * i, ((uint8_t[]){EXAMPLE}), FRAME);
        assert_int_equal(fathom_elapsed_us(s.bench.end_us[FRAME * i], start_us),
                         (i + 1) * 100 * MS + CHARACTER_US);
    }
    assert_int_equal(s.hps.device.counters.automatic, 10);
    assert_int_equal(s.hps.device.counters.answered, 0);
    assert_int_equal(s.hps.device.counters.measurements, 10);
}

TEST(it_fills_the_line_with_54_frames_a_second)
{
    stage_t s;
    set(&s, (fathom_sim_hps167s_config_t){.unasked_us = 18519});
    for (int i = 0; i < 51; i++) bench_wait(&s.bench, 20 * MS);
    assert_int_equal(s.hps.device.counters.automatic, 55); /* 1020 / 18.519 */
    assert_in_range(s.bench.heard, 54 * FRAME, 55 * FRAME);
}

TEST(what_it_sends_is_the_scene)
{
    stage_t s;
    set(&s, (fathom_sim_hps167s_config_t){.unasked_us = 100 * MS, .unit = 2});
    bench_wait(&s.bench, 110 * MS);
    EXPECT(&s.bench, 0x02, 0x03, 0x08, 0x08, 0x23, 0xDC, 0xB2, 0x07, 0x01, 0x00, 0x00, 0xF2, 0x05);
    s.fixed.value[0] = FATHOM_SIM_FAULT;
    bench_wait(&s.bench, 100 * MS);
    EXPECT(&s.bench, 0x02, 0x03, 0x08, 0xFF, 0xFF, 0x00, 0x00, 0x00, 0xFF, 0xFF, 0xFF, 0xEB, 0x18);
}

/* Asked at every time within a period. Returns true when the answer came, and not only a frame. */
static bool asked_at(stage_t *s, uint32_t at_us)
{
    size_t frames = 0, answers = 0, i = 0;
    set(s, (fathom_sim_hps167s_config_t){.unasked_us = 100 * MS, .seed = at_us});
    bench_wait(&s->bench, at_us);
    ASK(&s->bench, 60 * MS, READ_2);
    while (i + FRAME <= s->bench.heard) {
        const bool is_frame = memcmp(s->bench.bytes + i, ((uint8_t[]){EXAMPLE}), FRAME) == 0;
        const bool is_answer = memcmp(s->bench.bytes + i, ((uint8_t[]){ANSWER_2}), FRAME) == 0;
        if (i != 0)
            assert_true(fathom_elapsed_us(s->bench.end_us[i], s->bench.end_us[i - 1]) >=
                        SILENCE_US + CHARACTER_US - 1);
        frames += is_frame;
        answers += is_answer;
        i += FRAME;
    }
    /* one that collides with the request reaches the host garbled, and the request does not reach the device */
    assert_int_equal(i, s->bench.heard);
    if (s->bench.line.counters.collisions == 0) {
        assert_int_equal((frames + answers) * FRAME, s->bench.heard);
        assert_int_equal(answers, s->hps.device.counters.answered);
    }
    return answers != 0;
}

TEST(it_answers_while_it_sends_by_itself)
{
    uint32_t answered = 0, beside = 0, collided = 0, tried = 0;
    stage_t s;
    /* the request lasts 4.6 ms, the answer begins 4.2 to 4.5 ms behind it, and frames come at 100 and 200 ms */
    for (uint32_t at_us = 80 * MS; at_us < 120 * MS; at_us += 250) {
        const bool came = asked_at(&s, at_us);
        tried++;
        answered += came;
        beside += came && s.bench.heard == 2 * FRAME;
        collided += s.bench.line.counters.collisions != 0;
        assert_true(came || s.hps.device.counters.unheard + s.hps.device.counters.torn != 0);
    }
    assert_int_equal(tried, 160);
    assert_true(answered > 100);
    assert_true(beside > 50);
    /* a frame begins within the request in 18 of the 160, the request within a frame in 30 */
    assert_in_range(collided, 40, 52);
    assert_int_equal(answered + collided, tried);
}

TEST(a_measurement_that_is_asked_for_is_not_sent_unasked_as_well)
{
    stage_t s;
    set(&s, (fathom_sim_hps167s_config_t){.unasked_us = 100 * MS});
    bench_wait(&s.bench, 98 * MS); /* the request ends at 102.6 ms, when a frame is on the wire */
    bench_wait(&s.bench, 11 * MS);
    EXPECT(&s.bench, EXAMPLE);
    const uint32_t end_us = ASK(&s.bench, 30 * MS, MEASURE); /* 109 to 113.6 ms; the next is ready at 118.5 */
    EXPECT(&s.bench, EXAMPLE);
    ASSERT_SPAN(s.bench.end_us[0], end_us, 118519 - 113584 + CHARACTER_US - 1,
                118519 - 113584 + CHARACTER_US + 1);
}

TEST(without_continuous_measuring_it_is_silent)
{
    stage_t s;
    set(&s, (fathom_sim_hps167s_config_t){.unasked_us = 100 * MS, .no_auto_output = true});
    bench_wait(&s.bench, 1000 * MS);
    EXPECT_SILENCE(&s.bench);
    ASK(&s.bench, 30 * MS, 0x01, 0x06, 0x00, 0x12, 0x00, 0xFF, 0x69, 0x8F);
    EXPECT(&s.bench, 0x01, 0x06, 0x00, 0x12, 0x00, 0xFF, 0x69, 0x8F);
    bench_wait(&s.bench, 1000 * MS);
    EXPECT_SILENCE(&s.bench);
    fathom_sim_power_cycle(&s.bench.line, &s.hps.device, 0, s.bench.now_us); /* from the next power-on */
    bench_wait(&s.bench, 250 * MS);
    EXPECT(&s.bench, EXAMPLE, EXAMPLE);
    ASK(&s.bench, 20 * MS, 0x01, 0x06, 0x00, 0x12, 0x00, 0x00, 0x29, 0xCF);
    bench_forget(&s.bench);
    bench_wait(&s.bench, 100 * MS);
    EXPECT(&s.bench, EXAMPLE);
    fathom_sim_power_cycle(&s.bench.line, &s.hps.device, 0, s.bench.now_us);
    bench_wait(&s.bench, 1000 * MS);
    EXPECT_SILENCE(&s.bench);
}

TEST(a_frame_between_a_new_rate_and_its_acknowledgement_has_the_old_one)
{
    uint32_t between = 0;
    stage_t s;
    for (uint32_t at_us = 90 * MS; at_us < 95300; at_us += 100) {
        set(&s, (fathom_sim_hps167s_config_t){.unasked_us = 100 * MS});
        bench_wait(&s.bench, at_us);
        ASK(&s.bench, 30 * MS, 0x01, 0x06, 0x00, 0x11, 0x00, 0x03, 0x99, 0xCE);
        if (s.bench.bytes[1] ==
            0x06) { /* the acknowledgement came first: then the frame is at the new rate */
            assert_memory_equal(s.bench.bytes, ((uint8_t[]){0x01, 0x06, 0x00, 0x11, 0x00, 0x03, 0x99, 0xCE}),
                                8);
            assert_memory_not_equal(s.bench.bytes + 8, ((uint8_t[]){EXAMPLE}), 2);
            continue;
        }
        between++;
        EXPECT(&s.bench, EXAMPLE, 0x01, 0x06, 0x00, 0x11, 0x00, 0x03, 0x99, 0xCE);
        bench_wait(&s.bench, 100 * MS);
        assert_int_not_equal(s.bench.bytes[0], 0x01); /* garbled: it is at 115200 */
    }
    assert_true(between > 10);
}

TEST(a_fault_sends_one_more_of_them_though_nobody_has_asked_yet)
{
    fathom_sim_fault_t fault;
    stage_t s;
    set(&s, (fathom_sim_hps167s_config_t){.unasked_us = 100 * MS});
    fathom_sim_fault_init(&fault, 1);
    assert_non_null(fathom_sim_fault_add(&fault, FATHOM_SIM_FAULT_UNASKED, FATHOM_SIM_FAULT_ALWAYS_PPM, 2));
    fathom_sim_fault_attach(&fault, &s.bench.line, &s.hps.device);
    assert_true(fathom_sim_fault_applies(FATHOM_SIM_FAULT_EXCEPTION, &s.hps.device));
    bench_wait(&s.bench, 350 * MS);
    EXPECT(&s.bench, EXAMPLE, EXAMPLE, EXAMPLE, EXAMPLE);
    assert_int_equal(fault.counters[FATHOM_SIM_FAULT_UNASKED], 1);
    assert_int_equal(fault.frames, 3);
}

/* ---- warm-up: "the sensor will not output measurement data" (#7) ---- */

TEST(the_warm_up_is_silence_an_exception_or_the_abnormal_packet)
{
    stage_t s;
    for (uint8_t says = 0; says <= FATHOM_SIM_HPS167S_ABNORMAL; says++) {
        set(&s, (fathom_sim_hps167s_config_t){.warm_up_s = 5, .warm_up_says = says});
        for (int i = 0; i < 2; i++) {
            ASK(&s.bench, 30 * MS, MEASURE);
            if (says == FATHOM_SIM_HPS167S_SILENCE) EXPECT_SILENCE(&s.bench);
            if (says == FATHOM_SIM_HPS167S_EXCEPTION) EXPECT(&s.bench, EXCEPTION);
            if (says == FATHOM_SIM_HPS167S_ABNORMAL) EXPECT(&s.bench, ABNORMAL);
            ASK(&s.bench, 30 * MS, 0x01, 0x03, 0x00, 0x04, 0x00, 0x01, 0xC5, 0xCB); /* the rest is answered */
            EXPECT(&s.bench, 0x01, 0x03, 0x02, 0x00, 0x4D, 0x78, 0x71);
            bench_wait(&s.bench, 4700 * MS);
        }
        assert_int_equal(s.hps.device.counters.measurements, 0);
        bench_wait(&s.bench, 200 * MS);
        ASK(&s.bench, 30 * MS, MEASURE);
        EXPECT(&s.bench, EXAMPLE);
        fathom_sim_power_cycle(&s.bench.line, &s.hps.device, 100 * MS, s.bench.now_us);
        bench_wait(&s.bench, 5000 * MS); /* 4.9 s after power came: it is kept */
        ASK(&s.bench, 30 * MS, MEASURE);
        assert_int_equal(s.hps.device.counters.measurements, 1);
        bench_wait(&s.bench, 100 * MS);
        bench_forget(&s.bench);
        ASK(&s.bench, 30 * MS, MEASURE);
        EXPECT(&s.bench, EXAMPLE);
    }
}

TEST(unasked_frames_wait_for_the_end_of_the_warm_up_or_are_abnormal_till_then)
{
    stage_t s;
    for (uint8_t says = 0; says <= FATHOM_SIM_HPS167S_ABNORMAL; says++) {
        set(&s, (fathom_sim_hps167s_config_t){.warm_up_s = 1, .warm_up_says = says, .unasked_us = 300 * MS});
        bench_wait(&s.bench, 1100 * MS);
        if (says == FATHOM_SIM_HPS167S_ABNORMAL)
            EXPECT(&s.bench, ABNORMAL, ABNORMAL, ABNORMAL);
        else
            EXPECT_SILENCE(&s.bench);
        bench_wait(&s.bench, 200 * MS);
        EXPECT(&s.bench, EXAMPLE);
    }
}

/* ---- no data: #15 ---- */

TEST(without_data_it_is_silent_for_the_reconnect_time_and_abnormal_then)
{
    stage_t s;
    set(&s, (fathom_sim_hps167s_config_t){.unasked_us = 100 * MS, .reconnect_ms = 360});
    bench_wait(&s.bench, 150 * MS);
    EXPECT(&s.bench, EXAMPLE);
    fathom_sim_hps167s_lose(&s.hps, true, s.bench.now_us); /* until 510 ms */
    bench_wait(&s.bench, 400 * MS);
    EXPECT_SILENCE(&s.bench);
    bench_wait(&s.bench, 200 * MS); /* 600 and 700 ms */
    EXPECT(&s.bench, ABNORMAL, ABNORMAL);
    assert_int_equal(s.hps.device.counters.measurements, 1);
    fathom_sim_hps167s_lose(&s.hps, false, s.bench.now_us);
    bench_wait(&s.bench, 100 * MS);
    EXPECT(&s.bench, EXAMPLE);
    fathom_sim_hps167s_lose(&s.hps, true, s.bench.now_us); /* for less than the reconnect time: no harm */
    bench_wait(&s.bench, 200 * MS);
    fathom_sim_hps167s_lose(&s.hps, false, s.bench.now_us);
    EXPECT_SILENCE(&s.bench);
    bench_wait(&s.bench, 100 * MS);
    EXPECT(&s.bench, EXAMPLE);
}

TEST(a_request_without_data_waits_for_the_reconnect_time)
{
    stage_t s;
    set(&s, (fathom_sim_hps167s_config_t){.reconnect_ms = 360});
    bench_wait(&s.bench, 150 * MS);
    const uint32_t lost_us = s.bench.now_us;
    fathom_sim_hps167s_lose(&s.hps, true, lost_us);
    bench_wait(&s.bench, 100 * MS);
    ASK(&s.bench, 300 * MS, MEASURE);
    ASSERT_SPAN(s.bench.end_us[0], lost_us, 360 * MS + CHARACTER_US - 1, 360 * MS + CHARACTER_US + 1);
    EXPECT(&s.bench, ABNORMAL);
    uint32_t end_us = ASK(&s.bench, 30 * MS, MEASURE);
    ASSERT_SPAN(s.bench.end_us[0], end_us, 2187 + CHARACTER_US - 1, 2500 + CHARACTER_US);
    EXPECT(&s.bench, ABNORMAL);
    ASK(&s.bench, 30 * MS, READ_2); /* the interface itself is well; 360 is 0x168 */
    EXPECT(&s.bench, 0x01, 0x03, 0x08, 0xFF, 0xFF, 0x00, 0x00, 0x00, 0x01, 0x68, 0x01, 0x6A, 0x1C);
    /* power begins the time anew */
    fathom_sim_power_cycle(&s.bench.line, &s.hps.device, 0, s.bench.now_us);
    const uint32_t power_us = s.bench.now_us;
    ASK(&s.bench, 400 * MS, MEASURE);
    ASSERT_SPAN(s.bench.end_us[0], power_us, 360 * MS + CHARACTER_US - 1, 360 * MS + CHARACTER_US + 1);
    EXPECT(&s.bench, ABNORMAL);
    fathom_sim_hps167s_lose(&s.hps, false, s.bench.now_us);
    ASK(&s.bench, 30 * MS, MEASURE);
    EXPECT(&s.bench, EXAMPLE);
}

TEST(a_reconnect_time_that_was_set_counts_and_half_an_hour_is_the_most)
{
    stage_t s;
    set(&s, (fathom_sim_hps167s_config_t){.unasked_us = 100 * MS});
    ASK(&s.bench, 30 * MS, 0x01, 0x10, 0x00, 0x20, 0x00, 0x02, 0x04, 0xFF, 0xFF, 0xFF, 0xFC, 0xB0,
        0x22); /* the largest multiple of 18 */
    EXPECT(&s.bench, 0x01, 0x10, 0x00, 0x20, 0x00, 0x02, 0x40, 0x02);
    fathom_sim_hps167s_lose(&s.hps, true, s.bench.now_us);
    bench_wait(&s.bench, UINT32_C(1790000000));
    EXPECT_SILENCE(&s.bench);
    bench_wait(&s.bench, UINT32_C(11000000));
    assert_true(s.bench.heard >= FRAME);
    bench_forget(&s.bench);
    bench_wait(&s.bench, 100 * MS);
    EXPECT(&s.bench, ABNORMAL);
}

TEST(without_data_a_single_measurement_is_abnormal_after_its_time)
{
    stage_t s;
    set(&s, (fathom_sim_hps167s_config_t){.no_auto_output = true});
    fathom_sim_hps167s_lose(&s.hps, true, s.bench.now_us);
    const uint32_t end_us = ASK(&s.bench, 50 * MS, MEASURE);
    ASSERT_SPAN(s.bench.end_us[0], end_us, 18519 + CHARACTER_US - 1, 18519 + CHARACTER_US);
    EXPECT(&s.bench, ABNORMAL);
}
