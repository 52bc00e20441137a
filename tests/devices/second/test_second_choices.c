/* SPDX-License-Identifier: MIT */
/* Every choice is drawn at each of its ends at least 50 times in 1,000 seeds. */
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
