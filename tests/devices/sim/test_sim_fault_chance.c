/* SPDX-License-Identifier: MIT */
#include "fault_bench.h"

/* How often faults come, that they come again the same, and what is known of them. */

enum { FRAMES = 20000, FIRST = 1, LAST = FATHOM_SIM_FAULT_END - 1 };

/* Lets `frames` automatic frames of an A16 come, and reckons a number from all bytes, marks and times. */
static uint64_t run_frames(uint32_t frames)
{
    uint64_t number = 0;
    while (bench.fault.frames < frames) {
        forget();
        wait_ms(100);
        for (size_t i = 0; i < bench.heard; i++) {
            number = number * 31 + bench.bytes[i];
            number = number * 31 + bench.flags[i];
            number = number * 31 + (bench.end_us[i] - bench_start_us);
        }
    }
    return number;
}

/* |hits - n p| <= 5 sqrt(n p (1 - p)), squared. With a fixed seed the response is always the same; for an even
 * generator it is wrong once in 1.7 million. */
static bool is_likely(uint32_t hits, uint32_t n, uint32_t chance_ppm)
{
    const int64_t apart = (int64_t)hits * 1000000 - (int64_t)n * chance_ppm; /* in millionths of a hit */
    const int64_t variance =
        (int64_t)n * chance_ppm / 1000 * (1000000 - (int64_t)chance_ppm) / 1000; /* 10^-6 */
    return apart / 1000 * (apart / 1000) <= 25 * variance;
}

/* Once: millions of frames, whose times the other tests look at. */
static void begin_round(unsigned round) { bench_start_us = UINT32_C(0xFFFF0000); }

static const suite_t suite = {.begin_round = begin_round};

TEST(each_kind_comes_as_often_as_it_is_told)
{
    static const uint32_t chances_ppm[] = {1000, 50000, 500000};
    for (uint8_t kind = FIRST; kind <= LAST; kind++) {
        for (size_t i = 0; i < 3; i++) {
            fathom_sim_clock_t clock;
            const setting_t setting = kind == FATHOM_SIM_FAULT_FAULT       ? HPS167S
                                      : kind == FATHOM_SIM_FAULT_EXCEPTION ? A16_MODBUS
                                                                           : A16_AUTO;
            set_faulty(setting, 7);
            fathom_sim_clock_init(&clock, bench_start_us, 0);
            bench.fault.clock = &clock;
            fathom_sim_fault_rule_t *const rule = fathom_sim_fault_add(&bench.fault, kind, chances_ppm[i], 0);
            rule->us = kind == FATHOM_SIM_FAULT_POWER_CYCLE || kind == FATHOM_SIM_FAULT_LATE ? 1 * MS : 0;
            if (!fathom_sim_fault_applies(kind, bench.device)) fail_msg("%s", fathom_sim_fault_name(kind));
            /* what needs a request is asked for, the rest comes by itself */
            const bool is_asked = kind == FATHOM_SIM_FAULT_UNIT || kind == FATHOM_SIM_FAULT_FUNCTION ||
                                  kind == FATHOM_SIM_FAULT_ECHO || setting != A16_AUTO;
            const uint32_t frames = (i == 0 ? FRAMES : FRAMES / 5u) / (is_asked ? 4u : 1u);
            const setting_t asked = setting == HPS167S ? HPS167S : A16_MODBUS;
            if (is_asked && setting == A16_AUTO) {
                set_faulty(A16_MODBUS, 7);
                assert_non_null(fathom_sim_fault_add(&bench.fault, kind, chances_ppm[i], 0));
            }
            if (is_asked)
                while (bench.fault.frames < frames) next(asked);
            else
                (void)run_frames(frames);
            if (!is_likely(bench.fault.counters[kind], bench.fault.frames, chances_ppm[i]))
                fail_msg("%s: %u hits in %u frames at %u ppm", fathom_sim_fault_name(kind),
                         (unsigned)bench.fault.counters[kind], (unsigned)bench.fault.frames,
                         (unsigned)chances_ppm[i]);
            assert_int_equal(bench.fault.frames_hit, bench.fault.counters[kind]);
        }
    }
}

static void add_many(uint32_t chance_ppm)
{
    for (uint8_t kind = FIRST; kind <= LAST; kind++)
        if (kind != FATHOM_SIM_FAULT_CLOCK_JUMP)
            assert_non_null(fathom_sim_fault_add(&bench.fault, kind, chance_ppm, 0));
}

static uint64_t run_many(uint32_t seed, uint32_t *frames_hit)
{
    set_faulty(A16_AUTO, seed);
    add_many(20000);
    const uint64_t number = run_frames(3000);
    *frames_hit = bench.fault.frames_hit;
    return number;
}

TEST(the_same_seed_is_the_same_run_and_another_is_another)
{
    uint32_t hit[3];
    const uint64_t first = run_many(5, &hit[0]);
    assert_true(first == run_many(5, &hit[1]));
    assert_int_equal(hit[0], hit[1]);
    assert_true(hit[0] > 500);
    assert_true(first != run_many(6, &hit[2]));
}

TEST(one_rule_more_does_not_move_the_hits_of_the_others)
{
    uint32_t hits[2] = {0, 0};
    uint64_t frames[2] = {0, 0};
    for (int more = 0; more < 2; more++) {
        set_faulty(A16_AUTO, 9);
        FAULT(FLIP_BIT, 100000, 0);
        if (more == 1) FAULT(TRAILING, 300000, 0);
        for (uint32_t n = 1; n <= 500; n++) {
            next(A16_AUTO);
            if ((bench.fault.last_kinds & BIT(FLIP_BIT)) == 0) continue;
            frames[more] = frames[more] * 31 + n;
            hits[more]++;
        }
    }
    assert_true(hits[0] > 20);
    assert_int_equal(hits[0], hits[1]);
    assert_true(frames[0] == frames[1]);
}

TEST(two_kinds_may_hit_one_frame)
{
    set_faulty(A16_MODBUS, 1);
    FAULT(EXCEPTION, ALWAYS, 2)->code = 2;
    FAULT(DUPLICATE, ALWAYS, 2);
    FAULT(TRAILING, ALWAYS, 3);
    FAULT(DROP, ALWAYS, 3);
    next_is_golden(A16_MODBUS);
    next(A16_MODBUS);
    expect("01 83 02 C0 F1 01 83 02 C0 F1");
    assert_int_equal(bench.fault.last_kinds, BIT(EXCEPTION) | BIT(DUPLICATE));
    next(A16_MODBUS);
    assert_in_range(bench.heard, 7, 10);
    assert_int_equal(bench.fault.last_kinds, BIT(TRAILING) | BIT(DROP));
    assert_int_equal(bench.fault.frames_hit, 2);
    assert_int_equal(fathom_sim_fault_take(&bench.fault),
                     BIT(EXCEPTION) | BIT(DUPLICATE) | BIT(TRAILING) | BIT(DROP));
}

TEST(a_run_of_frames_is_hit_together)
{
    uint32_t longest = 0, length = 0;
    set_faulty(A16_AUTO, 1);
    FAULT(SILENCE, ALWAYS, 3)->run = 4;
    for (uint32_t n = 1; n <= 9; n++) {
        next(A16_AUTO);
        assert_int_equal(bench.heard, n >= 3 && n < 7 ? 0 : 4);
    }
    set_faulty(A16_AUTO, 1);
    FAULT(SILENCE, 10000, 0)->run = 5;
    for (uint32_t n = 1; n <= 2000; n++) {
        next(A16_AUTO);
        if (bench.heard == 0) {
            length++;
        } else {
            if (length != 0) assert_true(length >= 5);
            length = 0;
        }
        if (length > longest) longest = length;
    }
    assert_true(longest >= 5);
}

TEST(all_stops_when_they_are_switched_off_and_goes_on_again)
{
    set_faulty(A16_AUTO, 1);
    add_many(300000);
    (void)run_frames(200);
    assert_true(bench.fault.frames_hit > 150);
    fathom_sim_fault_enable(&bench.fault, false);
    (void)run_frames(230); /* what was under way */
    const uint32_t hit = bench.fault.frames_hit, frames = bench.fault.frames;
    for (uint32_t n = 1; n <= 300; n++) {
        next(A16_AUTO);
        assert_int_equal(bench.heard % 4, 0);
        for (size_t i = 0; i < bench.heard; i++) assert_int_equal(bench.flags[i], 0);
    }
    assert_true(bench.fault.frames >= frames + 299);
    assert_int_equal(bench.fault.frames_hit, hit);
    assert_int_equal(bench.fault.last_kinds, 0);
    fathom_sim_fault_enable(&bench.fault, true);
    (void)run_frames(bench.fault.frames + 50);
    assert_true(bench.fault.frames_hit > hit + 30);
}

TEST(kinds_have_names_and_can_be_found)
{
    for (uint8_t kind = FIRST; kind <= LAST; kind++) {
        assert_non_null(fathom_sim_fault_name(kind));
        assert_true(strlen(fathom_sim_fault_text(kind)) > 5);
        assert_int_equal(fathom_sim_fault_find(fathom_sim_fault_name(kind)), kind);
    }
    assert_int_equal(fathom_sim_fault_find("flip-bit"), FATHOM_SIM_FAULT_FLIP_BIT);
    assert_int_equal(fathom_sim_fault_find("clock-jump"), FATHOM_SIM_FAULT_CLOCK_JUMP);
    assert_int_equal(fathom_sim_fault_find("flip"), 0);
    assert_int_equal(fathom_sim_fault_find(""), 0);
    assert_null(fathom_sim_fault_name(0));
    assert_null(fathom_sim_fault_name(FATHOM_SIM_FAULT_END));
    assert_null(fathom_sim_fault_text(0));
}

static uint32_t all_that_cannot_hit(const fathom_sim_device_t *device)
{
    uint32_t cannot = 0;
    for (uint8_t kind = FIRST; kind <= LAST; kind++)
        if (!fathom_sim_fault_applies(kind, device)) cannot |= FATHOM_SIM_FAULT_BIT(kind);
    return cannot;
}

TEST(what_cannot_hit_a_device_is_known)
{
    for (setting_t setting = 0; setting <= A05_MODBUS; setting++) { /* who sends can be asked, too */
        set_faulty(setting, 0);
        assert_int_equal(all_that_cannot_hit(bench.device),
                         setting == HPS167S ? BIT(INTERFERENCE) : BIT(FAULT));
        assert_false(fathom_sim_fault_applies(0, bench.device));
        assert_false(fathom_sim_fault_applies(FATHOM_SIM_FAULT_END, bench.device));
    }
    set_a16(FATHOM_SIM_A16_UART, 0, (a16_config_t){0}); /* sends for ever and hears nothing */
    assert_int_equal(all_that_cannot_hit(bench.device),
                     BIT(FAULT) | BIT(UNIT) | BIT(FUNCTION) | BIT(EXCEPTION) | BIT(ECHO));
}

TEST(there_is_an_end_to_the_rules)
{
    set_faulty(A16_AUTO, 0);
    assert_null(fathom_sim_fault_add(&bench.fault, 0, ALWAYS, 0));
    assert_null(fathom_sim_fault_add(&bench.fault, FATHOM_SIM_FAULT_END, ALWAYS, 0));
    for (int i = 0; i < FATHOM_SIM_FAULT_RULES; i++) assert_non_null(FAULT(NOISE, ALWAYS, 0));
    assert_null(FAULT(NOISE, ALWAYS, 0));
    wait_ms(350); /* six pauses fit a frame: the rest of the rules finds no room */
    assert_true(bench.heard > 0);
}
