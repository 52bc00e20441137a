/* SPDX-License-Identifier: MIT */
#include "suite.h"

#include "eight.h"

enum { SEED = 1, SOUND = 0, NEVER_LESS_OFTEN = 1 };

/* In that time each unit has had its turn many times. With FATHOM_LONG in the environment it is a minute for all. */
static uint32_t seconds(uint8_t mix)
{
    return suite_is_long || mix == EIGHT_A05 || mix == EIGHT_MIXED ? 60 : 20;
}

/* With all eight well, which more than one test compares with. */
static const eight_result_t *all_well(uint8_t mix)
{
    static eight_result_t results[EIGHT_MIXES];
    static bool is_known[EIGHT_MIXES];
    if (!is_known[mix]) eight_run(mix, EIGHT_ALIVE, SOUND, seconds(mix), SEED, &results[mix]);
    is_known[mix] = true;
    return &results[mix];
}

static void expect_sound(const eight_result_t *result, const char *name)
{
    const char *const broken = eight_broken_rule(result);
    if (broken != NULL) print_error("%s: %s\n", name, broken);
    assert_null(broken);
    for (uint8_t i = 0; i < EIGHT_LAST; i++) assert_true(result->readings[i] > 10);
}

static void seven_keep_their_readings(uint8_t trouble)
{
    for (uint8_t mix = 0; mix < EIGHT_MIXES; mix++) {
        const eight_result_t *const alive = all_well(mix);
        eight_result_t result;
        expect_sound(alive, eight_mix_names[mix]);
        assert_true(alive->readings[EIGHT_LAST] > 10);
        eight_run(mix, trouble, SOUND, seconds(mix), SEED, &result);
        expect_sound(&result, eight_mix_names[mix]);
        assert_int_equal(result.readings[EIGHT_LAST], 0);
        const uint32_t percent = eight_percent(alive, &result);
        if (percent < EIGHT_LEAST_PERCENT)
            print_error("%s: %lu percent\n", eight_mix_names[mix], (unsigned long)percent);
        assert_true(percent >= EIGHT_LEAST_PERCENT);
    }
}

TEST(with_one_of_eight_dead_seven_keep_nine_tenths_and_it_comes_back_in_time)
{
    seven_keep_their_readings(EIGHT_DEAD);
}

TEST(with_one_of_eight_always_damaged_seven_keep_nine_tenths_and_it_comes_back_in_time)
{
    seven_keep_their_readings(EIGHT_DAMAGED);
}

TEST(without_back_off_one_dead_unit_takes_more_than_a_tenth)
{
    for (uint8_t mix = 0; mix < EIGHT_MIXES; mix++) {
        eight_result_t alive, result;
        eight_run(mix, EIGHT_ALIVE, NEVER_LESS_OFTEN, seconds(mix), SEED, &alive);
        eight_run(mix, EIGHT_DEAD, NEVER_LESS_OFTEN, seconds(mix), SEED, &result);
        expect_sound(&result, eight_mix_names[mix]);
        assert_true(eight_percent(&alive, &result) < EIGHT_LEAST_PERCENT);
    }
}
