/* SPDX-License-Identifier: MIT */
/* Several sensors at one address of one pair: all answer, and what they say together nobody understands. */
#include <string.h>

#include "bench.h"
#include "fathom/crc16.h"
#include "sim/a05.h"
#include "sim/a16.h"
#include "sim/hps167s.h"
#include "sim/scene.h"

enum { MS = 1000 };

typedef struct {
    bench_t bench;
    fathom_sim_fixed_t fixed[2];
    fathom_sim_hps167s_t hps[2];
} stage_t;

static void set(stage_t *stage, uint32_t seed)
{
    bench_init(&stage->bench, &bench_19200);
    for (uint32_t i = 0; i < 2; i++) {
        stage->fixed[i].value[0] = i == 0 ? 2083 : 1500;
        fathom_sim_hps167s_init(
            &stage->hps[i],
            &(fathom_sim_hps167s_config_t){.seed = seed + i, .scene = fathom_sim_fixed(&stage->fixed[i])});
        bench_attach(&stage->bench, &stage->hps[i].device);
    }
}

#define MEASURE 0x01, 0x03, 0x00, 0x08, 0x00, 0x04, 0xC5, 0xCB
#define FIRST   0x01, 0x03, 0x08, 0x08, 0x23, 0xDC, 0xB2, 0x07, 0x01, 0x00, 0x00, 0xFD, 0x41
#define SECOND  0x01, 0x03, 0x08, 0x05, 0xDC, 0xDC, 0xB2, 0x07, 0x01, 0x00, 0x00, 0x33, 0xD7

/* No run of bytes among those that were heard is an answer. */
static bool understood(const bench_t *bench, const uint8_t *answer, size_t length)
{
    for (size_t at = 0; at + length <= bench->heard; at++)
        if (memcmp(bench->bytes + at, answer, length) == 0) return true;
    return false;
}

static const suite_t suite = {BENCH_ROUNDS};

TEST(two_that_answer_within_each_others_answer_are_not_understood)
{
    stage_t s;
    for (uint32_t seed = 0; seed < 50; seed++) { /* 0 to 0.3 ms apart, of 7.4 */
        set(&s, seed);
        ASK(&s.bench, 50 * MS, MEASURE);
        assert_int_equal(s.hps[0].device.counters.answered, 1);
        assert_int_equal(s.hps[1].device.counters.answered, 1);
        assert_int_equal(s.bench.heard, 26);
        assert_true(s.bench.line.counters.collisions >= 13);
        assert_false(understood(&s.bench, (const uint8_t[]){FIRST}, 13));
        assert_false(understood(&s.bench, (const uint8_t[]){SECOND}, 13));
        for (uint8_t from = 0; from < 26; from++)
            for (uint8_t length = 5; from + length <= 26; length++)
                if (length == 5 || length == 8 || length == 13)
                    assert_int_not_equal(fathom_crc16(s.bench.bytes + from, length), 0);
    }
}

TEST(one_that_loses_power_leaves_the_other_understood)
{
    stage_t s;
    set(&s, 3);
    fathom_sim_power_cycle(&s.bench.line, &s.hps[1].device, 1000 * MS, s.bench.now_us);
    ASK(&s.bench, 50 * MS, MEASURE);
    EXPECT(&s.bench, FIRST);
    fathom_sim_detach(&s.bench.line, &s.hps[0].device, s.bench.now_us);
    bench_wait(&s.bench, 1000 * MS);
    ASK(&s.bench, 50 * MS, MEASURE);
    EXPECT(&s.bench, SECOND);
}

TEST(a_new_address_for_one_is_one_for_both)
{
    stage_t s;
    set(&s, 3);
    ASK(&s.bench, 50 * MS, 0x01, 0x06, 0x00, 0x10, 0x00, 0x05, 0x48, 0x0C);
    assert_false(understood(&s.bench, (const uint8_t[]){0x01, 0x06, 0x00, 0x10, 0x00, 0x05, 0x48, 0x0C}, 8));
    assert_int_equal(s.bench.heard, 16);
    assert_int_equal(s.hps[0].device.unit, 5);
    assert_int_equal(s.hps[1].device.unit, 5);
}

TEST(one_at_another_rate_is_no_twin)
{
    stage_t s;
    set(&s, 3);
    s.hps[1].device.settings.baud = 115200;
    ASK(&s.bench, 50 * MS, MEASURE);
    EXPECT(&s.bench, FIRST);
    assert_int_equal(s.hps[1].device.counters.requests, 0);
    assert_true(s.hps[1].device.counters.wrong_settings != 0);
}

TEST(two_models_collide_as_well)
{
    fathom_sim_a16_t a16;
    fathom_sim_a05_t a05;
    bench_t bench;
    bench_init(&bench, &bench_9600);
    fathom_sim_a16_init(&a16, &(fathom_sim_a16_config_t){.mode = FATHOM_SIM_A16_MODBUS, .seed = 1});
    fathom_sim_a05_init(&a05, &(fathom_sim_a05_config_t){.mode = FATHOM_SIM_A05_MODBUS, .seed = 2});
    bench_attach(&bench, &a16.device);
    bench_attach(&bench, &a05.device);
    ASK(&bench, 50 * MS, 0x01, 0x03, 0x02, 0x00, 0x00, 0x01, 0x85, 0xB2);
    assert_int_equal(bench.heard, 14);
    assert_true(bench.line.counters.collisions != 0);
    assert_false(understood(&bench, (const uint8_t[]){0x01, 0x03, 0x02, 0x00, 0x01, 0x79, 0x84}, 7));
    bench_forget(&bench);
    ASK(&bench, 200 * MS, 0x01, 0x03, 0x01, 0x06, 0x00, 0x01, 0x65,
        0xF7); /* a register that only one of them has */
    EXPECT(&bench, 0x01, 0x03, 0x02, 0xFF, 0xFD, 0x38, 0x35);
}

TEST(the_address_command_of_55_aa_makes_two_of_one_address_that_garble_each_other)
{
    fathom_sim_a05_t a05[2];
    bench_t bench;
    bench_init(&bench, &bench_9600);
    for (uint8_t i = 0; i < 2; i++) {
        fathom_sim_a05_init(&a05[i], &(fathom_sim_a05_config_t){
                                         .mode = FATHOM_SIM_A05_DYP, .unit = (uint8_t)(i + 1), .seed = i});
        bench_attach(&bench, &a05[i].device);
    }
    ASK(&bench, 50 * MS, 0x55, 0xAA, 0x05, 0x03, 0x07); /* A05 2(3)5 */
    assert_int_equal(bench.heard, 10);
    assert_false(understood(&bench, (const uint8_t[]){0x55, 0xAA, 0x05, 0x03, 0x07}, 5));
    assert_int_equal(a05[0].device.unit, 5);
    assert_int_equal(a05[1].device.unit, 5);
}
