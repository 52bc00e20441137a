/* SPDX-License-Identifier: MIT */
#include "bench.h"
#include "sim/a05.h"
#include "sim/scene.h"

/* The 55 AA protocol of the A05 (A05 2(3)). 55 + AA is FF, so a sum is that of the rest less 1. */

enum { MS = 1000 };

typedef struct {
    bench_t bench;
    fathom_sim_fixed_t fixed;
    fathom_sim_a05_t a05;
} stage_t;

static void set(stage_t *stage, fathom_sim_fixed_t fixed, fathom_sim_a05_config_t config)
{
    bench_init(&stage->bench, &bench_9600);
    stage->fixed = fixed;
    config.mode = FATHOM_SIM_A05_DYP;
    config.scene = fathom_sim_fixed(&stage->fixed);
    fathom_sim_a05_init(&stage->a05, &config);
    bench_attach(&stage->bench, &stage->a05.device);
}

#define DEFAULTS   ((fathom_sim_a05_config_t){0})
#define FIXED(...) ((fathom_sim_fixed_t){{__VA_ARGS__}})
#define ALL        FIXED(1000, 2000, 1953, 3562) /* of the example in A05 2(3)3 */

static const suite_t suite = {BENCH_ROUNDS};

TEST(all_probes_are_those_of_a05_2_3_3_whose_sum_is_62_not_60)
{
    stage_t s;
    set(&s, ALL, DEFAULTS);
    ASK(&s.bench, 300 * MS, 0x55, 0xAA, 0x01, 0x01, 0x01);
    EXPECT(&s.bench, 0x55, 0xAA, 0x01, 0x01, 0x03, 0xE8, 0x07, 0xD0, 0x07, 0xA1, 0x0D, 0xEA, 0x62);
    assert_int_equal(s.a05.device.counters.measurements, 4);
    assert_int_equal(s.a05.device.counters.requests, 1);
    assert_int_equal(s.a05.device.counters.answered, 1);
}

TEST(one_probe_is_that_of_a05_2_3_4_and_the_others_follow)
{
    stage_t s;
    set(&s, FIXED(1953, 2000, 1000, 3562), DEFAULTS);
    ASK(&s.bench, 150 * MS, 0x55, 0xAA, 0x01, 0x10, 0x10);
    EXPECT(&s.bench, 0x55, 0xAA, 0x01, 0x10, 0x07, 0xA1, 0xB8);
    ASK(&s.bench, 150 * MS, 0x55, 0xAA, 0x01, 0x11, 0x11);
    EXPECT(&s.bench, 0x55, 0xAA, 0x01, 0x11, 0x07, 0xD0, 0xE8); /* 01 + 11 + 07 + D0 - 1 */
    ASK(&s.bench, 150 * MS, 0x55, 0xAA, 0x01, 0x12, 0x12);
    EXPECT(&s.bench, 0x55, 0xAA, 0x01, 0x12, 0x03, 0xE8, 0xFD); /* 01 + 12 + 03 + E8 - 1 */
    ASK(&s.bench, 150 * MS, 0x55, 0xAA, 0x01, 0x13, 0x13);
    EXPECT(&s.bench, 0x55, 0xAA, 0x01, 0x13, 0x0D, 0xEA, 0x0A); /* 01 + 13 + 0D + EA - 1 = 10A */
    assert_int_equal(s.a05.device.counters.measurements, 4);
}

TEST(no_target_and_interference_are_sent_as_in_the_other_modes)
{
    stage_t s;
    set(&s, FIXED(FATHOM_SIM_NO_TARGET, FATHOM_SIM_INTERFERENCE, 1, 2), DEFAULTS);
    ASK(&s.bench, 150 * MS, 0x55, 0xAA, 0x01, 0x10, 0x10);
    EXPECT(&s.bench, 0x55, 0xAA, 0x01, 0x10, 0xFF, 0xFD, 0x0C); /* 01 + 10 + FF + FD - 1 = 20C */
    ASK(&s.bench, 150 * MS, 0x55, 0xAA, 0x01, 0x11, 0x11);
    EXPECT(&s.bench, 0x55, 0xAA, 0x01, 0x11, 0xFF, 0xFE, 0x0E); /* 01 + 11 + FF + FE - 1 = 20E */
}

/* The spread of the first byte's end less its own 1042 us, over many seeds. */
static void times(const uint8_t *request, uint32_t least_ms, uint32_t most_ms)
{
    stage_t s;
    uint32_t least_us = UINT32_MAX;
    uint32_t most_us = 0;
    for (uint32_t seed = 0; seed < 200; seed++) {
        set(&s, ALL, (fathom_sim_a05_config_t){.seed = seed * 7919});
        const uint32_t end_us = bench_ask(&s.bench, request, 5, 300 * MS);
        const uint32_t after_us = fathom_elapsed_us(s.bench.end_us[0], end_us) - 1042;
        ASSERT_SPAN(after_us, 0, least_ms * MS, most_ms * MS);
        if (after_us < least_us) least_us = after_us;
        if (after_us > most_us) most_us = after_us;
    }
    assert_true(least_us < (least_ms + 1) * MS);
    assert_true(most_us > (most_ms - 1) * MS);
}

TEST(all_probes_take_200_to_210_ms_and_one_65_to_75_ms)
{
    times((const uint8_t[]){0x55, 0xAA, 0x01, 0x01, 0x01}, 200, 210);
    times((const uint8_t[]){0x55, 0xAA, 0x01, 0x10, 0x10}, 65, 75);
    times((const uint8_t[]){0x55, 0xAA, 0x01, 0x13, 0x13}, 65, 75);
}

TEST(other_times_may_be_set)
{
    stage_t s;
    set(&s, ALL, (fathom_sim_a05_config_t){.all_us = 400 * MS, .one_us = 30 * MS});
    uint32_t end_us = ASK(&s.bench, 500 * MS, 0x55, 0xAA, 0x01, 0x01, 0x01);
    ASSERT_SPAN(s.bench.end_us[0], end_us, 390 * MS + 1042, 400 * MS + 1042);
    bench_forget(&s.bench);
    end_us = ASK(&s.bench, 100 * MS, 0x55, 0xAA, 0x01, 0x10, 0x10);
    ASSERT_SPAN(s.bench.end_us[0], end_us, 20 * MS + 1042, 30 * MS + 1042);
}

TEST(it_measures_when_it_answers_and_is_deaf_until_then)
{
    stage_t s;
    set(&s, ALL, DEFAULTS);
    ASK(&s.bench, 30 * MS, 0x55, 0xAA, 0x01, 0x10, 0x10);
    s.fixed.value[0] = 1953;
    ASK(&s.bench, 200 * MS, 0x55, 0xAA, 0x01, 0x11, 0x11);
    EXPECT(&s.bench, 0x55, 0xAA, 0x01, 0x10, 0x07, 0xA1, 0xB8);
    assert_int_equal(s.a05.device.counters.unheard, 5);
}

TEST(set_address_is_answered_with_its_own_bytes_a05_2_3_5)
{
    stage_t s;
    set(&s, ALL, DEFAULTS);
    ASK(&s.bench, 50 * MS, 0x55, 0xAA, 0x05, 0x03, 0x07);
    EXPECT(&s.bench, 0x55, 0xAA, 0x05, 0x03, 0x07);
    assert_int_equal(s.a05.device.counters.writes, 1);
    ASK(&s.bench, 300 * MS, 0x55, 0xAA, 0x01, 0x10, 0x10); /* the old one */
    EXPECT_SILENCE(&s.bench);
    assert_int_equal(s.a05.device.counters.others, 1);
    ASK(&s.bench, 300 * MS, 0x55, 0xAA, 0x05, 0x11, 0x15);
    EXPECT(&s.bench, 0x55, 0xAA, 0x05, 0x11, 0x07, 0xD0, 0xEC);             /* 05 + 11 + 07 + D0 - 1 */
    ASK(&s.bench, 50 * MS, 0x05, 0x03, 0x02, 0x00, 0x00, 0x01, 0x84, 0x36); /* and in Modbus */
    EXPECT(&s.bench, 0x05, 0x03, 0x02, 0x00, 0x05, 0x89, 0x87);
    ASK(&s.bench, 50 * MS, 0x55, 0xAA, 0xFE, 0x03, 0x00); /* the highest: FE + 03 - 1 = 100 */
    EXPECT(&s.bench, 0x55, 0xAA, 0xFE, 0x03, 0x00);
    assert_int_equal(s.a05.device.unit, 0xFE);
}

TEST(every_unit_that_hears_set_address_obeys_it)
{
    stage_t s;
    fathom_sim_a05_t other;
    set(&s, ALL, (fathom_sim_a05_config_t){.settings_us = 20 * MS});
    fathom_sim_a05_init(
        &other, &(fathom_sim_a05_config_t){.unit = 2, .mode = FATHOM_SIM_A05_DYP, .settings_us = 60 * MS});
    bench_attach(&s.bench, &other.device);
    ASK(&s.bench, 70 * MS, 0x55, 0xAA, 0x05, 0x03, 0x07);
    assert_int_equal(s.a05.device.unit, 5);
    assert_int_equal(other.device.unit, 5);
    EXPECT(&s.bench, 0x55, 0xAA, 0x05, 0x03, 0x07, 0x55, 0xAA, 0x05, 0x03, 0x07);
    /* the second answer is a request again to the first unit, which was no longer deaf */
    bench_wait(&s.bench, 25 * MS);
    EXPECT(&s.bench, 0x55, 0xAA, 0x05, 0x03, 0x07);
    assert_int_equal(s.a05.device.counters.writes, 2);
}

TEST(addresses_00_and_ff_are_refused_in_silence)
{
    stage_t s;
    set(&s, ALL, DEFAULTS);
    ASK(&s.bench, 300 * MS, 0x55, 0xAA, 0x00, 0x03, 0x02);
    ASK(&s.bench, 300 * MS, 0x55, 0xAA, 0xFF, 0x03, 0x01);
    EXPECT_SILENCE(&s.bench);
    assert_int_equal(s.a05.device.unit, 1);
    assert_int_equal(s.a05.device.counters.writes, 0);
    assert_int_equal(s.a05.device.counters.unserved, 2);
}

TEST(ff_is_obeyed_and_answered_from_its_own_address_unless_told_not_to)
{
    stage_t s;
    set(&s, ALL, (fathom_sim_a05_config_t){.unit = 7});
    ASK(&s.bench, 300 * MS, 0x55, 0xAA, 0xFF, 0x11, 0x0F);
    EXPECT(&s.bench, 0x55, 0xAA, 0x07, 0x11, 0x07, 0xD0, 0xEE);              /* 07 + 11 + 07 + D0 - 1 */
    ASK(&s.bench, 300 * MS, 0xFF, 0x03, 0x01, 0x06, 0x00, 0x01, 0x70, 0x29); /* Modbus has its own option */
    EXPECT_SILENCE(&s.bench);
    set(&s, ALL, (fathom_sim_a05_config_t){.unit = 7, .dyp_silent_broadcast = true});
    ASK(&s.bench, 300 * MS, 0x55, 0xAA, 0xFF, 0x11, 0x0F);
    EXPECT_SILENCE(&s.bench);
    assert_int_equal(s.a05.device.counters.requests, 1);
    assert_int_equal(s.a05.device.counters.unserved, 0);
    ASK(&s.bench, 300 * MS, 0x55, 0xAA, 0x07, 0x11, 0x17);
    EXPECT(&s.bench, 0x55, 0xAA, 0x07, 0x11, 0x07, 0xD0, 0xEE);
}

TEST(what_it_does_not_know_is_silence_and_counted)
{
    stage_t s;
    set(&s, ALL, DEFAULTS);
    ASK(&s.bench, 300 * MS, 0x55, 0xAA, 0x01, 0x01, 0x02); /* the sum is 01 */
    ASK(&s.bench, 300 * MS, 0x55, 0xAA, 0x01, 0x00);       /* the sum of three, but too short */
    ASK(&s.bench, 300 * MS, 0x55, 0xAA, 0xFF);
    assert_int_equal(s.a05.device.counters.crc_errors, 3);
    ASK(&s.bench, 300 * MS, 0x55, 0xAA, 0x01, 0x00, 0x00); /* no such command */
    ASK(&s.bench, 300 * MS, 0x55, 0xAA, 0x01, 0x02, 0x02);
    ASK(&s.bench, 300 * MS, 0x55, 0xAA, 0x01, 0x0F, 0x0F);
    ASK(&s.bench, 300 * MS, 0x55, 0xAA, 0x01, 0x14, 0x14);
    ASK(&s.bench, 300 * MS, 0x55, 0xAA, 0x01, 0x01, 0x00, 0x01);       /* a byte too long */
    ASK(&s.bench, 300 * MS, 0x55, 0xAA, 0x05, 0x03, 0x00, 0x07);       /* also to set the address */
    ASK(&s.bench, 300 * MS, 0x55, 0xAA, 0x01, 0x10, 0x07, 0xA1, 0xB8); /* an answer */
    assert_int_equal(s.a05.device.counters.unserved, 7);
    ASK(&s.bench, 300 * MS, 0x55, 0xAA, 0x02, 0x01, 0x02); /* another unit */
    assert_int_equal(s.a05.device.counters.others, 1);
    EXPECT_SILENCE(&s.bench);
    assert_int_equal(s.a05.device.unit, 1);
    assert_int_equal(s.a05.device.counters.measurements, 0);
    ASK(&s.bench, 300 * MS, 0x55, 0xAA, 0x01, 0x10, 0x10);
    EXPECT(&s.bench, 0x55, 0xAA, 0x01, 0x10, 0x03, 0xE8, 0xFB); /* 01 + 10 + 03 + E8 - 1 */
}

TEST(it_speaks_modbus_at_the_same_time)
{
    stage_t s;
    set(&s, FIXED(316, 250, 659, 2426), DEFAULTS);
    ASK(&s.bench, 450 * MS, 0x01, 0x03, 0x01, 0x07, 0x00, 0x03, 0xB5, 0xF6);
    EXPECT(&s.bench, 0x01, 0x03, 0x06, 0x00, 0xFA, 0x02, 0x93, 0x09, 0x7A, 0x8F, 0x47);
    ASK(&s.bench, 300 * MS, 0x55, 0xAA, 0x01, 0x11, 0x11);
    EXPECT(&s.bench, 0x55, 0xAA, 0x01, 0x11, 0x00, 0xFA, 0x0B); /* 01 + 11 + FA - 1 = 10B */
    ASK(&s.bench, 50 * MS, 0x01, 0x06, 0x02, 0x00, 0x00, 0x05, 0x48, 0x71);
    EXPECT(&s.bench, 0x01, 0x06, 0x02, 0x00, 0x00, 0x05, 0x48, 0x71);
    ASK(&s.bench, 300 * MS, 0x55, 0xAA, 0x05, 0x11, 0x15);
    EXPECT(&s.bench, 0x55, 0xAA, 0x05, 0x11, 0x00, 0xFA, 0x0F);
}

TEST(the_other_modes_do_not_speak_it_and_this_one_sends_nothing_by_itself)
{
    stage_t s;
    set(&s, ALL, DEFAULTS);
    bench_wait(&s.bench, 5000 * MS);
    EXPECT_SILENCE(&s.bench);
    bench_init(&s.bench, &bench_9600);
    fathom_sim_a05_init(&s.a05, &(fathom_sim_a05_config_t){.mode = FATHOM_SIM_A05_MODBUS});
    bench_attach(&s.bench, &s.a05.device);
    ASK(&s.bench, 300 * MS, 0x55, 0xAA, 0x01, 0x01, 0x01);
    ASK(&s.bench, 300 * MS, 0x55, 0xAA, 0x05, 0x03, 0x07);
    EXPECT_SILENCE(&s.bench);
    assert_int_equal(s.a05.device.counters.crc_errors, 2);
    assert_int_equal(s.a05.device.unit, 1);
}
