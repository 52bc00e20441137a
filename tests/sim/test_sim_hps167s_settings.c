/* SPDX-License-Identifier: MIT */
/* Commands #7 to #11 of the HPS-167S: what each takes, answers, changes and keeps. */
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

static void set(stage_t *stage, int32_t distance, fathom_sim_hps167s_config_t config)
{
    bench_init(&stage->bench, &bench_19200);
    stage->fixed.value[0] = distance;
    config.scene = fathom_sim_fixed(&stage->fixed);
    fathom_sim_hps167s_init(&stage->hps, &config);
    bench_attach(&stage->bench, &stage->hps.device);
}

#define DEFAULTS ((fathom_sim_hps167s_config_t){0})

static void cycle_power(stage_t *s)
{
    fathom_sim_power_cycle(&s->bench.line, &s->hps.device, 100 * MS, s->bench.now_us);
    bench_wait(&s->bench, 150 * MS);
    EXPECT_SILENCE(&s->bench);
}

static void at_rate(stage_t *s, uint32_t baud)
{
    const fathom_line_settings_t settings = {baud, FATHOM_PARITY_EVEN, 1};
    fathom_sim_set_line(&s->bench.line, &settings, s->bench.now_us);
}

/* #2 of the device at `unit`: its eight bytes, of which these are the places. */
enum { TERMINATION, AUTO_OUTPUT, WARM_UP, BAUD = 7 };
static const uint8_t *configuration(stage_t *s)
{
    ASK(&s->bench, 30 * MS, 0x01, 0x03, 0x00, 0x02, 0x00, 0x04, 0xE5, 0xC9);
    assert_int_equal(s->bench.heard, 13);
    assert_memory_equal(s->bench.bytes, ((uint8_t[]){0x01, 0x03, 0x08}), 3);
    bench_forget(&s->bench);
    return s->bench.bytes + 3;
}

/* The distance that #5 says. */
static uint32_t distance(stage_t *s)
{
    ASK(&s->bench, 30 * MS, 0x01, 0x03, 0x00, 0x08, 0x00, 0x04, 0xC5, 0xCB);
    assert_int_equal(s->bench.heard, 13);
    bench_forget(&s->bench);
    return s->bench.bytes[3] * 256u + s->bench.bytes[4];
}

static const suite_t suite = {BENCH_ROUNDS};

/* ---- #7 ---- */

TEST(warm_up_of_tables_21_and_22_acts_from_the_next_power_on)
{
    stage_t s;
    set(&s, 2083, DEFAULTS);
    ASK(&s.bench, 30 * MS, 0x01, 0x06, 0x00, 0x0A, 0x00, 0x05, 0x69, 0xCB);
    EXPECT(&s.bench, 0x01, 0x06, 0x00, 0x0A, 0x00, 0x05, 0x69, 0xCB);
    assert_int_equal(configuration(&s)[WARM_UP], 5);
    assert_int_equal(distance(&s), 2083);
    cycle_power(&s); /* 50 ms ago it came */
    assert_int_equal(configuration(&s)[WARM_UP], 5);
    bench_wait(&s.bench, 4850 * MS);
    ASK(&s.bench, 10 * MS, 0x01, 0x03, 0x00, 0x08, 0x00, 0x04, 0xC5, 0xCB);
    EXPECT_SILENCE(&s.bench);
    bench_wait(&s.bench, 100 * MS);
    assert_int_equal(distance(&s), 2083);
}

TEST(the_longest_warm_up_is_255_s)
{
    stage_t s;
    set(&s, 2083, DEFAULTS);
    ASK(&s.bench, 30 * MS, 0x01, 0x06, 0x00, 0x0A, 0x00, 0xFF, 0xE9, 0x88);
    EXPECT(&s.bench, 0x01, 0x06, 0x00, 0x0A, 0x00, 0xFF, 0xE9, 0x88);
    cycle_power(&s);
    bench_wait(&s.bench, 254900 * MS);
    ASK(&s.bench, 10 * MS, 0x01, 0x03, 0x00, 0x08, 0x00, 0x04, 0xC5, 0xCB);
    EXPECT_SILENCE(&s.bench);
    bench_wait(&s.bench, 100 * MS);
    assert_int_equal(distance(&s), 2083);
}

/* ---- #8 ---- */

TEST(a_new_address_counts_at_once_and_is_acknowledged_from_the_old_one)
{
    stage_t s;
    set(&s, 2083, DEFAULTS);
    ASK(&s.bench, 30 * MS, 0x01, 0x06, 0x00, 0x10, 0x00, 0x05, 0x48, 0x0C);
    EXPECT(&s.bench, 0x01, 0x06, 0x00, 0x10, 0x00, 0x05, 0x48, 0x0C);
    ASK(&s.bench, 30 * MS, 0x01, 0x03, 0x00, 0x04, 0x00, 0x01, 0xC5, 0xCB);
    EXPECT_SILENCE(&s.bench);
    ASK(&s.bench, 30 * MS, 0x05, 0x03, 0x00, 0x04, 0x00, 0x01, 0xC4, 0x4F);
    EXPECT(&s.bench, 0x05, 0x03, 0x02, 0x00, 0x4D, 0x89, 0xB1);
    cycle_power(&s);
    ASK(&s.bench, 30 * MS, 0x05, 0x03, 0x00, 0x04, 0x00, 0x01, 0xC4, 0x4F);
    EXPECT(&s.bench, 0x05, 0x03, 0x02, 0x00, 0x4D, 0x89, 0xB1);
}

TEST(a_new_address_is_acknowledged_from_itself_as_an_option)
{
    stage_t s;
    set(&s, 2083, (fathom_sim_hps167s_config_t){.answers_from_new = true});
    ASK(&s.bench, 30 * MS, 0x01, 0x06, 0x00, 0x10, 0x00, 0x20, 0x89, 0xD7); /* 32, the highest */
    EXPECT(&s.bench, 0x20, 0x06, 0x00, 0x10, 0x00, 0x20, 0x8F, 0x66);
    ASK(&s.bench, 30 * MS, 0x20, 0x06, 0x00, 0x0A, 0x00, 0x05, 0x6F, 0x7A); /* other answers are as ever */
    EXPECT(&s.bench, 0x20, 0x06, 0x00, 0x0A, 0x00, 0x05, 0x6F, 0x7A);
    ASK(&s.bench, 30 * MS, 0x20, 0x03, 0x00, 0x09, 0x00, 0x01, 0x52, 0xB9); /* #6 makes it 1 */
    EXPECT(&s.bench, 0x01, 0x03, 0x02, 0x00, 0x01, 0x79, 0x84);
}

/* ---- #9 ---- */

TEST(rate_of_tables_25_and_26_is_echoed)
{
    stage_t s;
    set(&s, 2083, DEFAULTS);
    ASK(&s.bench, 30 * MS, 0x01, 0x06, 0x00, 0x11, 0x00, 0x01, 0x18, 0x0F);
    EXPECT(&s.bench, 0x01, 0x06, 0x00, 0x11, 0x00, 0x01, 0x18, 0x0F);
    assert_int_equal(configuration(&s)[BAUD], 1);
}

TEST(a_new_rate_counts_from_behind_its_acknowledgement)
{
    static const uint32_t baud[] = {19200, 57600, 115200, 230400};
    stage_t s;
    for (uint8_t i = 0; i < 16; i++) {
        const uint8_t from = i / 4, to = i % 4;
        set(&s, 2083, (fathom_sim_hps167s_config_t){.baud_code = (uint8_t)(from + 1)});
        at_rate(&s, baud[from]);
        uint8_t write[4][8] = {{0x01, 0x06, 0x00, 0x11, 0x00, 0x01, 0x18, 0x0F},
                               {0x01, 0x06, 0x00, 0x11, 0x00, 0x02, 0x58, 0x0E},
                               {0x01, 0x06, 0x00, 0x11, 0x00, 0x03, 0x99, 0xCE},
                               {0x01, 0x06, 0x00, 0x11, 0x00, 0x04, 0xD8, 0x0C}};
        bench_ask(&s.bench, write[to], 8, 30 * MS);
        bench_expect(&s.bench, write[to], 8); /* at the old rate */
        if (from != to) {
            ASK(&s.bench, 30 * MS, 0x01, 0x03, 0x00, 0x04, 0x00, 0x01, 0xC5, 0xCB);
            EXPECT_SILENCE(&s.bench);
            assert_true(s.hps.device.counters.wrong_settings != 0);
        }
        at_rate(&s, baud[to]);
        assert_int_equal(configuration(&s)[BAUD], to + 1);
        cycle_power(&s);
        assert_int_equal(configuration(&s)[BAUD], to + 1);
    }
}

TEST(a_new_rate_counts_from_the_next_power_on_as_an_option)
{
    stage_t s;
    set(&s, 2083, (fathom_sim_hps167s_config_t){.baud_at_power_on = true});
    ASK(&s.bench, 30 * MS, 0x01, 0x06, 0x00, 0x11, 0x00, 0x03, 0x99, 0xCE);
    EXPECT(&s.bench, 0x01, 0x06, 0x00, 0x11, 0x00, 0x03, 0x99, 0xCE);
    assert_int_equal(configuration(&s)[BAUD], 3); /* said at the old rate */
    cycle_power(&s);
    at_rate(&s, 115200);
    assert_int_equal(configuration(&s)[BAUD], 3);
}

TEST(every_other_code_is_19200)
{
    stage_t s;
    set(&s, 2083, (fathom_sim_hps167s_config_t){.baud_code = 4});
    at_rate(&s, 230400);
    ASK(&s.bench, 30 * MS, 0x01, 0x06, 0x00, 0x11, 0x00, 0x05, 0x19, 0xCC);
    EXPECT(&s.bench, 0x01, 0x06, 0x00, 0x11, 0x00, 0x05, 0x19, 0xCC);
    at_rate(&s, 19200);
    assert_int_equal(configuration(&s)[BAUD], 1);
    set(&s, 2083, (fathom_sim_hps167s_config_t){.baud_code = 4});
    at_rate(&s, 230400);
    ASK(&s.bench, 30 * MS, 0x01, 0x06, 0x00, 0x11, 0x01, 0x02, 0x59, 0x9E); /* 258, not 2 */
    EXPECT(&s.bench, 0x01, 0x06, 0x00, 0x11, 0x01, 0x02, 0x59, 0x9E);
    at_rate(&s, 19200);
    assert_int_equal(configuration(&s)[BAUD], 1);
    ASK(&s.bench, 30 * MS, 0x01, 0x06, 0x00, 0x11, 0x00, 0x00, 0xD9, 0xCF);
    EXPECT(&s.bench, 0x01, 0x06, 0x00, 0x11, 0x00, 0x00, 0xD9, 0xCF);
    assert_int_equal(configuration(&s)[BAUD], 1);
}

TEST(a_lost_acknowledgement_leaves_it_at_the_new_rate)
{
    fathom_sim_fault_t fault;
    stage_t s;
    set(&s, 2083, DEFAULTS);
    fathom_sim_fault_init(&fault, 1);
    assert_non_null(fathom_sim_fault_add(&fault, FATHOM_SIM_FAULT_SILENCE, FATHOM_SIM_FAULT_ALWAYS_PPM, 2));
    fathom_sim_fault_attach(&fault, &s.bench.line, &s.hps.device);
    assert_int_equal(configuration(&s)[BAUD], 1); /* frame 1 */
    ASK(&s.bench, 30 * MS, 0x01, 0x06, 0x00, 0x11, 0x00, 0x03, 0x99, 0xCE);
    EXPECT_SILENCE(&s.bench);
    assert_int_equal(fault.counters[FATHOM_SIM_FAULT_SILENCE], 1);
    ASK(&s.bench, 30 * MS, 0x01, 0x03, 0x00, 0x02, 0x00, 0x04, 0xE5, 0xC9);
    EXPECT_SILENCE(&s.bench);
    at_rate(&s, 115200);
    assert_int_equal(configuration(&s)[BAUD], 3);
    assert_int_equal(s.hps.device.counters.answered, 3); /* as it believes */
    assert_int_equal(fault.frames, 3);
}

/* ---- #10, #11 ---- */

static uint32_t measurement_us(stage_t *s)
{
    const uint32_t end_us = ASK(&s->bench, 50 * MS, 0x01, 0x03, 0x00, 0x08, 0x00, 0x04, 0xC5, 0xCB);
    assert_int_equal(s->bench.heard, 13);
    bench_forget(&s->bench);
    return fathom_elapsed_us(s->bench.end_us[0], end_us) - 573; /* a character is 572.9 us */
}

TEST(measuring_by_itself_ends_with_the_power_on_after_table_27)
{
    stage_t s;
    set(&s, 2083, DEFAULTS);
    ASK(&s.bench, 50 * MS, 0x01, 0x06, 0x00, 0x12, 0x00, 0x00, 0x29, 0xCF);
    EXPECT(&s.bench, 0x01, 0x06, 0x00, 0x12, 0x00, 0x00, 0x29, 0xCF);
    assert_int_equal(configuration(&s)[AUTO_OUTPUT], 0x00);
    assert_in_range(measurement_us(&s), 2186, 2500); /* one was ready */
    cycle_power(&s);
    assert_int_equal(configuration(&s)[AUTO_OUTPUT], 0x00);
    assert_in_range(measurement_us(&s), 18518, 18519);
    ASK(&s.bench, 50 * MS, 0x01, 0x06, 0x00, 0x12, 0x00, 0xFF, 0x69, 0x8F);
    EXPECT(&s.bench, 0x01, 0x06, 0x00, 0x12, 0x00, 0xFF, 0x69, 0x8F);
    assert_int_equal(configuration(&s)[AUTO_OUTPUT], 0xFF);
    assert_in_range(measurement_us(&s), 18518, 18519);
    cycle_power(&s);
    assert_int_equal(configuration(&s)[AUTO_OUTPUT], 0xFF);
    assert_in_range(measurement_us(&s), 2186, 2500);
}

TEST(termination_of_tables_29_and_30_is_switched_at_the_next_power_on)
{
    stage_t s;
    set(&s, 2083, (fathom_sim_hps167s_config_t){.no_termination = true});
    assert_false(s.hps.terminated);
    ASK(&s.bench, 30 * MS, 0x01, 0x06, 0x00, 0x13, 0x00, 0xFF, 0x38, 0x4F);
    EXPECT(&s.bench, 0x01, 0x06, 0x00, 0x13, 0x00, 0xFF, 0x38, 0x4F);
    assert_int_equal(configuration(&s)[TERMINATION], 0xFF);
    assert_false(s.hps.terminated);
    cycle_power(&s);
    assert_int_equal(configuration(&s)[TERMINATION], 0xFF);
    assert_true(s.hps.terminated);
    ASK(&s.bench, 30 * MS, 0x01, 0x06, 0x00, 0x13, 0x00, 0x00, 0x78, 0x0F);
    EXPECT(&s.bench, 0x01, 0x06, 0x00, 0x13, 0x00, 0x00, 0x78, 0x0F);
    assert_int_equal(configuration(&s)[TERMINATION], 0x00);
    assert_true(s.hps.terminated);
    cycle_power(&s);
    assert_false(s.hps.terminated);
}
