/* SPDX-License-Identifier: MIT */
#include "auto_rig.h"
#include "fathom/sensor/a05_relay.h"
#include "fathom/sensor/a05_relay_rule.h"

enum { HALF_S = 500000, NONE = 0 };

static fathom_a05_relay_rule_config_t config;
static fathom_a05_relay_rule_t rule;
static uint32_t now_us;
static uint16_t sequence;

static void start(void)
{
    memset(&rule, 0x5A, sizeof rule);
    assert_int_equal(fathom_a05_relay_rule_init(&rule, &config), FATHOM_OK);
    assert_int_equal(rule.debounce.level, 0);
}

static int set_up(void **state)
{
    memset(&config, 0, sizeof config);
    now_us = UINT32_MAX - 3 * HALF_S; /* the clock and the numbers wrap in every longer test */
    sequence = UINT16_MAX - 2;
    start();
    return 0;
}

static const suite_t suite = {.set_up = set_up};

/* ---- measurements ---- */

static bool give(uint8_t probe, uint8_t kind, uint16_t mm)
{
    const fathom_sample_t sample = {
        .time_us = now_us, .sequence = sequence, .kind = kind, .probe = probe, .distance_mm = mm};
    return fathom_a05_relay_rule_add_sample(&rule, &sample);
}

/* The next measurement, 500 ms after the last; a distance of NONE is no target. True: the level has changed. */
static bool measure(uint16_t one, uint16_t two, uint16_t three, uint16_t four)
{
    const uint16_t mm[] = {one, two, three, four};
    bool changed = false;
    now_us += HALF_S;
    sequence++;
    for (uint8_t i = 0; i != 4; i++)
        changed |= give((uint8_t)(i + 1), mm[i] == NONE ? FATHOM_NO_TARGET : FATHOM_TARGET, mm[i]);
    return changed;
}

/* All probes at this distance, which changes the level or not. */
static void all(uint16_t mm, bool changes) { assert_int_equal(measure(mm, mm, mm, mm), changes); }

static void is(uint8_t level) { assert_int_equal(rule.debounce.level, level); }

static void changes_to(uint8_t level, uint16_t one, uint16_t two, uint16_t three, uint16_t four)
{
    assert_true(measure(one, two, three, four));
    is(level);
}

/* A new measurement, of which only some probes speak yet. */
static void begin_after(uint32_t us)
{
    now_us += us;
    sequence++;
}

TEST(any_probe_nearer_than_the_threshold_closes)
{
    for (uint8_t near = 0; near != 4; near++) {
        set_up(state);
        changes_to(FATHOM_FAR, 1001, NONE, 4500, 1001);
        measure(1001, 1001, 1001, 1001);
        changes_to(FATHOM_NEAR, near == 0 ? 999 : 1001, near == 1 ? 999 : NONE, near == 2 ? 999 : 4500,
                   near == 3 ? 999 : 1001);
    }
}

/* ---- Decision: each state lasts at least 1 s ---- */

TEST(each_state_lasts_at_least_1_s)
{
    all(999, true);
    all(1001, false); /* 0.5 s */
    all(1001, true);
    all(999, false);
    now_us -= 1; /* 999999 us */
    all(999, false);
    now_us -= HALF_S - 1;
    all(999, true);
}

/* ---- Decision: what is not fitted never closes it ---- */

TEST(every_mask_of_probes_heeds_its_own_and_no_other)
{
    for (uint8_t probes = 1; probes != 16; probes++) {
        for (uint8_t near = 0; near != 16; near++) {
            config.probes = probes;
            start();
            changes_to((near & probes) != 0 ? FATHOM_NEAR : FATHOM_FAR, (near & 1) != 0 ? 999 : 1001,
                       (near & 2) != 0 ? 999 : 1001, (near & 4) != 0 ? 999 : 1001,
                       (near & 8) != 0 ? 999 : 1001);
        }
    }
}

/* ---- First contact 3 and 4 ---- */

/* 1000 2000 7000 3000: the third is refused and gives no sample. */
TEST(a_probe_that_is_near_closes_though_another_is_refused_unknown_or_a_fault)
{
    static const uint8_t kinds[] = {0, FATHOM_UNKNOWN, FATHOM_FAULT};
    for (unsigned i = 0; i != 3; i++) {
        for (uint8_t near = 1; near <= 4; near += 3) { /* before and behind the odd one */
            start();
            begin_after(HALF_S);
            for (uint8_t probe = 1; probe <= 4; probe++) {
                if (probe != 3)
                    assert_int_equal(give(probe, FATHOM_TARGET, probe == near ? 999 : 2000), probe == near);
                if (probe == 3 && kinds[i] != 0) assert_false(give(3, kinds[i], 0));
            }
            is(FATHOM_NEAR);
        }
    }
}

TEST(a_probe_that_is_too_near_to_measure_closes)
{
    begin_after(HALF_S);
    assert_true(give(2, FATHOM_NEAR, 0));
    is(FATHOM_NEAR);
}

TEST(an_unknown_probe_neither_opens_it_nor_holds_it_for_ever)
{
    for (unsigned i = 0; i != 2; i++) {
        config.unknown_us = i == 0 ? 0 : 2 * HALF_S;
        start();
        all(999, true);
        for (unsigned n = 1; n <= 20; n++) {
            begin_after(HALF_S);
            for (uint8_t probe = 1; probe <= 4; probe++)
                assert_int_equal(give(probe, probe != 2 ? FATHOM_NO_TARGET : FATHOM_UNKNOWN, 0),
                                 probe == 2 && n == (i == 0 ? 11 : 3));
            is(n < (i == 0 ? 11 : 3) ? FATHOM_NEAR : FATHOM_UNKNOWN);
        }
        all(2000, true);
        is(FATHOM_FAR);
    }
}

/* ---- options ---- */

TEST(the_threshold_goes_from_250_to_4500_mm)
{
    static const uint16_t allowed_mm[] = {250, 1000, 4500};
    static const uint16_t refused_mm[] = {1, 249, 4501, UINT16_MAX};
    for (int i = 0; i != 3; i++) {
        const uint16_t mm = config.threshold_mm = allowed_mm[i];
        start();
        assert_true(measure(NONE, mm, NONE, (uint16_t)(mm - 1)));
        measure(NONE, mm, NONE, mm);
        assert_false(measure(NONE, mm, NONE, mm));
        is(FATHOM_NEAR);
        assert_true(measure(NONE, NONE, NONE, (uint16_t)(mm + 1)));
    }
    for (int i = 0; i != 4; i++) {
        config.threshold_mm = refused_mm[i];
        assert_int_equal(fathom_a05_relay_rule_init(&rule, &config), FATHOM_ERR_ARGUMENT);
    }
}

TEST(equality_holds_the_state_unless_it_is_told_otherwise)
{
    assert_false(measure(1000, 1001, 1001, 1001));
    assert_true(measure(1000, 1001, 1001, 999));
    measure(1001, 1001, 1001, 1000);
    for (int i = 0; i != 9; i++) assert_false(measure(1000, 1001, 1001, 1001));
    all(1001, true);
    config.equal = FATHOM_EQUAL_IS_NEAR;
    start();
    changes_to(FATHOM_NEAR, 1001, 1001, 1000, 1001);
    config.equal = FATHOM_EQUAL_IS_FAR;
    start();
    changes_to(FATHOM_FAR, 1001, 1001, 1000, 1001);
}

TEST(a_config_without_sense_is_refused)
{
    config.probes = 0x10;
    assert_int_equal(fathom_a05_relay_rule_init(&rule, &config), FATHOM_ERR_ARGUMENT);
    config.probes = 0x0F;
    assert_int_equal(fathom_a05_relay_rule_init(&rule, &config), FATHOM_OK);
    config.equal = FATHOM_EQUAL_IS_FAR + 1;
    assert_int_equal(fathom_a05_relay_rule_init(&rule, &config), FATHOM_ERR_ARGUMENT);
}

/* ---- what the levels of the relay mean; test_driver_contract.c has the rest ---- */

enum { CLOSED = FATHOM_A05_RELAY_NORMALLY_CLOSED, HIGH_CONDUCTS = FATHOM_A05_RELAY_CONDUCTS_HIGH };

static void read_as(uint8_t wiring, uint8_t conducts, uint8_t low, uint8_t high)
{
    static fathom_a05_relay_t relay;
    const fathom_a05_relay_config_t relay_config = {.wiring = wiring, .level = conducts};
    for (unsigned level = 0; level != 2; level++) {
        rig_start(RIG_START_US);
        rig.level = level != 0;
        memset(&relay, 0x5A, sizeof relay);
        assert_int_equal(fathom_a05_relay_init(&relay, &rig.pin, &rig.fake.clock, &relay_config), FATHOM_OK);
        rig.sensor = fathom_a05_relay_sensor(&relay);
        rig_run(20 * MS, 1000);
        rig_expect(1, level != 0 ? high : low);
        assert_int_equal(rig.sample.raw, level);
    }
}

TEST(a_normally_closed_contact_that_conducts_is_far)
{
    read_as(CLOSED, 0, FATHOM_FAR, FATHOM_NEAR);
    read_as(CLOSED, HIGH_CONDUCTS, FATHOM_NEAR, FATHOM_FAR);
}

/* ---- everything, against a slow reference ---- */

/* What a probe can say: nearer, farther, equal, nothing at all. Two bits a probe. */
enum { NEARER, FARTHER, EQUAL, MISSING, MEASUREMENTS = 256 };

/* The level after a measurement of all probes. */
static uint8_t refer(uint8_t before, uint8_t probes, unsigned kinds)
{
    unsigned count[4] = {0, 0, 0, 0};
    for (unsigned i = 0; i != 4; i++) count[kinds >> 2 * i & 3] += probes >> i & 1;
    if (count[NEARER] != 0) return FATHOM_NEAR;
    if (count[MISSING] != 0 || count[EQUAL] != 0) return before;
    return FATHOM_FAR;
}

static void measure_all(unsigned kinds)
{
    static const uint16_t mm[] = {999, 1001, 1000};
    begin_after(HALF_S);
    for (unsigned i = 0; i != 4; i++)
        if ((kinds >> 2 * i & 3) != MISSING) give((uint8_t)(i + 1), FATHOM_TARGET, mm[kinds >> 2 * i & 3]);
}

TEST(every_two_measurements_with_every_mask_are_right)
{
    config.hold_us = 1;
    for (uint8_t probes = 1; probes != 16; probes++) {
        config.probes = probes;
        for (unsigned one = 0; one != MEASUREMENTS; one++) {
            for (unsigned two = 0; two != MEASUREMENTS; two++) {
                fathom_a05_relay_rule_init(&rule, &config);
                measure_all(one);
                const uint8_t level = refer(0, probes, one);
                if (rule.debounce.level != level) fail();
                measure_all(two);
                if (rule.debounce.level != refer(level, probes, two)) fail();
            }
        }
    }
}
