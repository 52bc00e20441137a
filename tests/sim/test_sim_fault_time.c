/* SPDX-License-Identifier: MIT */
#include "fault_bench.h"

/* Kinds that change when a frame comes, whether it does, and what comes around it. */

enum { SEEDS = 100, CHARACTER_US = 1042 }; /* 10 bits at 9600 */

#define A16_FRAME  0xFF, 0x02, 0xEF, 0xF0
#define A16_ASKED  0x01, 0x03, 0x01, 0x01, 0x00, 0x01, 0xD4, 0x36
#define A16_ANSWER 0x01, 0x03, 0x02, 0x02, 0xEF, 0xF8, 0xA8

/* The end of byte n of an automatic frame k (1...), from power-on, when nothing delays it. */
static uint32_t due_us(uint32_t k, uint32_t n) { return k * 100 * MS + (n + 1) * 10000000u / 9600u; }

static uint32_t at_us(const stage_t *s, size_t byte) { return s->end_us[byte] - bench_start_us; }

/* A span that is right to 2 us: ends are rounded up to whole us. */
#define ASSERT_AT(is_us, should_us) assert_in_range((is_us), (should_us), (should_us) + 2)

static const suite_t suite = {BENCH_ROUNDS};

TEST(split_pauses_before_any_byte_but_the_first)
{
    uint32_t places = 0;
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        stage_t s;
        stage_set(&s, A16_AUTO, seed);
        fathom_sim_fault_rule_t *const rule = ADD(&s, SPLIT, ALWAYS, 2);
        if ((seed & 1) != 0) rule->us = 25 * MS;
        const uint32_t pause_us = (seed & 1) != 0 ? 25 * MS : 10 * MS;
        stage_wait(&s, 350 * MS);
        EXPECT_BYTES(&s, A16_FRAME, A16_FRAME, A16_FRAME);
        ASSERT_AT(at_us(&s, 4), due_us(2, 0));
        ASSERT_AT(at_us(&s, 7), due_us(2, 3) + pause_us);
        for (uint32_t n = 1; n < 4; n++) {
            const uint32_t gap_us = at_us(&s, 4 + n) - at_us(&s, 3 + n);
            if (gap_us > 2 * CHARACTER_US) places |= 1u << n;
        }
        ASSERT_AT(at_us(&s, 8), due_us(3, 0)); /* the period holds */
        assert_int_equal(HITS(&s, SPLIT), 1);
    }
    assert_int_equal(places, 0xE);
}

TEST(a_pause_moves_with_its_byte_when_a_break_comes_first)
{
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        uint32_t places[2] = {0, 0};
        for (int with = 0; with < 2; with++) {
            stage_t s;
            stage_set(&s, A16_AUTO, seed);
            ADD(&s, SPLIT, ALWAYS, 1);
            if (with == 1) ADD(&s, BREAK, ALWAYS, 1);
            stage_wait(&s, 150 * MS);
            assert_int_equal(s.count, 4 + (size_t)with);
            for (size_t n = 1; n < s.count; n++)
                if (s.end_us[n] - s.end_us[n - 1] > 5 * MS) places[with] |= 1u << n;
        }
        assert_int_not_equal(places[0], 0);
        assert_int_equal(places[1], places[0] << 1);
    }
}

TEST(duplicate_comes_twice_at_once_or_after_a_pause)
{
    stage_t s;
    stage_set(&s, A16_MODBUS, 1);
    ADD(&s, DUPLICATE, ALWAYS, 1);
    ADD(&s, DUPLICATE, ALWAYS, 2)->us = 30 * MS;
    stage_ask(&s, LITERAL(A16_ASKED), 200 * MS);
    EXPECT_BYTES(&s, A16_ANSWER, A16_ANSWER);
    assert_in_range(s.end_us[7] - s.end_us[6], CHARACTER_US - 1, CHARACTER_US);
    stage_ask(&s, LITERAL(A16_ASKED), 200 * MS);
    EXPECT_BYTES(&s, A16_ANSWER, A16_ANSWER);
    assert_in_range(s.end_us[7] - s.end_us[6], 30 * MS + CHARACTER_US - 1, 30 * MS + CHARACTER_US);
    stage_ask(&s, LITERAL(A16_ASKED), 200 * MS);
    EXPECT_BYTES(&s, A16_ANSWER);
    assert_int_equal(HITS(&s, DUPLICATE), 2);
}

TEST(delay_and_late_come_later_by_so_much)
{
    stage_t s;
    stage_t plain;
    stage_set(&plain, A16_MODBUS, 0); /* the same answer times */
    stage_set(&s, A16_MODBUS, 0);
    ADD(&s, DELAY, ALWAYS, 1);
    ADD(&s, DELAY, ALWAYS, 2)->us = 33 * MS;
    ADD(&s, LATE, ALWAYS, 3);
    ADD(&s, LATE, ALWAYS, 4)->us = 700 * MS;
    const uint32_t by_us[] = {20 * MS, 33 * MS, 1500 * MS, 700 * MS, 0};
    for (size_t i = 0; i < 5; i++) {
        stage_ask(&plain, LITERAL(A16_ASKED), 2000 * MS);
        stage_ask(&s, LITERAL(A16_ASKED), 2000 * MS);
        EXPECT_BYTES(&s, A16_ANSWER);
        assert_int_equal(s.end_us[0] - plain.end_us[0], by_us[i]);
    }
    assert_int_equal(HITS(&s, DELAY), 2);
    assert_int_equal(HITS(&s, LATE), 2);
    assert_int_equal(s.fault.frames_hit, 4);
}

TEST(a_late_answer_keeps_the_device_deaf_and_an_automatic_frame_may_be_late_too)
{
    stage_t s;
    stage_set(&s, A16_MODBUS, 0);
    ADD(&s, LATE, ALWAYS, 1)->us = 700 * MS;
    stage_ask(&s, LITERAL(A16_ASKED), 400 * MS);
    assert_int_equal(s.count, 0);
    stage_ask(&s, LITERAL(A16_ASKED), 500 * MS);
    EXPECT_BYTES(&s, A16_ANSWER);
    assert_int_equal(s.device->counters.unheard, 8);
    stage_set(&s, A16_AUTO, 0);
    ADD(&s, LATE, ALWAYS, 2)->us = 70 * MS;
    stage_wait(&s, 350 * MS);
    EXPECT_BYTES(&s, A16_FRAME, A16_FRAME, A16_FRAME);
    ASSERT_AT(at_us(&s, 4), due_us(2, 0) + 70 * MS);
    ASSERT_AT(at_us(&s, 8), due_us(3, 0));
}

TEST(silence_keeps_the_frame_back_and_the_device_is_free)
{
    stage_t s;
    stage_set(&s, A16_MODBUS, 0);
    ADD(&s, SILENCE, ALWAYS, 2);
    stage_ask(&s, LITERAL(A16_ASKED), 150 * MS);
    EXPECT_BYTES(&s, A16_ANSWER);
    stage_ask(&s, LITERAL(A16_ASKED), 130 * MS);
    assert_int_equal(s.count, 0);
    assert_int_equal(s.device->counters.answered, 2);
    assert_int_equal(HITS(&s, SILENCE), 1);
    stage_ask(&s, LITERAL(A16_ASKED), 150 * MS);
    EXPECT_BYTES(&s, A16_ANSWER);
}

TEST(power_cycle_cuts_the_frame_and_the_device_starts_anew)
{
    uint32_t lengths = 0;
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        stage_t s;
        stage_set(&s, A16_AUTO, seed);
        ADD(&s, POWER_CYCLE, ALWAYS, 2);
        stage_wait(&s, 2099 * MS); /* off from 200..204 ms for 2 s; the first frame 100 ms after that */
        assert_in_range(s.count, 4, 7);
        assert_memory_equal(s.bytes, ((const uint8_t[]){A16_FRAME, A16_FRAME}), s.count);
        const size_t sent = s.count - 4;
        lengths |= 1u << sent;
        stage_wait(&s, 300 * MS);
        EXPECT_BYTES(&s, A16_FRAME);
        ASSERT_AT(at_us(&s, 0), due_us(23, 0) + (uint32_t)sent * 10000000u / 9600u);
        assert_int_equal(HITS(&s, POWER_CYCLE), 1);
    }
    assert_int_equal(lengths, 0xF);
}

TEST(without_power_a_device_is_deaf_and_then_begins_in_its_first_mode)
{
    stage_t s;
    stage_set(&s, A16_AUTO, 3);
    s.bench.line.full_duplex = true;
    stage_ask(&s, LITERAL(A16_ASKED), 500 * MS); /* leaves automatic mode; a frame may come before */
    assert_true(s.count >= 7);
    ADD(&s, POWER_CYCLE, ALWAYS, s.fault.frames + 1)->us = 1000 * MS;
    stage_ask(&s, LITERAL(A16_ASKED), 500 * MS);
    assert_in_range(s.count, 0, 6);
    stage_ask(&s, LITERAL(A16_ASKED), 300 * MS);
    assert_int_equal(s.count, 0);
    assert_int_equal(s.device->counters.unheard, 8);
    stage_wait(&s, 600 * MS);
    assert_true(s.count >= 4);
    assert_memory_equal(s.bytes, ((const uint8_t[]){A16_FRAME}), 4);
}

TEST(noise_is_one_to_eight_bytes_apart_from_the_frame)
{
    uint32_t counts[2] = {0, 0};
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        stage_t s;
        stage_set(&s, A16_AUTO, seed);
        ADD(&s, NOISE, ALWAYS, 1);
        stage_wait(&s, 150 * MS);
        assert_in_range(s.count, 5, 12);
        const bool before = at_us(&s, 4) - at_us(&s, 3) < 2 * CHARACTER_US || s.bytes[0] != 0xFF;
        const size_t noise = s.count - 4;
        const size_t frame = before ? noise : 0;
        const size_t gap = before ? noise : 4;
        assert_memory_equal(s.bytes + frame, ((const uint8_t[]){A16_FRAME}), 4);
        ASSERT_AT(at_us(&s, gap) - at_us(&s, gap - 1) + 2, 3 * MS + CHARACTER_US);
        counts[before] |= 1u << noise;
        assert_int_equal(HITS(&s, NOISE), 1);
    }
    assert_int_equal(counts[0], 0x1FE);
    assert_int_equal(counts[1], 0x1FE);
}

TEST(after_its_own_bytes_a_device_listens_again_though_noise_follows)
{
    bool seen = false;
    for (uint32_t seed = 0; seed < 20 && !seen; seed++) {
        stage_t s;
        stage_set(&s, A16_MODBUS, seed);
        ADD(&s, NOISE, ALWAYS, 1)->us = 60 * MS;
        stage_ask(&s, LITERAL(A16_ASKED), 140 * MS);
        if (s.count != 7) continue; /* the noise comes before */
        seen = true;
        EXPECT_BYTES(&s, A16_ANSWER);
        bench_say(&s.bench, LITERAL(A16_ASKED)); /* over before the noise begins */
        stage_wait(&s, 300 * MS);
        assert_in_range(s.count, 8, 15);
        assert_memory_equal(s.bytes + s.count - 7, ((const uint8_t[]){A16_ANSWER}), 7);
        assert_int_equal(s.device->counters.unheard, 0);
    }
    assert_true(seen);
}

TEST(unasked_is_a_frame_of_the_devices_own)
{
    static const setting_t settings[] = {A16_AUTO, A16_MODBUS, A05_AUTO, A05_DYP, HPS167S};
    for (size_t n = 0; n < sizeof settings / sizeof settings[0]; n++) {
        const setting_t setting = settings[n];
        const size_t length = golden[setting].length;
        stage_t s;
        stage_set(&s, setting, 2);
        ADD(&s, UNASKED, ALWAYS, 2);
        stage_next(&s, setting);
        expect_golden(&s, setting);
        stage_next(&s, setting);
        assert_int_equal(s.count, 2 * length);
        assert_memory_equal(s.bytes, golden[setting].frame, length);
        assert_memory_equal(s.bytes + length, golden[setting].frame, length);
        assert_in_range(s.end_us[length] - s.end_us[length - 1], 10 * MS + 570, 10 * MS + CHARACTER_US + 1);
        stage_next(&s, setting);
        expect_golden(&s, setting);
        assert_int_equal(HITS(&s, UNASKED), 1);
    }
}

TEST(unasked_is_a_measurement_also_where_something_else_was_asked)
{
    bool before = false;
    bool after = false;
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        stage_t s;
        stage_set(&s, HPS167S, seed);
        ADD(&s, UNASKED, ALWAYS, 0);
        /* #4: 77 degrees Fahrenheit; the answer is 01 03 02 00 4D */
        stage_ask(&s, LITERAL(0x01, 0x03, 0x00, 0x04, 0x00, 0x01, 0xC5, 0xCB), 100 * MS);
        assert_int_equal(s.count, 7 + 13);
        const bool is_before = s.bytes[2] == 8;
        assert_memory_equal(s.bytes + (is_before ? 0 : 7), golden[HPS167S].frame, 13);
        assert_memory_equal(s.bytes + (is_before ? 13 : 0), ((const uint8_t[]){0x01, 0x03, 0x02, 0x00, 0x4D}),
                            5);
        before = before || is_before;
        after = after || !is_before;
    }
    assert_true(before && after);
}

TEST(noise_and_unasked_frames_come_also_when_the_frame_does_not)
{
    stage_t s;
    stage_set(&s, A16_MODBUS, 1);
    ADD(&s, SILENCE, ALWAYS, 0);
    ADD(&s, UNASKED, ALWAYS, 1);
    stage_ask(&s, LITERAL(A16_ASKED), 200 * MS);
    EXPECT_BYTES(&s, A16_ANSWER);
    assert_int_equal(s.fault.last_kinds, BIT(SILENCE) | BIT(UNASKED));
    stage_ask(&s, LITERAL(A16_ASKED), 200 * MS);
    assert_int_equal(s.count, 0);
}

TEST(echo_repeats_the_request_of_that_frame)
{
    stage_t s;
    stage_set(&s, A16_MODBUS, 1);
    ADD(&s, ECHO, ALWAYS, 2);
    for (uint32_t n = 1; n <= 3; n++) {
        stage_ask(&s, LITERAL(A16_ASKED), 200 * MS);
        if (n == 2)
            EXPECT_BYTES(&s, A16_ASKED, A16_ANSWER);
        else
            EXPECT_BYTES(&s, A16_ANSWER);
        assert_int_equal(HITS(&s, ECHO), n < 2 ? 0 : 1);
    }
    stage_set(&s, A16_MODBUS, 1); /* also the very first */
    ADD(&s, ECHO, ALWAYS, 0);
    stage_ask(&s, LITERAL(A16_ASKED), 200 * MS);
    EXPECT_BYTES(&s, A16_ASKED, A16_ANSWER);
    fathom_sim_fault_enable(&s.fault, false);
    stage_ask(&s, LITERAL(A16_ASKED), 200 * MS);
    EXPECT_BYTES(&s, A16_ANSWER);
}

TEST(a_line_that_has_an_echo_keeps_it)
{
    stage_t s;
    stage_set(&s, A16_MODBUS, 1);
    s.bench.line.echo = true;
    fathom_sim_fault_attach(&s.fault, &s.bench.line, s.device);
    ADD(&s, ECHO, ALWAYS, 2);
    for (uint32_t n = 1; n <= 3; n++) {
        stage_ask(&s, LITERAL(A16_ASKED), 200 * MS);
        EXPECT_BYTES(&s, A16_ASKED, A16_ANSWER);
    }
}
