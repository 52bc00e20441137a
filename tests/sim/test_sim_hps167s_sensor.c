/* SPDX-License-Identifier: MIT */
/* Commands #12 to #15 of the HPS-167S: what each takes, answers, changes and keeps. */
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

static void cycle_power(stage_t *s)
{
    fathom_sim_power_cycle(&s->bench.line, &s->hps.device, 100 * MS, s->bench.now_us);
    bench_wait(&s->bench, 150 * MS);
    EXPECT_SILENCE(&s->bench);
}

/* #2 of the device at `unit`: its eight bytes, of which these are the places. */
enum { AUTO_OUTPUT = 1, RECONNECT = 3 };
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

/* ---- #12, #13, #14 ---- */

TEST(the_offset_of_the_example_makes_215_mm_200_mm)
{
    stage_t s;
    set(&s, 215, DEFAULTS);
    assert_int_equal(distance(&s), 215);
    ASK(&s.bench, 30 * MS, 0x01, 0x06, 0x00, 0x14, 0xFF, 0xF1, 0x49, 0xBA);
    EXPECT(&s.bench, 0x01, 0x06, 0x00, 0x14, 0xFF, 0xF1, 0x49, 0xBA);
    assert_int_equal(distance(&s), 200);
    cycle_power(&s);
    assert_int_equal(distance(&s), 200);
    ASK(&s.bench, 30 * MS, 0x01, 0x06, 0x00, 0x14, 0xFF, 0xF1, 0x49, 0xBA); /* the same again */
    EXPECT(&s.bench, 0x01, 0x06, 0x00, 0x14, 0xFF, 0xF1, 0x49, 0xBA);
    assert_int_equal(distance(&s), 200);
    ASK(&s.bench, 30 * MS, 0x01, 0x06, 0x00, 0x14, 0x00, 0x0A, 0x49, 0xC9);
    EXPECT(&s.bench, 0x01, 0x06, 0x00, 0x14, 0x00, 0x0A, 0x49, 0xC9);
    assert_int_equal(distance(&s), 225);
}

TEST(offsets_add_up_as_an_option)
{
    stage_t s;
    set(&s, 40000, (fathom_sim_hps167s_config_t){.offset_adds = true});
    ASK(&s.bench, 30 * MS, 0x01, 0x06, 0x00, 0x14, 0xFF, 0xF1, 0x49, 0xBA);
    ASK(&s.bench, 30 * MS, 0x01, 0x06, 0x00, 0x14, 0xFF, 0xF1, 0x49, 0xBA);
    bench_forget(&s.bench);
    assert_int_equal(distance(&s), 40000 - 30);
    cycle_power(&s);
    ASK(&s.bench, 30 * MS, 0x01, 0x06, 0x00, 0x14, 0x00, 0x06, 0x49, 0xCC);
    bench_forget(&s.bench);
    assert_int_equal(distance(&s), 40000 - 24);
    ASK(&s.bench, 30 * MS, 0x01, 0x06, 0x00, 0x14, 0x80, 0x00, 0xA8, 0x0E); /* to the end, and no further */
    ASK(&s.bench, 30 * MS, 0x01, 0x06, 0x00, 0x14, 0x80, 0x00, 0xA8, 0x0E);
    bench_forget(&s.bench);
    assert_int_equal(distance(&s), 40000 - 32768);
    for (int i = 0; i < 3; i++) ASK(&s.bench, 30 * MS, 0x01, 0x06, 0x00, 0x14, 0x7F, 0xFF, 0xA9, 0xBE);
    bench_forget(&s.bench);
    s.fixed.value[0] = 1;
    assert_int_equal(distance(&s), 1 + 32767);
}

TEST(an_offset_moves_distances_and_nothing_else)
{
    stage_t s;
    set(&s, 14, DEFAULTS);
    ASK(&s.bench, 30 * MS, 0x01, 0x06, 0x00, 0x14, 0xFF, 0xF1, 0x49, 0xBA);
    bench_forget(&s.bench);
    assert_int_equal(distance(&s), 0); /* not 65535 */
    s.fixed.value[0] = FATHOM_SIM_NO_TARGET;
    assert_int_equal(distance(&s), 65530);
    for (int32_t mark = 65530; mark <= 65535; mark++) {
        s.fixed.value[0] = mark;
        assert_int_equal(distance(&s), mark);
    }
    s.fixed.value[0] = FATHOM_SIM_FAULT;
    ASK(&s.bench, 30 * MS, 0x01, 0x03, 0x00, 0x08, 0x00, 0x04, 0xC5, 0xCB);
    EXPECT(&s.bench, 0x01, 0x03, 0x08, 0xFF, 0xFF, 0x00, 0x00, 0x00, 0xFF, 0xFF, 0xFF, 0xE4, 0x5C);
    ASK(&s.bench, 30 * MS, 0x01, 0x06, 0x00, 0x14, 0x00, 0x0F, 0x89, 0xCA);
    bench_forget(&s.bench);
    s.fixed.value[0] = 65529;
    assert_int_equal(distance(&s), 65529); /* no distance becomes a mark */
}

TEST(a_filter_is_kept)
{
    stage_t s;
    set(&s, 2083, DEFAULTS);
    assert_int_equal(s.hps.sensor.filter, 0);
    ASK(&s.bench, 30 * MS, 0x01, 0x06, 0x00, 0x16, 0xFF, 0x9C, 0x29, 0x97);
    EXPECT(&s.bench, 0x01, 0x06, 0x00, 0x16, 0xFF, 0x9C, 0x29, 0x97);
    assert_int_equal(s.hps.sensor.filter, -100);
    cycle_power(&s);
    assert_int_equal(s.hps.sensor.filter, -100);
    ASK(&s.bench, 30 * MS, 0x01, 0x06, 0x00, 0x16, 0x7F, 0xFF, 0x08,
        0x7E); /* "recommended within +-100": no more than that */
    EXPECT(&s.bench, 0x01, 0x06, 0x00, 0x16, 0x7F, 0xFF, 0x08, 0x7E);
    assert_int_equal(s.hps.sensor.filter, 32767);
    assert_int_equal(distance(&s), 2083);
}

TEST(settings_are_loaded_from_the_user_or_from_the_factory)
{
    stage_t s;
    set(&s, 215, DEFAULTS);
    ASK(&s.bench, 30 * MS, 0x01, 0x06, 0x00, 0x14, 0xFF, 0xF1, 0x49, 0xBA);
    ASK(&s.bench, 30 * MS, 0x01, 0x06, 0x00, 0x16, 0x00, 0x32, 0xE9, 0xDB);
    bench_forget(&s.bench);
    ASK(&s.bench, 30 * MS, 0x01, 0x06, 0x00, 0x15, 0x00, 0xFF, 0xD8, 0x4E);
    EXPECT(&s.bench, 0x01, 0x06, 0x00, 0x15, 0x00, 0xFF, 0xD8, 0x4E);
    assert_int_equal(s.hps.device.counters.resets, 1);
    assert_int_equal(distance(&s), 215);
    assert_int_equal(s.hps.sensor.filter, 0);
    cycle_power(&s); /* "they will not be lost when the power is turned off" */
    assert_int_equal(distance(&s), 215);
    ASK(&s.bench, 30 * MS, 0x01, 0x06, 0x00, 0x15, 0x00, 0x00, 0x98, 0x0E);
    EXPECT(&s.bench, 0x01, 0x06, 0x00, 0x15, 0x00, 0x00, 0x98, 0x0E);
    assert_int_equal(s.hps.device.counters.resets, 1);
    assert_int_equal(distance(&s), 200);
    assert_int_equal(s.hps.sensor.filter, 50);
    cycle_power(&s);
    assert_int_equal(distance(&s), 200);
    assert_int_equal(configuration(&s)[AUTO_OUTPUT], 0xFF); /* the interface's are another matter */
}

/* ---- #15 ---- */

TEST(reconnect_time_is_acknowledged_as_in_table_38_with_its_high_word_first)
{
    stage_t s;
    set(&s, 2083, DEFAULTS);
    ASK(&s.bench, 30 * MS, 0x01, 0x10, 0x00, 0x20, 0x00, 0x02, 0x04, 0x00, 0x00, 0x01, 0x68, 0xF1,
        0xC9); /* 360 ms */
    EXPECT(&s.bench, 0x01, 0x10, 0x00, 0x20, 0x00, 0x02, 0x40, 0x02);
    assert_memory_equal(configuration(&s) + RECONNECT, ((uint8_t[]){0x00, 0x00, 0x01, 0x68}), 4);
    ASK(&s.bench, 30 * MS, 0x01, 0x10, 0x00, 0x20, 0x00, 0x02, 0x04, 0x00, 0x01, 0x00, 0x02, 0x21,
        0xB6); /* 65538 = 3641 * 18 */
    EXPECT(&s.bench, 0x01, 0x10, 0x00, 0x20, 0x00, 0x02, 0x40, 0x02);
    assert_memory_equal(configuration(&s) + RECONNECT, ((uint8_t[]){0x00, 0x01, 0x00, 0x02}), 4);
    cycle_power(&s);
    assert_memory_equal(configuration(&s) + RECONNECT, ((uint8_t[]){0x00, 0x01, 0x00, 0x02}), 4);
    ASK(&s.bench, 30 * MS, 0x01, 0x10, 0x00, 0x20, 0x00, 0x02, 0x04, 0x00, 0x00, 0x00, 0x00, 0xF1, 0xB7);
    EXPECT(&s.bench, 0x01, 0x10, 0x00, 0x20, 0x00, 0x02, 0x40, 0x02);
    assert_memory_equal(configuration(&s) + RECONNECT, ((uint8_t[]){0, 0, 0, 0}), 4);
}
