/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fathom/sensor/internal/dyp.h"

enum { GUARD = 0xA5 };

static uint16_t values[4];
static fathom_model_facts_t facts;
static fathom_dyp_measurement_t response;
static fathom_sample_t sample;

static int set_up(void **state)
{
    memset(values, 0, sizeof values);
    memset(&response, 0, sizeof response);
    memset(&sample, GUARD, sizeof sample);
    response.values = values;
    response.model = FATHOM_A05;
    response.address = 7;
    response.first = 1;
    facts = (fathom_model_facts_t){.max_mm = FATHOM_A05_MAX_MM};
    response.facts = &facts;
    assert_true(fathom_dyp_are_valid(&facts));
    return 0;
}

static const suite_t suite = {.set_up = set_up};

static void assert_sample_untouched(void)
{
    uint8_t untouched[sizeof sample];
    memset(untouched, GUARD, sizeof untouched);
    assert_memory_equal(&sample, untouched, sizeof untouched);
}

static void expect_next(fathom_status_t status)
{
    memset(&sample, GUARD, sizeof sample);
    assert_int_equal(fathom_dyp_measurement_next(&response, &sample), status);
    if (status != FATHOM_OK) assert_sample_untouched();
}

/* The rule, stated apart: 0 is unknown, FFFD is no object, FFFE is no object and interference, all others from FFFB on are
 * refused, the range is a target, everything else is refused too. */
typedef enum { CANNOT_BE, TARGET, NOTHING, INTERFERENCE, UNKNOWN } meaning_t;

static meaning_t meaning_of(uint32_t value, unsigned min_mm, unsigned max_mm)
{
    if (value == 0) return UNKNOWN;
    if (value == 0xFFFD) return NOTHING;
    if (value == 0xFFFE) return INTERFERENCE;
    if (value >= 0xFFFB) return CANNOT_BE;
    return min_mm <= value && value <= max_mm ? TARGET : CANNOT_BE;
}

static unsigned kind_of(meaning_t meaning)
{
    if (meaning == UNKNOWN) return FATHOM_UNKNOWN;
    return meaning == TARGET ? FATHOM_TARGET : FATHOM_NO_TARGET;
}

static void assert_next_means(uint32_t value, meaning_t meaning)
{
    values[0] = (uint16_t)value;
    response.implausible = 0;
    fathom_dyp_measurement_set(&response, 1, 123456);
    expect_next(meaning == CANNOT_BE ? FATHOM_ERR_MALFORMED : FATHOM_OK);
    assert_int_equal(response.implausible, meaning == CANNOT_BE);
    if (meaning != CANNOT_BE) {
        assert_int_equal(sample.raw, value);
        assert_int_equal(sample.kind, kind_of(meaning));
        assert_int_equal(sample.distance_mm, meaning == TARGET ? value : 0);
        assert_int_equal(sample.interference, meaning == INTERFERENCE);
    }
    expect_next(FATHOM_PENDING);
}

/* Targets: max - min + 1, without 0 and without FFFB to FFFF. */
static const struct {
    uint16_t min_mm;
    uint16_t max_mm;
    unsigned targets;
} ranges[] = {
    {1, 16350, 16350}, /* an A16 by default: 94 ms of A16 1(3) */
    {0, 6000, 6000},   {500, 15000, 14501}, {250, 6000, 5751}, {1000, 1000, 1},
    {1, 65530, 65530}, {1, 65535, 65530},   {0, 1, 1},         {65535, 65535, 0},
};

TEST(every_value_means_what_the_rule_says)
{
    for (unsigned i = 0; i != sizeof ranges / sizeof *ranges; i++) {
        unsigned targets = 0;
        facts.min_mm = ranges[i].min_mm;
        facts.max_mm = ranges[i].max_mm;
        assert_true(fathom_dyp_are_valid(&facts));
        for (uint32_t value = 0; value != 65536; value++) {
            const meaning_t meaning = meaning_of(value, facts.min_mm, facts.max_mm);
            assert_next_means(value, meaning);
            targets += meaning == TARGET;
        }
        assert_int_equal(targets, ranges[i].targets);
    }
}

/* ---- First contact 4: what a value means is the user's to say, one by one ---- */

TEST(each_of_the_five_values_takes_each_meaning_and_no_other_value_does)
{
    static const uint16_t five[] = {0, 0xFFFB, 0xFFFD, 0xFFFE, 0xFFFF};
    static const struct {
        uint8_t meaning, kind;
    } meanings[] = {{FATHOM_MEANS_UNKNOWN, FATHOM_UNKNOWN},
                    {FATHOM_MEANS_NO_TARGET, FATHOM_NO_TARGET},
                    {FATHOM_MEANS_INTERFERENCE, FATHOM_NO_TARGET},
                    {FATHOM_MEANS_TOO_NEAR, FATHOM_NEAR},
                    {FATHOM_MEANS_FAULT, FATHOM_FAULT},
                    {FATHOM_MEANS_REFUSED, 0}};
    uint8_t *const members[] = {&facts.value_0, &facts.value_fffb, &facts.value_fffd, &facts.value_fffe,
                                &facts.value_ffff};
    for (unsigned v = 0; v != 5; v++) {
        for (unsigned m = 0; m != 6; m++) {
            facts = (fathom_model_facts_t){.max_mm = 65535};
            *members[v] = meanings[m].meaning;
            assert_true(fathom_dyp_are_valid(&facts));
            assert_next_means(0xFFFC, CANNOT_BE);
            for (unsigned other = 0; other != 5; other++) {
                if (other != v) assert_next_means(five[other], meaning_of(five[other], 1, 65535));
            }
            values[0] = five[v];
            fathom_dyp_measurement_set(&response, 1, 123456);
            expect_next(meanings[m].kind != 0 ? FATHOM_OK : FATHOM_ERR_MALFORMED);
            if (meanings[m].kind == 0) continue;
            assert_int_equal(sample.kind, meanings[m].kind);
            assert_int_equal(sample.raw, five[v]);
            assert_int_equal(sample.distance_mm, 0);
            assert_int_equal(sample.interference, meanings[m].meaning == FATHOM_MEANS_INTERFERENCE);
        }
    }
}

/* Kinds of samples that no value can have, and numbers that are no meaning. */
TEST(facts_without_a_distance_or_with_another_meaning_are_refused)
{
    static const uint8_t none[] = {1, 5, 9, 10, 127, 255};
    uint8_t *const members[] = {&facts.value_0, &facts.value_fffb, &facts.value_fffd, &facts.value_fffe,
                                &facts.value_ffff};
    for (unsigned v = 0; v != 5; v++) {
        for (unsigned n = 0; n != sizeof none; n++) {
            *members[v] = none[n];
            assert_false(fathom_dyp_are_valid(&facts));
        }
        *members[v] = 0;
        assert_true(fathom_dyp_are_valid(&facts));
    }
    facts.min_mm = FATHOM_A05_MAX_MM + 1;
    assert_false(fathom_dyp_are_valid(&facts));
    facts.min_mm = facts.max_mm = 0;
    assert_false(fathom_dyp_are_valid(&facts));
}

TEST(nothing_is_there_before_a_response) { expect_next(FATHOM_PENDING); }
