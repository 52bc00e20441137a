/* SPDX-License-Identifier: MIT */
#include "pin_stage.h"

/* The switch output of a simulated A16. */

/* What the module measures, one after the other; the last one stays. */
typedef struct {
    const int32_t *values;
    unsigned count, next;
} script_t;

static int32_t next_value(void *ctx, uint8_t probe, uint32_t now_us)
{
    script_t *const script = ctx;
    const int32_t value = script->values[script->next];
    if (script->next + 1 < script->count) script->next++;
    return value;
}

static void set(int32_t mm, a16_config_t config)
{
    begin(mm);
    add_a16(FATHOM_SIM_A16_SWITCH, config);
    take_pins();
}

#define AS_IT_IS ((a16_config_t){0})

EACH_BEGINS(set(999, AS_IT_IS))
static const suite_t suite = {BENCH_ROUNDS, .set_up = begins};

/* ---- A16 4(2) ---- */

TEST(three_measurements_500_ms_apart_make_it_high_and_five_low)
{
    assert_false(level_in(1500 * MS - 1));
    assert_true(level_in(1));
    COUNTED(.measurements = 3);
    bench.fixed.value[0] = 1001;
    assert_true(level_in(2500 * MS - 1));
    assert_false(level_in(1));
    bench.fixed.value[0] = 999;
    pass_us(1500 * MS);
    bench.fixed.value[0] = FATHOM_SIM_NO_TARGET;
    assert_true(level_in(2500 * MS - 1));
    assert_false(level_in(1));
}

/* ! after the measurement: the level has turned with it */
static void expect_turns(const char *turns, const int32_t *values)
{
    script_t script = {values, (unsigned)strlen(turns), 0};
    set(0, (a16_config_t){.scene = {next_value, &script}});
    for (bool high = false; *turns != 0; turns++) {
        pass_us(500 * MS);
        if (*turns == '!') high = !high;
        assert_int_equal(level(), high);
    }
}

TEST(a_row_is_unbroken_and_equality_breaks_it)
{
    static const int32_t rows[] = {999,  999,  1001, 999,  999, 1000, 999,  999,    1, 1,
                                   1001, 1001, 1001, 1001, 999, 1001, 2000, 0xFFFD, 0, -1};
    expect_turns("........!..........!", rows);
}

TEST(the_period_the_threshold_and_the_start_are_options)
{
    set(299, (a16_config_t){.threshold_mm = 300, .period_us = 100 * MS, .start_us = 700 * MS});
    assert_false(level_in(1000 * MS - 1));
    assert_true(level_in(1));
    bench.fixed.value[0] = 301;
    assert_false(level_in(500 * MS));
}

#define THRESHOLD_2000 "01 06 02 06 07 D0 6B DF" /* A16 6(4): the threshold to 2000 mm */
#define NEGATIVE       "01 06 02 05 00 00 98 73" /* A16 6(4): the polarity to negative */

TEST(a_fall_of_the_level_is_a_break_to_the_uart_and_a_rise_is_nothing)
{
    pass_us(100 * MS);
    (void)has_heard("", 0); /* what power-on made */
    assert_true(level_in(1600 * MS));
    assert_true(has_heard("", 0));
    bench.fixed.value[0] = 1001;
    assert_false(level_in(2500 * MS));
    assert_true(has_heard("00", 1));
}

TEST(a_response_from_a_high_pin_stands_alone)
{
    pass_us(1600 * MS);
    (void)has_heard("", 0);
    say(THRESHOLD_2000);
    pass_us(100 * MS);
    assert_true(has_heard(THRESHOLD_2000, 0));
    assert_int_equal(bench.a16.threshold_mm, 2000);
    COUNTED(.writes = 1);
}

TEST(a_response_from_a_low_pin_has_a_break_before_and_behind_it)
{
    set(1500, AS_IT_IS);
    pass_us(2600 * MS);
    (void)has_heard("", 0);
    for (int i = 0; i != 2; i++) {
        say(THRESHOLD_2000);
        pass_us(100 * MS);
        assert_true(has_heard("00" THRESHOLD_2000 "00", 0x201));
        assert_false(level());
    }
    assert_true(level_in(1500 * MS)); /* 1500 mm is under 2000 mm */
}

TEST(polarity_is_obeyed_at_once_and_kept_without_power)
{
    assert_true(level_in(1700 * MS));
    (void)has_heard("", 0);
    say(NEGATIVE);
    assert_false(level_in(8 * 1042 + 4000)); /* the request, and the silence that ends it */
    pass_us(100 * MS);
    /* the fall, the break before the response, the response, the break behind it */
    assert_true(has_heard("00 00" NEGATIVE "00", 0x403));
    bench.fixed.value[0] = 1001;
    assert_true(level_in(2500 * MS));
    fathom_sim_power_cycle(&bench.line, bench.device, 500 * MS, s.clock.now_us);
    assert_false(level());
    assert_true(level_in(500 * MS)); /* nothing decided: far, which is high now */
    assert_int_equal(bench.a16.polarity, 0);
}

TEST(a_setting_does_not_move_the_measurements)
{
    for (int i = 0; i != 7; i++) {
        say(THRESHOLD_2000);
        pass_us(200 * MS);
    }
    pass_us(100 * MS - 1);
    COUNTED(.measurements = 2);
    assert_false(level());
    pass_us(1);
    COUNTED(.measurements = 3);
    assert_true(level());
}

TEST(other_values_of_polarity_and_other_registers_are_silence)
{
    pass_us(1700 * MS);
    (void)has_heard("", 0);
    say("01 06 02 05 00 02 19 B2"); /* polarity 2; CRCs by the bitwise algorithm */
    pass_us(100 * MS);
    say("01 06 02 08 00 01 C8 70"); /* register 0x0208 */
    pass_us(100 * MS);
    assert_true(has_heard("", 0));
    COUNTED(.requests = 2, .unserved = 2, .writes = NONE);
    assert_int_equal(bench.a16.polarity, 1);
}
