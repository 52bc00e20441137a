/* SPDX-License-Identifier: MIT */
#include <stdio.h>

#include "suite.h"

#include "plan.h"
#include "theory.h"

/* The short form: 5 * 10^4 transactions and some more, the same each time; with FATHOM_LONG in the environment twice as
 * many. program/soak.c is the long one. */
enum { SINGLES = 5000, PAIRS = 4000, MIXTURES = 1000, SEED = 1 };
static uint32_t so_many(uint32_t transactions) { return suite_is_long ? transactions : transactions / 2; }

static struct {
    uint32_t rows, broken;
} seen;

EACH_BEGINS(memset(&seen, 0, sizeof seen))

static const suite_t suite = {.set_up = begins};

static void report(void *ctx, uint8_t setting, const char *name, const cell_result_t *result)
{
    const char *const broken = cell_broken_rule(result);
    seen.rows++;
    if (broken == NULL) return;
    seen.broken++;
    print_error("%s %s: %s (%lu wrong, %lu old, %.2f expected, %lu stuck, %lu unaccounted, %lu unexplained, "
                "recovered within %lu of %lu us)\n",
                soak_facts[setting].name, name, broken, (unsigned long)result->totals.wrong_responses,
                (unsigned long)result->totals.old, result->expected, (unsigned long)result->totals.stuck,
                (unsigned long)result->totals.unaccounted, (unsigned long)result->totals.unexplained,
                (unsigned long)result->recovered_us, (unsigned long)result->bound_us);
}

static const plan_t plan = {report, NULL, SEED};

static void each_fault_alone(void **state)
{
    const uint8_t *const setting = *state;
    uint8_t kinds[CELL_KINDS];
    plan_singles(&plan, *setting, so_many(SINGLES));
    /* none, each kind, and where it is asked responses that are too late */
    assert_int_equal(seen.rows, 1u + plan_kinds(*setting, kinds) + (soak_is_asked(*setting) ? 1u : 0u));
    assert_int_equal(seen.broken, 0);
}

static void every_pair_of_faults(void **state)
{
    const uint8_t *const setting = *state;
    uint8_t kinds[CELL_KINDS];
    plan_pairs(&plan, *setting, so_many(PAIRS));
    assert_int_equal(seen.rows, plan_kinds(*setting, kinds) - 1u);
    assert_int_equal(seen.broken, 0);
}

static void all_faults_at_once(void **state)
{
    const uint8_t *const setting = *state;
    plan_mixtures(&plan, *setting, so_many(MIXTURES));
    assert_int_equal(seen.rows, 2);
    assert_int_equal(seen.broken, 0);
}

TEST(three_causes_cannot_be_told_apart)
{
    assert_int_equal(THEORY_ALIKE, 3);
    for (uint8_t i = 0; i < THEORY_ALIKE; i++) assert_non_null(theory_alike[i].why);
}

/* Poisson with mean 1: more than 9 come with probability 1.1e-7, more than 8 with 1.1e-6. With mean 0.001 two come
 * with 5e-7, one with 1e-3. */
TEST(the_bound_on_chance_is_that_of_one_in_a_million)
{
    assert_int_equal(theory_most(0), 0);
    assert_int_equal(theory_most(1), 9);
    assert_int_equal(theory_most(0.001), 1);
}

/* Bits of a checksum: 16, 8. */
TEST(one_byte_that_stays_one_byte_is_never_let_pass)
{
    for (uint8_t setting = 0; setting < SOAK_SETTINGS; setting++) {
        if (soak_facts[setting].proof == SOAK_NO_GAP) continue;
        assert_int_equal(theory_pass(setting, FATHOM_SIM_FAULT_FLIP_BIT), 0);
        assert_int_equal(theory_pass(setting, FATHOM_SIM_FAULT_FLIP_BYTE), 0);
        assert_int_equal(theory_pass(setting, FATHOM_SIM_FAULT_PARITY), 0);
        assert_int_equal(theory_pass(setting, FATHOM_SIM_FAULT_FRAMING), 0);
    }
    assert_int_equal(theory_pass(SOAK_HPS167S, FATHOM_SIM_FAULT_INSERT), 65536 >> 16);
    assert_int_equal(theory_pass(SOAK_A05_DYP, FATHOM_SIM_FAULT_INSERT), 65536 >> 8);
    /* a sum and the FF behind it */
    assert_int_equal(theory_pass(SOAK_A16_AUTO, FATHOM_SIM_FAULT_INSERT), 65536 >> 16);
    assert_int_equal(theory_pass(SOAK_A05_AUTO, FATHOM_SIM_FAULT_INSERT), 65536 >> 16);
}

#define SENSOR(number, sensor)                                                                               \
    static const uint8_t sensor##_setting = number;                                                          \
    TEST_ROW(soak_##sensor##_each_fault_alone, each_fault_alone, &sensor##_setting)                          \
    TEST_ROW(soak_##sensor##_every_pair_of_faults, every_pair_of_faults, &sensor##_setting)                  \
    TEST_ROW(soak_##sensor##_all_faults_at_once, all_faults_at_once, &sensor##_setting)

SENSOR(SOAK_A16_AUTO, a16_auto)
SENSOR(SOAK_A16_TIGHT, a16_tight)
SENSOR(SOAK_A05_AUTO, a05_auto)
SENSOR(SOAK_A05_TIGHT, a05_tight)
SENSOR(SOAK_A16_PROCESSED, a16_processed)
SENSOR(SOAK_A16_REAL_TIME, a16_real_time)
SENSOR(SOAK_A05_MODBUS, a05_modbus)
SENSOR(SOAK_A05_DYP, a05_dyp)
SENSOR(SOAK_A05_DYP_ONE, a05_dyp_one)
SENSOR(SOAK_HPS167S, hps167s)
