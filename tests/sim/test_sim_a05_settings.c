/* SPDX-License-Identifier: MIT */
/* What the A05 keeps, and what it looks at when power comes: A05 1(1), 2(3)5, 3(4)2. */
#include "bench.h"
#include "sim/a05.h"
#include "sim/scene.h"

enum { MS = 1000 };

typedef struct {
    bench_t bench;
    fathom_sim_fixed_t fixed;
    fathom_sim_fixed_t processed;
    fathom_sim_a05_t a05;
} stage_t;

/* Real-time the probes of the example in 1(3), processed those of 3(4)1. */
static void set(stage_t *stage, uint8_t mode, fathom_sim_a05_config_t config)
{
    bench_init(&stage->bench, &bench_9600);
    stage->fixed = (fathom_sim_fixed_t){{1000, 2000, 1953, 3562}};
    stage->processed = (fathom_sim_fixed_t){{316, 250, 659, 2426}};
    config.mode = mode;
    config.scene = fathom_sim_fixed(&stage->fixed);
    config.processed = fathom_sim_fixed(&stage->processed);
    fathom_sim_a05_init(&stage->a05, &config);
    stage->bench.line.full_duplex = mode == FATHOM_SIM_A05_AUTO;
    bench_attach(&stage->bench, &stage->a05.device);
}

static void cycle_power(stage_t *s)
{
    fathom_sim_power_cycle(&s->bench.line, &s->a05.device, 100 * MS, s->bench.now_us);
    bench_wait(&s->bench, 101 * MS);
    EXPECT_SILENCE(&s->bench);
}

#define DEFAULTS  ((fathom_sim_a05_config_t){0})
#define REAL_TIME 0xFF, 0x03, 0xE8, 0x07, 0xD0, 0x07, 0xA1, 0x0D, 0xEA, 0x60 /* 1(3) */
#define PROCESSED 0xFF, 0x01, 0x3C, 0x00, 0xFA, 0x02, 0x93, 0x09, 0x7A, 0x4E

static const suite_t suite = {BENCH_ROUNDS};

TEST(the_level_of_rx_at_power_on_selects_what_automatic_frames_say)
{
    stage_t s;
    set(&s, FATHOM_SIM_A05_AUTO, DEFAULTS); /* floating or high */
    bench_wait(&s.bench, 320 * MS);
    EXPECT(&s.bench, PROCESSED);
    set(&s, FATHOM_SIM_A05_AUTO, (fathom_sim_a05_config_t){.real_time = true});
    bench_wait(&s.bench, 320 * MS);
    EXPECT(&s.bench, REAL_TIME);
}

TEST(the_level_counts_when_power_comes_and_not_later)
{
    stage_t s;
    set(&s, FATHOM_SIM_A05_AUTO, DEFAULTS);
    s.a05.real_time = true;
    bench_wait(&s.bench, 320 * MS);
    EXPECT(&s.bench, PROCESSED);
    cycle_power(&s);
    s.a05.real_time = false;
    bench_wait(&s.bench, 320 * MS);
    EXPECT(&s.bench, REAL_TIME);
    cycle_power(&s); /* it is not kept */
    bench_wait(&s.bench, 320 * MS);
    EXPECT(&s.bench, PROCESSED);
}

TEST(what_is_asked_for_is_real_time_whatever_was_selected)
{
    stage_t s;
    set(&s, FATHOM_SIM_A05_DYP, DEFAULTS);
    ASK(&s.bench, 450 * MS, 0x01, 0x03, 0x01, 0x06, 0x00, 0x04, 0xA5, 0xF4);
    EXPECT(&s.bench, 0x01, 0x03, 0x08, 0x03, 0xE8, 0x07, 0xD0, 0x07, 0xA1, 0x0D, 0xEA, 0xA8, 0x20);
    ASK(&s.bench, 250 * MS, 0x55, 0xAA, 0x01, 0x01, 0x01); /* 2(3)3; the printed sum of the answer is wrong */
    EXPECT(&s.bench, 0x55, 0xAA, 0x01, 0x01, 0x03, 0xE8, 0x07, 0xD0, 0x07, 0xA1, 0x0D, 0xEA, 0x62);
}

TEST(without_processed_values_of_their_own_they_are_the_real_time_ones)
{
    stage_t s;
    set(&s, FATHOM_SIM_A05_AUTO, DEFAULTS);
    s.a05.device.processed.distance = NULL;
    bench_wait(&s.bench, 320 * MS);
    EXPECT(&s.bench, REAL_TIME);
}

TEST(the_address_is_kept_whichever_protocol_set_it)
{
    stage_t s;
    set(&s, FATHOM_SIM_A05_DYP, DEFAULTS);
    ASK(&s.bench, 50 * MS, 0x55, 0xAA, 0x05, 0x03, 0x07); /* 2(3)5 */
    EXPECT(&s.bench, 0x55, 0xAA, 0x05, 0x03, 0x07);
    cycle_power(&s);
    ASK(&s.bench, 50 * MS, 0x05, 0x03, 0x02, 0x00, 0x00, 0x01, 0x84, 0x36);
    EXPECT(&s.bench, 0x05, 0x03, 0x02, 0x00, 0x05, 0x89, 0x87);
    ASK(&s.bench, 50 * MS, 0x05, 0x06, 0x02, 0x00, 0x00, 0x09, 0x49, 0xF0);
    EXPECT(&s.bench, 0x05, 0x06, 0x02, 0x00, 0x00, 0x09, 0x49, 0xF0);
    cycle_power(&s);
    ASK(&s.bench, 100 * MS, 0x55, 0xAA, 0x09, 0x10, 0x18);      /* 55 + AA + 09 + 10 = 118 */
    EXPECT(&s.bench, 0x55, 0xAA, 0x09, 0x10, 0x03, 0xE8, 0x03); /* 118 + 03 + E8 = 203 */
    assert_int_equal(s.a05.device.counters.writes, 2);
    assert_int_equal(s.a05.device.counters.flash_writes, 2);
}

TEST(flash_wears_also_when_the_address_is_what_it_was)
{
    stage_t s;
    set(&s, FATHOM_SIM_A05_DYP, DEFAULTS);
    ASK(&s.bench, 50 * MS, 0x01, 0x06, 0x02, 0x00, 0x00, 0x01, 0x49, 0xB2);
    ASK(&s.bench, 50 * MS, 0x55, 0xAA, 0x01, 0x03, 0x03);
    assert_int_equal(s.a05.device.counters.flash_writes, 2);
}

TEST(what_it_does_not_obey_is_counted)
{
    stage_t s;
    set(&s, FATHOM_SIM_A05_DYP, DEFAULTS);
    ASK(&s.bench, 50 * MS, 0x01, 0x06, 0x02, 0x00, 0x00, 0xFF, 0xC8, 0x32);
    ASK(&s.bench, 50 * MS, 0x01, 0x06, 0x02, 0x00, 0x01, 0x05, 0x49, 0xE1);
    ASK(&s.bench, 50 * MS, 0x01, 0x06, 0x01, 0x06, 0x00, 0x05, 0xA8, 0x34);
    ASK(&s.bench, 50 * MS, 0x01, 0x10, 0x02, 0x00, 0x00, 0x01, 0x02, 0x00, 0x05, 0x45, 0x93);
    ASK(&s.bench, 50 * MS, 0x55, 0xAA, 0x00, 0x03, 0x02); /* 00 and FF are no addresses */
    ASK(&s.bench, 50 * MS, 0x55, 0xAA, 0xFF, 0x03, 0x01);
    ASK(&s.bench, 50 * MS, 0x55, 0xAA, 0x05, 0x03, 0x00, 0x00, 0x07); /* another length */
    EXPECT_SILENCE(&s.bench);
    assert_int_equal(s.a05.device.unit, 1);
    assert_int_equal(s.a05.device.counters.writes_refused, 7);
    assert_int_equal(s.a05.device.counters.writes, 0);
    assert_int_equal(s.a05.device.counters.flash_writes, 0);
    ASK(&s.bench, 100 * MS, 0x55, 0xAA, 0x01, 0x14, 0x14); /* refused, but no write */
    ASK(&s.bench, 100 * MS, 0x01, 0x03, 0x01, 0x0A, 0x00, 0x01, 0xA5, 0xF4);
    EXPECT_SILENCE(&s.bench);
    assert_int_equal(s.a05.device.counters.writes_refused, 7);
}

TEST(a_new_address_is_acknowledged_from_itself_as_an_option)
{
    stage_t s;
    set(&s, FATHOM_SIM_A05_MODBUS, (fathom_sim_a05_config_t){.answers_from_new = true});
    ASK(&s.bench, 50 * MS, 0x01, 0x06, 0x02, 0x00, 0x00, 0x05, 0x48, 0x71);
    EXPECT(&s.bench, 0x05, 0x06, 0x02, 0x00, 0x00, 0x05, 0x49, 0xF5);
}
