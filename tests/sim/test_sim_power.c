/* SPDX-License-Identifier: MIT */
/* A power cycle at any moment: what it interrupts, and that a line works on. What is kept stands with each
 * sensor's tests. */
#include "bench.h"
#include "sim/a05.h"
#include "sim/a16.h"
#include "sim/fault.h"
#include "sim/hps167s.h"
#include "sim/scene.h"

enum { MS = 1000 };

typedef struct {
    bench_t bench;
    fathom_sim_fixed_t fixed;
    fathom_sim_a16_t a16;
    fathom_sim_a05_t a05;
} stage_t;

/* An A16 at 1 that needs `start_us`, an A05 at 5, on one pair. */
static void set(stage_t *stage, uint32_t start_us)
{
    bench_init(&stage->bench, &bench_9600);
    stage->fixed.value[0] = 751;
    fathom_sim_a16_init(&stage->a16, &(fathom_sim_a16_config_t){.mode = FATHOM_SIM_A16_MODBUS,
                                                                .start_us = start_us,
                                                                .scene = fathom_sim_fixed(&stage->fixed)});
    fathom_sim_a05_init(&stage->a05, &(fathom_sim_a05_config_t){.mode = FATHOM_SIM_A05_MODBUS, .unit = 5});
    bench_attach(&stage->bench, &stage->a16.device);
    bench_attach(&stage->bench, &stage->a05.device);
}

static void cycle(stage_t *s, uint32_t off_us)
{
    fathom_sim_power_cycle(&s->bench.line, &s->a16.device, off_us, s->bench.now_us);
}

#define REALTIME 0x01, 0x03, 0x01, 0x01, 0x00, 0x01, 0xD4, 0x36 /* A16 6(4) example 2 */
#define ANSWER   0x01, 0x03, 0x02, 0x02, 0xEF, 0xF8, 0xA8
#define OTHER    0x05, 0x03, 0x02, 0x00, 0x00, 0x01, 0x84, 0x36
#define OTHERS   0x05, 0x03, 0x02, 0x00, 0x05, 0x89, 0x87

static void expect_both_work(stage_t *s)
{
    bench_forget(&s->bench);
    ASK(&s->bench, 200 * MS, OTHER);
    EXPECT(&s->bench, OTHERS);
    ASK(&s->bench, 200 * MS, REALTIME);
    EXPECT(&s->bench, ANSWER);
    assert_int_equal(s->a16.device.carriers, 0);
    assert_int_equal(s->a05.device.carriers, 0);
}

static const suite_t suite = {BENCH_ROUNDS};

TEST(without_power_it_hears_and_says_nothing)
{
    stage_t s;
    set(&s, 0);
    cycle(&s, 1000 * MS);
    for (int i = 0; i < 4; i++) ASK(&s.bench, 200 * MS, REALTIME); /* 833 ms */
    EXPECT_SILENCE(&s.bench);
    assert_int_equal(s.a16.device.counters.unheard, 32);
    assert_int_equal(s.a16.device.counters.requests, 0);
    bench_wait(&s.bench, 168 * MS);
    expect_both_work(&s);
}

TEST(it_starts_anew_when_power_is_back)
{
    stage_t s;
    set(&s, 900 * MS);
    bench_wait(&s.bench, 1000 * MS);
    cycle(&s, 100 * MS);
    bench_wait(&s.bench, 985 * MS);
    ASK(&s.bench, 5 * MS, REALTIME); /* ends at 993 ms, it is up at 1000 */
    bench_wait(&s.bench, 200 * MS);
    EXPECT_SILENCE(&s.bench);
    expect_both_work(&s);
}

TEST(power_that_is_back_at_once_still_ends_what_it_was_doing)
{
    stage_t s;
    set(&s, 0);
    ASK(&s.bench, 50 * MS, REALTIME); /* 105..120 ms */
    cycle(&s, 0);
    bench_wait(&s.bench, 200 * MS);
    EXPECT_SILENCE(&s.bench);
    assert_int_equal(s.a16.device.counters.requests, 1);
    assert_int_equal(s.a16.device.counters.answered, 0);
    expect_both_work(&s);
}

TEST(it_is_cut_off_at_any_moment_of_an_answer)
{
    stage_t s;
    for (uint32_t into_us = 0; into_us < 7300; into_us += 130) { /* seven characters */
        set(&s, 0);
        bench_say(&s.bench, (const uint8_t[]){REALTIME}, 8);
        while (!s.a16.device.sender.on_wire) bench_wait(&s.bench, 10);
        bench_wait(&s.bench, into_us);
        const size_t heard = s.bench.heard;
        cycle(&s, 20 * MS);
        bench_wait(&s.bench, 300 * MS);
        assert_int_equal(s.bench.heard, heard); /* nothing of the byte that it was saying */
        assert_memory_equal(s.bench.bytes, ((uint8_t[]){ANSWER}), heard);
        assert_in_range(heard, into_us / 1042, (into_us + 10) / 1041);
        expect_both_work(&s);
    }
}

TEST(it_hears_nothing_of_a_request_that_it_woke_up_in)
{
    stage_t s;
    for (uint32_t into_us = 1050; into_us < 8300; into_us += 130) { /* the second character to the eighth */
        set(&s, 0);
        bench_say(&s.bench, (const uint8_t[]){REALTIME}, 8);
        bench_wait(&s.bench, into_us);
        cycle(&s, into_us % 3 * 100);
        bench_wait(&s.bench, 300 * MS);
        EXPECT_SILENCE(&s.bench);
        assert_int_equal(s.a05.device.counters.others, 1); /* who had power heard it */
        expect_both_work(&s);
    }
}

TEST(a_wire_each_way_is_cut_off_as_well)
{
    fathom_sim_a16_t a16;
    bench_t bench;
    bench_init(&bench, &bench_9600);
    bench.line.full_duplex = true;
    fathom_sim_a16_init(&a16, &(fathom_sim_a16_config_t){.mode = FATHOM_SIM_A16_AUTO});
    bench_attach(&bench, &a16.device);
    bench_wait(&bench, 102 * MS); /* within its second byte */
    EXPECT(&bench, 0xFF);
    fathom_sim_power_cycle(&bench.line, &a16.device, 50 * MS, bench.now_us);
    bench_wait(&bench, 145 * MS); /* 97 ms with power */
    EXPECT_SILENCE(&bench);
    bench_wait(&bench, 10 * MS);
    EXPECT(&bench, 0xFF, 0xFF, 0xFD, 0xFB);
    assert_int_equal(a16.device.carriers, 0);
}

TEST(a_neighbour_with_wires_of_its_own_never_heard_it)
{
    fathom_sim_a16_t a16, other;
    bench_t bench;
    bench_init(&bench, &bench_9600);
    bench.line.full_duplex = true;
    fathom_sim_a16_init(&a16, &(fathom_sim_a16_config_t){.mode = FATHOM_SIM_A16_AUTO});
    fathom_sim_a16_init(&other, &(fathom_sim_a16_config_t){.mode = FATHOM_SIM_A16_MODBUS, .unit = 5});
    bench_attach(&bench, &a16.device);
    bench_attach(&bench, &other.device);
    bench_wait(&bench, 102 * MS);
    fathom_sim_power_cycle(&bench.line, &a16.device, 1000 * MS, bench.now_us);
    bench_forget(&bench);
    ASK(&bench, 200 * MS, OTHER);
    EXPECT(&bench, OTHERS);
}

TEST(half_an_hour_is_the_longest)
{
    stage_t s;
    set(&s, 0);
    cycle(&s, UINT32_C(1800000000));
    bench_wait(&s.bench, UINT32_C(1799900000));
    ASK(&s.bench, 50 * MS, REALTIME);
    EXPECT_SILENCE(&s.bench);
    bench_wait(&s.bench, 100 * MS);
    expect_both_work(&s);
}

TEST(an_accident_in_an_acknowledgement_keeps_what_was_set)
{
    const fathom_line_settings_t fast = {115200, FATHOM_PARITY_EVEN, 1};
    fathom_sim_fault_t fault;
    fathom_sim_hps167s_t hps;
    bench_t bench;
    bench_init(&bench, &bench_19200);
    fathom_sim_hps167s_init(&hps, &(fathom_sim_hps167s_config_t){0});
    fathom_sim_fault_init(&fault, 1);
    assert_non_null(
        fathom_sim_fault_add(&fault, FATHOM_SIM_FAULT_POWER_CYCLE, FATHOM_SIM_FAULT_ALWAYS_PPM, 1));
    fathom_sim_fault_attach(&fault, &bench.line, &hps.device);
    bench_attach(&bench, &hps.device);
    ASK(&bench, 2100 * MS, 0x01, 0x06, 0x00, 0x11, 0x00, 0x03, 0x99, 0xCE); /* it is off for 2 s */
    assert_true(bench.heard < 8);
    assert_int_equal(fault.counters[FATHOM_SIM_FAULT_POWER_CYCLE], 1);
    bench_forget(&bench);
    fathom_sim_set_line(&bench.line, &fast, bench.now_us);
    ASK(&bench, 50 * MS, 0x01, 0x03, 0x00, 0x02, 0x00, 0x04, 0xE5, 0xC9);
    EXPECT(&bench, 0x01, 0x03, 0x08, 0xFF, 0xFF, 0x00, 0x00, 0x00, 0x00, 0xB4, 0x03, 0xE2, 0xDD);
}

/* ---- how often the line is looked at ---- */

static void in_steps(bench_t *bench, uint32_t us, uint32_t step_us)
{
    for (; us > step_us; us -= step_us) bench_wait(bench, step_us);
    bench_wait(bench, us);
}

/* Asked, set, cut off in its third unasked frame, asked again. */
static void play(bench_t *bench, uint32_t step_us)
{
    fathom_sim_hps167s_t hps;
    bench_init(bench, &bench_19200);
    fathom_sim_hps167s_init(&hps, &(fathom_sim_hps167s_config_t){.unasked_us = 50 * MS});
    bench_attach(bench, &hps.device);
    SAY(bench, 0x01, 0x03, 0x00, 0x02, 0x00, 0x04, 0xE5, 0xC9);
    in_steps(bench, 60 * MS, step_us);
    SAY(bench, 0x01, 0x06, 0x00, 0x10, 0x00, 0x05, 0x48, 0x0C);
    in_steps(bench, 93100, step_us);
    fathom_sim_power_cycle(&bench->line, &hps.device, 30 * MS, bench->now_us);
    in_steps(bench, 40 * MS, step_us);
    SAY(bench, 0x05, 0x03, 0x00, 0x08, 0x00, 0x04, 0xC4, 0x4F);
    in_steps(bench, 100 * MS, step_us);
    assert_int_equal(hps.device.counters.answered, 3);
    assert_int_equal(hps.device.counters.automatic, 5);
}

TEST(how_often_it_is_looked_at_changes_nothing)
{
    static bench_t once, often;
    static const uint32_t steps_us[] = {1, 7, 333, 20 * MS};
    play(&once, 200 * MS);
    for (size_t i = 0; i < sizeof steps_us / sizeof steps_us[0]; i++) {
        play(&often, steps_us[i]);
        assert_int_equal(often.heard, once.heard);
        assert_memory_equal(often.bytes, once.bytes, once.heard);
        assert_memory_equal(often.end_us, once.end_us, once.heard * sizeof once.end_us[0]);
    }
}
