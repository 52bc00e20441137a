/* SPDX-License-Identifier: MIT */
#include "bench.h"
#include "sim/a05.h"
#include "sim/scene.h"

enum { MS = 1000 };

typedef struct {
    bench_t bench;
    fathom_sim_fixed_t fixed;
    fathom_sim_a05_t a05;
} stage_t;

static void set(stage_t *stage, uint8_t mode, fathom_sim_fixed_t fixed, fathom_sim_a05_config_t config)
{
    bench_init(&stage->bench, &bench_9600);
    stage->fixed = fixed;
    config.mode = mode;
    config.scene = fathom_sim_fixed(&stage->fixed);
    fathom_sim_a05_init(&stage->a05, &config);
    stage->bench.line.full_duplex = mode == FATHOM_SIM_A05_AUTO;
    bench_attach(&stage->bench, &stage->a05.device);
}

#define DEFAULTS   ((fathom_sim_a05_config_t){0})
#define FIXED(...) ((fathom_sim_fixed_t){{__VA_ARGS__}})
/* the probes of the examples in A05 3(4)1 */
#define EXAMPLE FIXED(316, 250, 659, 2426)

static const suite_t suite = {BENCH_ROUNDS};

TEST(automatic_frame_is_that_of_a05_1_3)
{
    stage_t s;
    set(&s, FATHOM_SIM_A05_AUTO, FIXED(1000, 2000, 1953, 3562), DEFAULTS);
    bench_wait(&s.bench, 320 * MS);
    EXPECT(&s.bench, 0xFF, 0x03, 0xE8, 0x07, 0xD0, 0x07, 0xA1, 0x0D, 0xEA, 0x60);
    assert_int_equal(s.a05.device.counters.measurements, 4);
}

TEST(automatic_frames_come_every_300_ms_byte_by_byte)
{
    stage_t s;
    set(&s, FATHOM_SIM_A05_AUTO, FIXED(1000, 2000, 1953, 3562), DEFAULTS);
    const uint32_t start_us = s.bench.now_us;
    bench_wait(&s.bench, 930 * MS);
    assert_int_equal(s.bench.heard, 30);
    for (size_t i = 0; i < 3; i++) {
        ASSERT_SPAN(s.bench.end_us[10 * i], start_us, (uint32_t)(i + 1) * 300 * MS + 1042,
                    (uint32_t)(i + 1) * 300 * MS + 1042);
        ASSERT_SPAN(s.bench.end_us[10 * i + 9], start_us, (uint32_t)(i + 1) * 300 * MS + 10417,
                    (uint32_t)(i + 1) * 300 * MS + 10417);
    }
    set(&s, FATHOM_SIM_A05_AUTO, FIXED(1000), (fathom_sim_a05_config_t){.period_us = 100 * MS});
    bench_wait(&s.bench, 1020 * MS);
    assert_int_equal(s.a05.device.counters.automatic, 10);
}

TEST(a_probe_without_a_target_does_not_touch_the_others)
{
    stage_t s;
    set(&s, FATHOM_SIM_A05_AUTO, FIXED(1000, FATHOM_SIM_NO_TARGET, FATHOM_SIM_INTERFERENCE, 3562), DEFAULTS);
    bench_wait(&s.bench, 320 * MS);
    EXPECT(&s.bench, 0xFF, 0x03, 0xE8, 0xFF, 0xFD, 0xFF, 0xFE, 0x0D, 0xEA, 0xDA);
}

TEST(the_first_command_ends_automatic_output_until_power_off)
{
    stage_t s;
    set(&s, FATHOM_SIM_A05_AUTO, EXAMPLE, DEFAULTS);
    bench_wait(&s.bench, 250 * MS);
    ASK(&s.bench, 300 * MS, 0x01, 0x03, 0x01, 0x06, 0x00, 0x01, 0x65, 0xF7);     /* 3(4)1 example 1 */
    EXPECT(&s.bench, 0xFF, 0x01, 0x3C, 0x00, 0xFA, 0x02, 0x93, 0x09, 0x7A, 0x4E, /* at 300 ms, lingering */
           0x01, 0x03, 0x02, 0x01, 0x3C, 0xB9, 0xC5);
    bench_wait(&s.bench, 5000 * MS);
    EXPECT_SILENCE(&s.bench);
    fathom_sim_detach(&s.bench.line, &s.a05.device, s.bench.now_us);
    bench_attach(&s.bench, &s.a05.device);
    bench_wait(&s.bench, 320 * MS);
    EXPECT(&s.bench, 0xFF, 0x01, 0x3C, 0x00, 0xFA, 0x02, 0x93, 0x09, 0x7A, 0x4E);
}

TEST(an_answer_and_a_frame_that_are_due_together_follow_each_other)
{
    int frame_first = 0, answer_first = 0;
    stage_t s;
    /* the request ends at 208.3 ms, the frame is due at 300, the answer somewhere between 278 and 338 */
    for (uint32_t probe_us = 80 * MS; probe_us < 130 * MS; probe_us += 500) {
        set(&s, FATHOM_SIM_A05_AUTO, EXAMPLE, (fathom_sim_a05_config_t){.probe_us = probe_us});
        bench_wait(&s.bench, 200 * MS);
        ASK(&s.bench, 300 * MS, 0x01, 0x03, 0x01, 0x06, 0x00, 0x01, 0x65, 0xF7);
        assert_int_equal(s.bench.heard, 17);
        if (s.bench.bytes[0] == 0xFF) {
            frame_first++;
            EXPECT(&s.bench, 0xFF, 0x01, 0x3C, 0x00, 0xFA, 0x02, 0x93, 0x09, 0x7A, 0x4E, 0x01, 0x03, 0x02,
                   0x01, 0x3C, 0xB9, 0xC5);
        } else {
            answer_first++;
            EXPECT(&s.bench, 0x01, 0x03, 0x02, 0x01, 0x3C, 0xB9, 0xC5, 0xFF, 0x01, 0x3C, 0x00, 0xFA, 0x02,
                   0x93, 0x09, 0x7A, 0x4E);
        }
        for (size_t i = 1; i < 17; i++) /* one transmitter: characters never overlap */
            assert_true(fathom_elapsed_us(s.bench.end_us[i], s.bench.end_us[i - 1]) >= 1041);
    }
    assert_true(frame_first > 10);
    assert_true(answer_first > 10);
}

TEST(reads_are_those_of_a05_3_4_1)
{
    stage_t s;
    set(&s, FATHOM_SIM_A05_MODBUS, FIXED(316, 2331, 0, 0), DEFAULTS);
    ASK(&s.bench, 150 * MS, 0x01, 0x03, 0x01, 0x06, 0x00, 0x01, 0x65, 0xF7); /* example 1 */
    EXPECT(&s.bench, 0x01, 0x03, 0x02, 0x01, 0x3C, 0xB9, 0xC5);
    ASK(&s.bench, 150 * MS, 0x01, 0x03, 0x01, 0x07, 0x00, 0x01, 0x34, 0x37); /* example 2 */
    EXPECT(&s.bench, 0x01, 0x03, 0x02, 0x09, 0x1B, 0xFE, 0x1F);
    s.fixed = EXAMPLE;
    ASK(&s.bench, 350 * MS, 0x01, 0x03, 0x01, 0x07, 0x00, 0x03, 0xB5, 0xF6); /* example 3 */
    EXPECT(&s.bench, 0x01, 0x03, 0x06, 0x00, 0xFA, 0x02, 0x93, 0x09, 0x7A, 0x8F, 0x47);
    assert_int_equal(s.a05.device.counters.measurements, 5);
}

TEST(the_fourth_probe_is_at_0109_though_the_table_calls_it_the_third)
{
    stage_t s;
    set(&s, FATHOM_SIM_A05_MODBUS, EXAMPLE, DEFAULTS);
    ASK(&s.bench, 150 * MS, 0x01, 0x03, 0x01, 0x09, 0x00, 0x01, 0x55, 0xF4);
    EXPECT(&s.bench, 0x01, 0x03, 0x02, 0x09, 0x7A, 0x3F, 0xF7);
    ASK(&s.bench, 150 * MS, 0x01, 0x03, 0x00, 0x13, 0x00, 0x01, 0x75, 0xCF); /* and at its other address */
    EXPECT(&s.bench, 0x01, 0x03, 0x02, 0x09, 0x7A, 0x3F, 0xF7);
}

TEST(all_four_come_in_one_read_at_either_address)
{
    stage_t s;
    set(&s, FATHOM_SIM_A05_MODBUS, EXAMPLE, DEFAULTS);
    ASK(&s.bench, 450 * MS, 0x01, 0x03, 0x01, 0x06, 0x00, 0x04, 0xA5, 0xF4);
    EXPECT(&s.bench, 0x01, 0x03, 0x08, 0x01, 0x3C, 0x00, 0xFA, 0x02, 0x93, 0x09, 0x7A, 0x06, 0x2A);
    ASK(&s.bench, 450 * MS, 0x01, 0x03, 0x00, 0x10, 0x00, 0x04, 0x45, 0xCC);
    EXPECT(&s.bench, 0x01, 0x03, 0x08, 0x01, 0x3C, 0x00, 0xFA, 0x02, 0x93, 0x09, 0x7A, 0x06, 0x2A);
}

TEST(a_read_takes_about_100_ms_a_probe)
{
    stage_t s;
    set(&s, FATHOM_SIM_A05_MODBUS, EXAMPLE, DEFAULTS);
    uint32_t end_us = ASK(&s.bench, 450 * MS, 0x01, 0x03, 0x01, 0x06, 0x00, 0x01, 0x65, 0xF7);
    ASSERT_SPAN(s.bench.end_us[0], end_us, 87500 + 1042, 100 * MS + 1042);
    bench_forget(&s.bench);
    end_us = ASK(&s.bench, 450 * MS, 0x01, 0x03, 0x01, 0x06, 0x00, 0x04, 0xA5, 0xF4);
    ASSERT_SPAN(s.bench.end_us[0], end_us, 350 * MS + 1042, 400 * MS + 1042);
}

TEST(what_it_does_not_know_is_silence)
{
    stage_t s;
    set(&s, FATHOM_SIM_A05_MODBUS, EXAMPLE, DEFAULTS);
    ASK(&s.bench, 450 * MS, 0x01, 0x03, 0x01, 0x09, 0x00, 0x02, 0x15, 0xF5); /* past the last */
    ASK(&s.bench, 450 * MS, 0x01, 0x03, 0x00, 0x13, 0x00, 0x02, 0x35, 0xCE);
    ASK(&s.bench, 450 * MS, 0x01, 0x03, 0x01, 0x06, 0x00, 0x05, 0x64, 0x34);
    ASK(&s.bench, 450 * MS, 0x01, 0x03, 0x01, 0x06, 0x00, 0x00, 0xA4, 0x37); /* none at all */
    ASK(&s.bench, 450 * MS, 0x01, 0x03, 0x01, 0x05, 0x00, 0x01, 0x95, 0xF7); /* before the first */
    ASK(&s.bench, 450 * MS, 0x01, 0x04, 0x01, 0x00, 0x00, 0x01, 0x30, 0x36);
    EXPECT_SILENCE(&s.bench);
    assert_int_equal(s.a05.device.counters.unserved, 6);
    assert_int_equal(s.a05.device.counters.measurements, 0);
    set(&s, FATHOM_SIM_A05_MODBUS, EXAMPLE, (fathom_sim_a05_config_t){.exceptions = true});
    ASK(&s.bench, 450 * MS, 0x01, 0x03, 0x01, 0x05, 0x00, 0x01, 0x95, 0xF7);
    EXPECT(&s.bench, 0x01, 0x83, 0x02, 0xC0, 0xF1);
    ASK(&s.bench, 450 * MS, 0x01, 0x03, 0x01, 0x09, 0x00, 0x02, 0x15, 0xF5);
    EXPECT(&s.bench, 0x01, 0x83, 0x03, 0x01, 0x31);
}

TEST(set_address_is_echoed_and_obeyed_a05_3_4_2)
{
    stage_t s;
    set(&s, FATHOM_SIM_A05_MODBUS, EXAMPLE, DEFAULTS);
    ASK(&s.bench, 50 * MS, 0x01, 0x06, 0x02, 0x00, 0x00, 0x05, 0x48, 0x71);
    EXPECT(&s.bench, 0x01, 0x06, 0x02, 0x00, 0x00, 0x05, 0x48, 0x71);
    ASK(&s.bench, 50 * MS, 0x05, 0x03, 0x02, 0x00, 0x00, 0x01, 0x84, 0x36);
    EXPECT(&s.bench, 0x05, 0x03, 0x02, 0x00, 0x05, 0x89, 0x87);
    ASK(&s.bench, 50 * MS, 0x01, 0x03, 0x02, 0x00, 0x00, 0x01, 0x85, 0xB2);
    EXPECT_SILENCE(&s.bench);
}

TEST(a_broadcast_is_obeyed_without_an_answer)
{
    stage_t s;
    set(&s, FATHOM_SIM_A05_MODBUS, EXAMPLE, DEFAULTS);
    ASK(&s.bench, 300 * MS, 0xFF, 0x06, 0x02, 0x00, 0x00, 0x05, 0x5D, 0xAF);
    ASK(&s.bench, 300 * MS, 0xFF, 0x03, 0x01, 0x06, 0x00, 0x01, 0x70, 0x29);
    EXPECT_SILENCE(&s.bench);
    assert_int_equal(s.a05.device.unit, 5);
    assert_int_equal(s.a05.device.counters.requests, 2);
}

TEST(it_is_deaf_and_silent_until_it_is_up)
{
    stage_t s;
    set(&s, FATHOM_SIM_A05_MODBUS, EXAMPLE, (fathom_sim_a05_config_t){.start_us = 900 * MS});
    ASK(&s.bench, 880 * MS, 0x01, 0x03, 0x01, 0x06, 0x00, 0x01, 0x65, 0xF7);
    EXPECT_SILENCE(&s.bench);
    assert_int_equal(s.a05.device.counters.unheard, 8);
    bench_wait(&s.bench, 20 * MS);
    ASK(&s.bench, 150 * MS, 0x01, 0x03, 0x01, 0x06, 0x00, 0x01, 0x65, 0xF7);
    EXPECT(&s.bench, 0x01, 0x03, 0x02, 0x01, 0x3C, 0xB9, 0xC5);
}
