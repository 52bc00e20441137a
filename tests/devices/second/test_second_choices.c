/* SPDX-License-Identifier: MIT */
/* Every choice is drawn at each of its ends at least 50 times in 1,000 seeds, and hangs on no other one. */
#include "second_host.h"

#define SEEDS 1000
#define LEAST 50

static int64_t drawn[CHOICE_COUNT][SEEDS];

static int draw_all(void **state)
{
    if (drawn[0][0] != 0) return 0; /* a time, never 0 */
    for (int c = 0; c < CHOICE_COUNT; c++) {
        for (uint64_t seed = 1; seed <= SEEDS; seed++)
            drawn[c][seed - 1] = second_choice_draw((second_choice_t)c, seed);
    }
    return 0;
}

static const suite_t suite = {.set_up = draw_all};

static int count_of(int c, int64_t value)
{
    int count = 0;
    for (int i = 0; i < SEEDS; i++) count += drawn[c][i] == value ? 1 : 0;
    return count;
}

static void at_least(int c, int64_t value)
{
    int count = count_of(c, value);
    if (count < LEAST)
        fail_msg("%s=%lld drawn %d times", second_choice_row((second_choice_t)c)->name, (long long)value,
                 count);
}

TEST(every_end_is_drawn)
{
    for (int c = 0; c < CHOICE_COUNT; c++) {
        const second_choice_row_t *row = second_choice_row((second_choice_t)c);
        if (row->values == NULL) {
            at_least(c, row->low);
            at_least(c, row->high);
            at_least(c, row->usual);
            int inside = 0;
            for (int i = 0; i < SEEDS; i++)
                inside += drawn[c][i] > row->low && drawn[c][i] < row->high ? 1 : 0;
            assert_true(row->low < row->high && inside >= LEAST);
        }
        for (size_t i = 0; i < row->value_count; i++) {
            if (row->values[i].weight > 0)
                at_least(c, row->values[i].value);
            else
                assert_int_equal(count_of(c, row->values[i].value), 0);
        }
    }
}

/* Whether a choice stands at its most frequent value: no two choices agree in (nearly) all seeds. */
TEST(choices_are_independent)
{
    static bool usual[CHOICE_COUNT][SEEDS];
    for (int c = 0; c < CHOICE_COUNT; c++) {
        int64_t value = second_choice_draw((second_choice_t)c, 0);
        for (int i = 0; i < SEEDS; i++) usual[c][i] = drawn[c][i] == value;
    }
    for (int a = 0; a < CHOICE_COUNT; a++) {
        for (int b = 0; b < a; b++) {
            int both = 0, only_a = 0, only_b = 0;
            for (int i = 0; i < SEEDS; i++) {
                both += usual[a][i] && usual[b][i] ? 1 : 0;
                only_a += usual[a][i] && !usual[b][i] ? 1 : 0;
                only_b += !usual[a][i] && usual[b][i] ? 1 : 0;
            }
            assert_true(only_a > 0 && only_b > 0 && both > 0);
        }
    }
}

/* A draw is the same in every kind of device, and seed 0 draws nothing. */
TEST(draws_hang_on_the_seed_alone)
{
    for (int kind = 0; kind < SECOND_KINDS; kind++) {
        second_config_t config = {.kind = (second_kind_t)kind, .seed = 77};
        host_open(&host, &config);
        for (int c = 0; c < CHOICE_COUNT; c++)
            assert_true(second_choice(&host.device[0], (second_choice_t)c) == drawn[c][76]);
        config.seed = 0;
        host_open(&host, &config);
        for (int c = 0; c < CHOICE_COUNT; c++) {
            const second_choice_row_t *row = second_choice_row((second_choice_t)c);
            int64_t usual = row->values != NULL ? row->values[0].value : row->usual;
            assert_true(second_choice(&host.device[0], (second_choice_t)c) == usual);
        }
    }
}

TEST(a_choice_can_be_forced)
{
    second_override_t forced[] = {{"hps_over_range", 65533}, {"hps_baud_code", 3}};
    second_config_t config = {.kind = SECOND_HPS167S, .seed = 5, .overrides = forced, .override_count = 2};
    host_open(&host, &config);
    assert_true(second_choice(&host.device[0], CHOICE_hps_over_range) == 65533);
    assert_int_equal(second_state(&host.device[0]).line.baud, 115200);

    forced[1] = (second_override_t){"hps_no_such_choice", 1};
    assert_false(second_init(&host.device[0], &config));
    forced[1] = (second_override_t){"hps_baud_code", 77};
    assert_false(second_init(&host.device[0], &config));
    forced[1] = (second_override_t){"hps_over_range", 65529};
    assert_false(second_init(&host.device[0], &config));
}
