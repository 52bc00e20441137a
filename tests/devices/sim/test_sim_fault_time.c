/* SPDX-License-Identifier: MIT */
#include "fault_bench.h"

/* Kinds that change when a frame comes, whether it does, and what comes around it. */

enum { SEEDS = 100, CHARACTER_US = 1042 }; /* 10 bits at 9600 */

/* The end of byte n of an automatic frame k (1...), from power-on, when nothing delays it. */
static uint32_t due_us(uint32_t k, uint32_t n) { return k * 100 * MS + (n + 1) * 10000000u / 9600u; }

static uint32_t at_us(size_t byte) { return bench.end_us[byte] - bench_start_us; }

/* A span that is right to 2 us: ends are rounded up to whole us. */
#define ASSERT_AT(is_us, should_us) assert_in_range((is_us), (should_us), (should_us) + 2)

EACH_BEGINS(set_faulty(A16_MODBUS, 1))
static const suite_t suite = {BENCH_ROUNDS, .set_up = begins};

TEST(split_pauses_before_any_byte_but_the_first)
{
    uint32_t places = 0;
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        set_faulty(A16_AUTO, seed);
        fathom_sim_fault_rule_t *const rule = FAULT(SPLIT, ALWAYS, 2);
        if ((seed & 1) != 0) rule->us = 25 * MS;
        const uint32_t pause_us = (seed & 1) != 0 ? 25 * MS : 10 * MS;
        hear(350, A16_FRAME A16_FRAME A16_FRAME);
        ASSERT_AT(at_us(4), due_us(2, 0));
        ASSERT_AT(at_us(7), due_us(2, 3) + pause_us);
        for (uint32_t n = 1; n < 4; n++) {
            const uint32_t gap_us = at_us(4 + n) - at_us(3 + n);
            if (gap_us > 2 * CHARACTER_US) places |= 1u << n;
        }
        ASSERT_AT(at_us(8), due_us(3, 0)); /* the period holds */
        assert_int_equal(HITS(SPLIT), 1);
    }
    assert_int_equal(places, 0xE);
}

TEST(a_pause_moves_with_its_byte_when_a_break_comes_first)
{
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        uint32_t places[2] = {0, 0};
        for (int with = 0; with < 2; with++) {
            set_faulty(A16_AUTO, seed);
            FAULT(SPLIT, ALWAYS, 1);
            if (with == 1) FAULT(BREAK, ALWAYS, 1);
            wait_ms(150);
            assert_int_equal(bench.heard, 4 + (size_t)with);
            for (size_t n = 1; n < bench.heard; n++)
                if (bench.end_us[n] - bench.end_us[n - 1] > 5 * MS) places[with] |= 1u << n;
        }
        assert_int_not_equal(places[0], 0);
        assert_int_equal(places[1], places[0] << 1);
    }
}

TEST(duplicate_comes_twice_at_once_or_after_a_pause)
{
    FAULT(DUPLICATE, ALWAYS, 1);
    FAULT(DUPLICATE, ALWAYS, 2)->us = 30 * MS;
    next(A16_MODBUS);
    expect(A16_RESPONSE A16_RESPONSE);
    assert_in_range(bench.end_us[7] - bench.end_us[6], CHARACTER_US - 1, CHARACTER_US);
    next(A16_MODBUS);
    expect(A16_RESPONSE A16_RESPONSE);
    assert_in_range(bench.end_us[7] - bench.end_us[6], 30 * MS + CHARACTER_US - 1, 30 * MS + CHARACTER_US);
    next_is_golden(A16_MODBUS);
    assert_int_equal(HITS(DUPLICATE), 2);
}

TEST(delay_and_late_come_later_by_so_much)
{
    static const uint32_t by_us[] = {20 * MS, 33 * MS, 1500 * MS, 700 * MS, 0};
    uint32_t plain_us[5];
    for (int is_hit = 0; is_hit < 2; is_hit++) {
        set_faulty(A16_MODBUS, 0); /* the same response times */
        FAULT(DELAY, ALWAYS, 1);
        FAULT(DELAY, ALWAYS, 2)->us = 33 * MS;
        FAULT(LATE, ALWAYS, 3);
        FAULT(LATE, ALWAYS, 4)->us = 700 * MS;
        fathom_sim_fault_enable(&bench.fault, is_hit != 0);
        for (size_t i = 0; i < 5; i++) {
            transact(A16_ASKED, 2000, A16_RESPONSE);
            if (is_hit == 0) plain_us[i] = bench.end_us[0];
            assert_int_equal(bench.end_us[0] - plain_us[i], is_hit != 0 ? by_us[i] : 0);
        }
    }
    assert_int_equal(HITS(DELAY), 2);
    assert_int_equal(HITS(LATE), 2);
    assert_int_equal(bench.fault.frames_hit, 4);
}

TEST(a_late_response_keeps_the_device_deaf_and_an_automatic_frame_may_be_late_too)
{
    set_faulty(A16_MODBUS, 0);
    FAULT(LATE, ALWAYS, 1)->us = 700 * MS;
    transact(A16_ASKED, 400, "");
    const uint32_t asked_us = bench.asked_us;
    transact(A16_ASKED, 500, A16_RESPONSE); /* the host asks again, in vain */
    ASSERT_SPAN(bench.end_us[0], asked_us, 805 * MS, 822 * MS);
    hear(2000, "");
    COUNTED(.requests = 1, .unheard = 8);
    set_faulty(A16_AUTO, 0);
    FAULT(LATE, ALWAYS, 2)->us = 70 * MS;
    hear(350, A16_FRAME A16_FRAME A16_FRAME);
    ASSERT_AT(at_us(4), due_us(2, 0) + 70 * MS);
    ASSERT_AT(at_us(8), due_us(3, 0));
}

TEST(silence_keeps_the_frame_back_and_the_device_is_free)
{
    set_faulty(A16_MODBUS, 0);
    FAULT(SILENCE, ALWAYS, 2);
    transact(A16_ASKED, 150, A16_RESPONSE);
    transact(A16_ASKED, 130, "");
    COUNTED(.answered = 2);
    assert_int_equal(HITS(SILENCE), 1);
    transact(A16_ASKED, 150, A16_RESPONSE);
}

TEST(power_cycle_cuts_the_frame_and_the_device_starts_anew)
{
    uint32_t lengths = 0;
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        set_faulty(A16_AUTO, seed);
        FAULT(POWER_CYCLE, ALWAYS, 2);
        wait_ms(2099); /* off from 200..204 ms for 2 s; the first frame 100 ms after that */
        assert_in_range(bench.heard, 4, 7);
        assert_memory_equal(bench.bytes, ((const uint8_t[]){0xFF, 0x02, 0xEF, 0xF0, 0xFF, 0x02, 0xEF}),
                            bench.heard);
        const size_t sent = bench.heard - 4;
        forget();
        lengths |= 1u << sent;
        hear(300, A16_FRAME);
        ASSERT_AT(at_us(0), due_us(23, 0) + (uint32_t)sent * 10000000u / 9600u);
        assert_int_equal(HITS(POWER_CYCLE), 1);
    }
    assert_int_equal(lengths, 0xF);
}

TEST(without_power_a_device_is_deaf_and_then_begins_in_its_first_mode)
{
    set_faulty(A16_AUTO, 3);
    bench.line.full_duplex = true;
    ask(A16_ASKED, 500); /* leaves automatic mode; a frame may come before */
    assert_true(bench.heard >= 7);
    forget();
    FAULT(POWER_CYCLE, ALWAYS, bench.fault.frames + 1)->us = 1000 * MS;
    ask(A16_ASKED, 500);
    assert_in_range(bench.heard, 0, 6);
    forget();
    transact(A16_ASKED, 300, "");
    COUNTED(.unheard = 8);
    wait_ms(600);
    assert_true(bench.heard >= 4);
    assert_true(is_hex(bench.bytes, A16_FRAME));
}

TEST(noise_is_one_to_eight_bytes_apart_from_the_frame)
{
    uint32_t counts[2] = {0, 0};
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        set_faulty(A16_AUTO, seed);
        FAULT(NOISE, ALWAYS, 1);
        wait_ms(150);
        assert_in_range(bench.heard, 5, 12);
        const bool before = at_us(4) - at_us(3) < 2 * CHARACTER_US || bench.bytes[0] != 0xFF;
        const size_t noise = bench.heard - 4;
        const size_t frame = before ? noise : 0;
        const size_t gap = before ? noise : 4;
        assert_true(is_hex(bench.bytes + frame, A16_FRAME));
        ASSERT_AT(at_us(gap) - at_us(gap - 1) + 2, 3 * MS + CHARACTER_US);
        counts[before] |= 1u << noise;
        assert_int_equal(HITS(NOISE), 1);
    }
    assert_int_equal(counts[0], 0x1FE);
    assert_int_equal(counts[1], 0x1FE);
}

TEST(after_its_own_bytes_a_device_listens_again_though_noise_follows)
{
    bool seen = false;
    for (uint32_t seed = 0; seed < 20 && !seen; seed++) {
        set_faulty(A16_MODBUS, seed);
        FAULT(NOISE, ALWAYS, 1)->us = 60 * MS;
        ask(A16_ASKED, 140);
        if (bench.heard != 7) continue; /* the noise comes before */
        seen = true;
        expect(A16_RESPONSE);
        say(A16_ASKED); /* over before the noise begins */
        wait_ms(300);
        assert_in_range(bench.heard, 8, 15);
        assert_true(is_hex(bench.bytes + bench.heard - 7, A16_RESPONSE));
        COUNTED(.unheard = NONE);
    }
    assert_true(seen);
}

TEST(unasked_is_a_frame_of_the_devices_own)
{
    for (setting_t setting = 0; setting < SETTINGS; setting++) {
        const size_t length = golden[setting].length;
        set_faulty(setting, 2);
        FAULT(UNASKED, ALWAYS, 2);
        next_is_golden(setting);
        next(setting);
        assert_int_equal(bench.heard, 2 * length);
        assert_true(is_hex(bench.bytes, golden[setting].frame));
        assert_true(is_hex(bench.bytes + length, golden[setting].frame));
        assert_in_range(bench.end_us[length] - bench.end_us[length - 1], 10 * MS + 570,
                        10 * MS + CHARACTER_US + 1);
        next_is_golden(setting);
        assert_int_equal(HITS(UNASKED), 1);
    }
}

TEST(unasked_is_a_measurement_also_where_something_else_was_asked)
{
    bool before = false, after = false;
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        set_faulty(HPS167S, seed);
        FAULT(UNASKED, ALWAYS, 0);
        /* #4: 77 degrees Fahrenheit; the response is 01 03 02 00 4D */
        ask("01 03 00 04 00 01 C5 CB", 100);
        assert_int_equal(bench.heard, 7 + 13);
        const bool is_before = bench.bytes[2] == 8;
        assert_true(is_hex(bench.bytes + (is_before ? 0 : 7), golden[HPS167S].frame));
        assert_true(is_hex(bench.bytes + (is_before ? 13 : 0), "01 03 02 00 4D"));
        before = before || is_before;
        after = after || !is_before;
    }
    assert_true(before && after);
}

TEST(noise_and_unasked_frames_come_also_when_the_frame_does_not)
{
    FAULT(SILENCE, ALWAYS, 0);
    FAULT(UNASKED, ALWAYS, 1);
    next_is_golden(A16_MODBUS);
    assert_int_equal(bench.fault.last_kinds, BIT(SILENCE) | BIT(UNASKED));
    next(A16_MODBUS);
    expect("");
}

TEST(echo_repeats_the_request_of_that_frame)
{
    FAULT(ECHO, ALWAYS, 2);
    for (uint32_t n = 1; n <= 3; n++) {
        next(A16_MODBUS);
        expect(n == 2 ? A16_ASKED A16_RESPONSE : A16_RESPONSE);
        assert_int_equal(HITS(ECHO), n < 2 ? 0 : 1);
    }
    set_faulty(A16_MODBUS, 1); /* also the very first */
    FAULT(ECHO, ALWAYS, 0);
    next(A16_MODBUS);
    expect(A16_ASKED A16_RESPONSE);
    fathom_sim_fault_enable(&bench.fault, false);
    next_is_golden(A16_MODBUS);
}

TEST(a_line_that_has_an_echo_keeps_it)
{
    bench.line.echo = true;
    fathom_sim_fault_attach(&bench.fault, &bench.line, bench.device);
    FAULT(ECHO, ALWAYS, 2);
    for (uint32_t n = 1; n <= 3; n++) {
        next(A16_MODBUS);
        expect(A16_ASKED A16_RESPONSE);
    }
}
