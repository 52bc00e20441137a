/* SPDX-License-Identifier: MIT */
#include "bench.h"
#include "sim/hps167s.h"
#include "sim/scene.h"

enum { MS = 1000 };

typedef struct {
    bench_t bench;
    fathom_sim_fixed_t fixed;
    fathom_sim_hps167s_t hps;
} stage_t;

static void set(stage_t *stage, int32_t distance, fathom_sim_hps167s_config_t config)
{
    bench_init(&stage->bench, &bench_19200);
    stage->fixed.value[0] = distance;
    config.scene = fathom_sim_fixed(&stage->fixed);
    fathom_sim_hps167s_init(&stage->hps, &config);
    bench_attach(&stage->bench, &stage->hps.device);
}

#define DEFAULTS ((fathom_sim_hps167s_config_t){0})

static const suite_t suite = {BENCH_ROUNDS};

TEST(single_measurement_is_that_of_command_5)
{
    stage_t s;
    set(&s, 2083, DEFAULTS);
    ASK(&s.bench, 20 * MS, 0x01, 0x03, 0x00, 0x08, 0x00, 0x04, 0xC5, 0xCB); /* table 17 */
    EXPECT(&s.bench, 0x01, 0x03, 0x08, 0x08, 0x23, 0xDC, 0xB2, 0x07, 0x01, 0x00, 0x00, 0xFD, 0x41);
    assert_int_equal(s.hps.device.counters.measurements, 1);
}

TEST(the_misprinted_crc_of_the_abnormal_response_is_no_request)
{
    stage_t s;
    set(&s, 2083, DEFAULTS);
    ASK(&s.bench, 50 * MS, 0x01, 0x03, 0x00, 0x08, 0x00, 0x04, 0xC5, 0xC8);
    EXPECT_SILENCE(&s.bench);
    assert_int_equal(s.hps.device.counters.crc_errors, 1);
    assert_int_equal(s.hps.device.counters.requests, 0);
}

TEST(sensor_details_are_those_of_command_3)
{
    stage_t s;
    set(&s, 2083, DEFAULTS);
    ASK(&s.bench, 30 * MS, 0x01, 0x03, 0x00, 0x03, 0x00, 0x0B, 0xF4, 0x0D); /* table 13 */
    EXPECT(&s.bench, 0x01, 0x03, 0x16, 0xB0, 0x00, 0x39, 0x00, 0x25, 0x42, 0x34, 0x57, 0x14, 0x20, 0x34, 0x38,
           0x35, 0x01, 0x06, 0x07, 0x05, 0x13, 0x09, 0x17, 0x03, 0x09, 0x1A, 0xDC);
}

TEST(version_configuration_and_temperature_answer_tables_9_11_15)
{
    stage_t s;
    set(&s, 2083, (fathom_sim_hps167s_config_t){.temperature_f = -10});
    ASK(&s.bench, 30 * MS, 0x01, 0x03, 0x00, 0x01, 0x00, 0x03, 0x54, 0x0B);
    EXPECT(&s.bench, 0x01, 0x03, 0x06, 0x14, 0x09, 0x1B, 0x02, 0x01, 0x00, 0x58, 0xD4);
    ASK(&s.bench, 30 * MS, 0x01, 0x03, 0x00, 0x02, 0x00, 0x04, 0xE5, 0xC9);
    /* FF termination, FF automatic, warm-up 0 s, reconnect 180 ms, rate 1 */
    EXPECT(&s.bench, 0x01, 0x03, 0x08, 0xFF, 0xFF, 0x00, 0x00, 0x00, 0x00, 0xB4, 0x01, 0x63, 0x1C);
    ASK(&s.bench, 30 * MS, 0x01, 0x03, 0x00, 0x04, 0x00, 0x01, 0xC5, 0xCB);
    EXPECT(&s.bench, 0x01, 0x03, 0x02, 0xFF, 0xF6, 0x79, 0xF2);
    s.hps.temperature_f = 77;
    ASK(&s.bench, 30 * MS, 0x01, 0x03, 0x00, 0x04, 0x00, 0x01, 0xC5, 0xCB);
    EXPECT(&s.bench, 0x01, 0x03, 0x02, 0x00, 0x4D, 0x78, 0x71);
    assert_int_equal(s.hps.device.counters.measurements, 0);
}

TEST(no_target_is_65530_with_little_light)
{
    stage_t s;
    set(&s, FATHOM_SIM_NO_TARGET, DEFAULTS);
    ASK(&s.bench, 30 * MS, 0x01, 0x03, 0x00, 0x08, 0x00, 0x04, 0xC5, 0xCB);
    EXPECT(&s.bench, 0x01, 0x03, 0x08, 0xFF, 0xFA, 0x00, 0x10, 0x00, 0x01, 0x00, 0x00, 0x10, 0xDF);
}

TEST(a_fault_is_the_abnormal_packet_of_command_5)
{
    stage_t s;
    set(&s, FATHOM_SIM_FAULT, DEFAULTS);
    ASK(&s.bench, 30 * MS, 0x01, 0x03, 0x00, 0x08, 0x00, 0x04, 0xC5, 0xCB);
    EXPECT(&s.bench, 0x01, 0x03, 0x08, 0xFF, 0xFF, 0x00, 0x00, 0x00, 0xFF, 0xFF, 0xFF, 0xE4, 0x5C);
}

TEST(the_first_answer_comes_at_once_and_the_next_a_period_later)
{
    stage_t s;
    set(&s, 2083, DEFAULTS);
    const uint32_t end_us = ASK(&s.bench, 12 * MS, 0x01, 0x03, 0x00, 0x08, 0x00, 0x04, 0xC5, 0xCB);
    assert_int_equal(s.bench.heard, 13);
    const uint32_t first_us = s.bench.end_us[0];
    ASSERT_SPAN(first_us, end_us, 2187 + 572, 2500 + 573); /* a character is 572.9 us */
    ASSERT_SPAN(s.bench.end_us[12], first_us, 6874, 6876);
    bench_forget(&s.bench);
    ASK(&s.bench, 30 * MS, 0x01, 0x03, 0x00, 0x08, 0x00, 0x04, 0xC5, 0xCB);
    assert_int_equal(s.bench.heard, 13);
    ASSERT_SPAN(s.bench.end_us[0], first_us, 18519, 18519);
}

static uint32_t answers_in_10_s(stage_t *s)
{
    uint32_t answers = 0;
    for (uint32_t us = 0; us < 10000 * MS; us += 100) {
        /* the fastest host there is: t3.5 after the last bit of an answer */
        if (us == 0 ||
            (s->bench.heard == 13 && fathom_elapsed_us(s->bench.now_us, s->bench.end_us[12]) >= 2006)) {
            answers += us != 0;
            bench_forget(&s->bench);
            SAY(&s->bench, 0x01, 0x03, 0x00, 0x08, 0x00, 0x04, 0xC5, 0xCB);
        }
        bench_wait(&s->bench, 100);
    }
    return answers;
}

TEST(it_measures_54_times_a_second_and_6_times_as_an_option)
{
    stage_t s;
    set(&s, 2083, DEFAULTS);
    assert_in_range(answers_in_10_s(&s), 538, 540);
    set(&s, 2083, (fathom_sim_hps167s_config_t){.period_us = 166667});
    assert_in_range(answers_in_10_s(&s), 59, 60);
}

TEST(without_automatic_measuring_each_takes_a_period)
{
    stage_t s;
    set(&s, 2083, (fathom_sim_hps167s_config_t){.no_auto_output = true});
    const uint32_t end_us = ASK(&s.bench, 50 * MS, 0x01, 0x03, 0x00, 0x08, 0x00, 0x04, 0xC5, 0xCB);
    assert_int_equal(s.bench.heard, 13);
    ASSERT_SPAN(s.bench.end_us[0], end_us, 18519 + 572, 18519 + 573);
}

TEST(it_says_nothing_unless_asked)
{
    stage_t s;
    set(&s, 2083, DEFAULTS);
    assert_int_equal(fathom_sim_due_us(&s.bench.line, s.bench.now_us), FATHOM_NO_DEADLINE);
    bench_wait(&s.bench, 600000 * MS);
    EXPECT_SILENCE(&s.bench);
}

TEST(a_command_with_another_length_is_exception_2)
{
    stage_t s;
    set(&s, 2083, DEFAULTS);
    ASK(&s.bench, 30 * MS, 0x01, 0x03, 0x00, 0x08, 0x00, 0x03, 0x84, 0x09);
    EXPECT(&s.bench, 0x01, 0x83, 0x02, 0xC0, 0xF1); /* the datasheet's own example */
    ASK(&s.bench, 30 * MS, 0x01, 0x03, 0x00, 0x08, 0x00, 0x05, 0x04, 0x0B);
    EXPECT(&s.bench, 0x01, 0x83, 0x02, 0xC0, 0xF1);
    ASK(&s.bench, 30 * MS, 0x01, 0x03, 0x00, 0x08, 0x00, 0x00, 0xC4, 0x08);
    EXPECT(&s.bench, 0x01, 0x83, 0x02, 0xC0, 0xF1);
    ASK(&s.bench, 30 * MS, 0x01, 0x03, 0x00, 0x08, 0x01, 0x04, 0xC4, 0x5B); /* 260, not 4 */
    EXPECT(&s.bench, 0x01, 0x83, 0x02, 0xC0, 0xF1);
    assert_int_equal(s.hps.device.counters.exceptions, 4);
    assert_int_equal(s.hps.device.counters.measurements, 0);
    set(&s, 2083, (fathom_sim_hps167s_config_t){.wrong_length = 3});
    ASK(&s.bench, 30 * MS, 0x01, 0x03, 0x00, 0x08, 0x00, 0x03, 0x84, 0x09);
    EXPECT(&s.bench, 0x01, 0x83, 0x03, 0x01, 0x31);
}

TEST(every_length_but_the_right_one_is_refused_at_every_address)
{
    /* CRCs of 01 03 00 aa 00 cc, by bits: MODBUS over Serial Line 6.2.2 */
    static const uint8_t right[16] = {0, 3, 4, 11, 1, 0, 0, 0, 4, 1, 0, 0, 0, 0, 0, 0};
    stage_t s;
    set(&s, 2083, (fathom_sim_hps167s_config_t){.wrong_length = 3});
    for (uint8_t address = 0; address < 16; address++) {
        for (uint8_t count = 0; count < 16; count++) {
            uint8_t bytes[8] = {0x01, 0x03, 0x00, address, 0x00, count};
            uint16_t crc = 0xFFFF;
            for (size_t i = 0; i < 48; i++) {
                const uint16_t bit = (uint16_t)((bytes[i / 8] >> (i % 8)) & 1);
                crc = ((crc ^ bit) & 1) != 0 ? (uint16_t)((crc >> 1) ^ 0xA001) : (uint16_t)(crc >> 1);
            }
            bytes[6] = (uint8_t)crc;
            bytes[7] = (uint8_t)(crc >> 8);
            bench_ask(&s.bench, bytes, 8, 50 * MS);
            if (right[address] == 0) {
                EXPECT(&s.bench, 0x01, 0x83, 0x02, 0xC0, 0xF1);
            } else if (right[address] != count) {
                EXPECT(&s.bench, 0x01, 0x83, 0x03, 0x01, 0x31);
            } else {
                assert_int_equal(s.bench.heard, 5 + 2 * count);
                assert_int_equal(s.bench.bytes[1], 0x03);
                bench_forget(&s.bench);
            }
        }
    }
    assert_int_equal(s.hps.device.counters.resets, 1);
    assert_int_equal(s.hps.device.counters.resets_refused, 15);
}

TEST(an_unknown_function_is_exception_1_whatever_its_length)
{
    stage_t s;
    set(&s, 2083, DEFAULTS);
    ASK(&s.bench, 30 * MS, 0x01, 0x04, 0x00, 0x08, 0x00, 0x04, 0x70, 0x0B);
    EXPECT(&s.bench, 0x01, 0x84, 0x01, 0x82, 0xC0);
    ASK(&s.bench, 30 * MS, 0x01, 0x11, 0xC0, 0x2C);
    EXPECT(&s.bench, 0x01, 0x91, 0x01, 0x8C, 0x50);
    ASK(&s.bench, 30 * MS, 0x01, 0x83, 0x02, 0xC0, 0xF1); /* but an answer is no request */
    EXPECT_SILENCE(&s.bench);
}

TEST(factory_reset_is_that_of_tables_19_and_20_and_is_counted)
{
    stage_t s;
    set(&s, 2083, (fathom_sim_hps167s_config_t){.unit = 2, .no_termination = true});
    ASK(&s.bench, 30 * MS, 0x02, 0x03, 0x00, 0x09, 0x00, 0x01, 0x54, 0x3B);
    EXPECT(&s.bench, 0x02, 0x03, 0x02, 0x00, 0x01, 0x3D, 0x84);
    assert_int_equal(s.hps.device.counters.resets, 1);
    /* address 1 again, termination on, warm-up 5 s */
    ASK(&s.bench, 30 * MS, 0x01, 0x03, 0x00, 0x02, 0x00, 0x04, 0xE5, 0xC9);
    EXPECT(&s.bench, 0x01, 0x03, 0x08, 0xFF, 0xFF, 0x05, 0x00, 0x00, 0x00, 0xB4, 0x01, 0x63, 0x49);
    ASK(&s.bench, 30 * MS, 0x01, 0x03, 0x00, 0x09, 0x00, 0x01, 0x54, 0x08);
    EXPECT(&s.bench, 0x01, 0x03, 0x02, 0x00, 0x01, 0x79, 0x84);
    assert_int_equal(s.hps.device.counters.resets, 2);
}

TEST(it_works_at_the_rates_of_command_9_and_leaves_them_after_the_answer_to_a_reset)
{
    static const uint32_t baud[] = {19200, 57600, 115200, 230400};
    stage_t s;
    for (uint8_t code = 1; code <= 4; code++) {
        const fathom_line_settings_t settings = {baud[code - 1], FATHOM_PARITY_EVEN, 1};
        set(&s, 2083, (fathom_sim_hps167s_config_t){.baud_code = code});
        fathom_sim_set_line(&s.bench.line, &settings, s.bench.now_us);
        ASK(&s.bench, 30 * MS, 0x01, 0x03, 0x00, 0x08, 0x00, 0x04, 0xC5, 0xCB);
        EXPECT(&s.bench, 0x01, 0x03, 0x08, 0x08, 0x23, 0xDC, 0xB2, 0x07, 0x01, 0x00, 0x00, 0xFD, 0x41);
        ASK(&s.bench, 30 * MS, 0x01, 0x03, 0x00, 0x02, 0x00, 0x04, 0xE5, 0xC9);
        assert_int_equal(s.bench.bytes[10], code);
        bench_forget(&s.bench);
        ASK(&s.bench, 30 * MS, 0x01, 0x03, 0x00, 0x09, 0x00, 0x01, 0x54, 0x08);
        EXPECT(&s.bench, 0x01, 0x03, 0x02, 0x00, 0x01, 0x79, 0x84);
        fathom_sim_set_line(&s.bench.line, &bench_19200, s.bench.now_us);
        ASK(&s.bench, 30 * MS, 0x01, 0x03, 0x00, 0x04, 0x00, 0x01, 0xC5, 0xCB);
        EXPECT(&s.bench, 0x01, 0x03, 0x02, 0x00, 0x4D, 0x78, 0x71);
    }
}

TEST(nothing_else_resets_it)
{
    stage_t s;
    set(&s, 2083, DEFAULTS);
    ASK(&s.bench, 30 * MS, 0x01, 0x03, 0x00, 0x09, 0x00, 0x02, 0x14, 0x09);
    EXPECT(&s.bench, 0x01, 0x83, 0x02, 0xC0, 0xF1);
    ASK(&s.bench, 30 * MS, 0x01, 0x03, 0x00, 0x09, 0x00, 0x00, 0x95, 0xC8);
    EXPECT(&s.bench, 0x01, 0x83, 0x02, 0xC0, 0xF1);
    ASK(&s.bench, 30 * MS, 0x01, 0x03, 0x00, 0x09, 0x01, 0x01, 0x55, 0x98);
    EXPECT(&s.bench, 0x01, 0x83, 0x02, 0xC0, 0xF1);
    ASK(&s.bench, 30 * MS, 0x01, 0x03, 0x00, 0x08, 0x00, 0x02, 0x45, 0xC9); /* reads on past 0x0009 */
    EXPECT(&s.bench, 0x01, 0x83, 0x02, 0xC0, 0xF1);
    ASK(&s.bench, 30 * MS, 0x02, 0x03, 0x00, 0x09, 0x00, 0x01, 0x54, 0x3B); /* another unit's */
    EXPECT_SILENCE(&s.bench);
    assert_int_equal(s.hps.device.counters.resets, 0);
    assert_int_equal(s.hps.device.counters.resets_refused, 3);
    ASK(&s.bench, 30 * MS, 0x00, 0x03, 0x00, 0x09, 0x00, 0x01, 0x55, 0xD9); /* to all: done, not answered */
    EXPECT_SILENCE(&s.bench);
    assert_int_equal(s.hps.device.counters.resets, 1);
}

TEST(a_broadcast_is_not_answered)
{
    stage_t s;
    set(&s, 2083, DEFAULTS);
    ASK(&s.bench, 30 * MS, 0x00, 0x03, 0x00, 0x08, 0x00, 0x04, 0xC4, 0x1A);
    EXPECT_SILENCE(&s.bench);
    assert_int_equal(s.hps.device.counters.requests, 1);
    /* and does not make it busy */
    ASK(&s.bench, 30 * MS, 0x01, 0x03, 0x00, 0x08, 0x00, 0x04, 0xC5, 0xCB);
    assert_int_equal(s.bench.heard, 13);
}

TEST(another_unit_is_not_meant)
{
    stage_t s;
    set(&s, 2083, DEFAULTS);
    ASK(&s.bench, 30 * MS, 0x02, 0x03, 0x00, 0x08, 0x00, 0x04, 0xC5, 0xF8);
    EXPECT_SILENCE(&s.bench);
    assert_int_equal(s.hps.device.counters.others, 1);
    set(&s, 2083, (fathom_sim_hps167s_config_t){.unit = 2});
    ASK(&s.bench, 30 * MS, 0x02, 0x03, 0x00, 0x08, 0x00, 0x04, 0xC5, 0xF8);
    EXPECT(&s.bench, 0x02, 0x03, 0x08, 0x08, 0x23, 0xDC, 0xB2, 0x07, 0x01, 0x00, 0x00, 0xF2, 0x05);
}

TEST(while_it_warms_up_it_measures_nothing_but_answers_the_rest)
{
    stage_t s;
    set(&s, 2083, (fathom_sim_hps167s_config_t){.warm_up_s = 5});
    bench_wait(&s.bench, 4900 * MS);
    ASK(&s.bench, 30 * MS, 0x01, 0x03, 0x00, 0x08, 0x00, 0x04, 0xC5, 0xCB);
    EXPECT_SILENCE(&s.bench);
    assert_int_equal(s.hps.device.counters.unserved, 1);
    ASK(&s.bench, 30 * MS, 0x01, 0x03, 0x00, 0x02, 0x00, 0x04, 0xE5, 0xC9);
    EXPECT(&s.bench, 0x01, 0x03, 0x08, 0xFF, 0xFF, 0x05, 0x00, 0x00, 0x00, 0xB4, 0x01, 0x63, 0x49);
    bench_wait(&s.bench, 70 * MS);
    ASK(&s.bench, 30 * MS, 0x01, 0x03, 0x00, 0x08, 0x00, 0x04, 0xC5, 0xCB);
    assert_int_equal(s.bench.heard, 13);
}

/* ---- silence: HPS-167S 2.2.3 ---- */

/* The request of table 17 in two parts, `gap_us` apart. */
static void ask_in_two(stage_t *s, size_t first, uint32_t gap_us)
{
    const uint8_t bytes[] = {0x01, 0x03, 0x00, 0x08, 0x00, 0x04, 0xC5, 0xCB};
    bench_ask(&s->bench, bytes, first, gap_us);
    bench_ask(&s->bench, bytes + first, 8 - first, 30 * MS);
}

TEST(a_gap_up_to_t15_is_none_and_a_longer_one_drops_the_request)
{
    stage_t s;
    for (size_t first = 1; first < 8; first++) {
        set(&s, 2083, DEFAULTS);
        ask_in_two(&s, first, 850); /* t1.5 is 859.4 us */
        assert_int_equal(s.bench.heard, 13);
        bench_forget(&s.bench);
        ask_in_two(&s, first, 870);
        EXPECT_SILENCE(&s.bench);
        assert_int_equal(s.hps.device.counters.torn, 1);
        ask_in_two(&s, first, 1990); /* t3.5 is 2005.2 us: still one frame, a bad one */
        EXPECT_SILENCE(&s.bench);
        assert_int_equal(s.hps.device.counters.torn, 2);
        assert_int_equal(s.hps.device.counters.crc_errors, 0);
        ask_in_two(&s, first, 2010); /* two */
        EXPECT_SILENCE(&s.bench);
        assert_int_equal(s.hps.device.counters.torn, 2);
        assert_int_equal(s.hps.device.counters.crc_errors, 2);
        /* none of which it remembers */
        ask_in_two(&s, first, 0);
        assert_int_equal(s.bench.heard, 13);
    }
}

TEST(a_request_behind_another_one_without_a_silence_is_none)
{
    stage_t s;
    set(&s, 2083, DEFAULTS);
    ASK(&s.bench, 50 * MS, 0x01, 0x03, 0x00, 0x04, 0x00, 0x01, 0xC5, 0xCB, /* and at once */
        0x01, 0x03, 0x00, 0x08, 0x00, 0x04, 0xC5, 0xCB);
    EXPECT_SILENCE(&s.bench);
    assert_int_equal(s.hps.device.counters.crc_errors, 1);
    ASK(&s.bench, 50 * MS, 0xFF, 0x01, 0x03, 0x00, 0x08, 0x00, 0x04, 0xC5, 0xCB); /* noise before it */
    EXPECT_SILENCE(&s.bench);
    assert_int_equal(s.hps.device.counters.crc_errors, 2);
}
