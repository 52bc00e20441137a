/* SPDX-License-Identifier: MIT */
#include "pin_stage.h"

/* The switch output of a simulated A16. */

/* What the module measures, one after the other; the last one stays. */
typedef struct {
    const int32_t *values;
    unsigned count;
    unsigned next;
} script_t;

static int32_t next_value(void *ctx, uint8_t probe, uint32_t now_us)
{
    script_t *const script = ctx;
    (void)probe;
    (void)now_us;
    const int32_t value = script->values[script->next];
    if (script->next + 1 < script->count) script->next++;
    return value;
}

static void set_a16(stage_t *s, int32_t distance, fathom_sim_a16_config_t config)
{
    begin(s);
    s->fixed.value[0] = distance;
    config.mode = FATHOM_SIM_A16_SWITCH;
    if (config.scene.distance == NULL) config.scene = fathom_sim_fixed(&s->fixed);
    fathom_sim_a16_init(&s->a16, &config);
    attach(s, &s->a16.device);
}

#define A16 ((fathom_sim_a16_config_t){0})

static const suite_t suite = {BENCH_ROUNDS};

/* ---- A16 4(2) ---- */

TEST(three_measurements_500_ms_apart_make_it_high_and_five_low)
{
    stage_t s;
    set_a16(&s, 999, A16);
    wait(&s, 1500 * MS - 1);
    assert_false(level(&s));
    wait(&s, 1);
    assert_true(level(&s));
    assert_int_equal(s.a16.device.counters.measurements, 3);
    s.fixed.value[0] = 1001;
    wait(&s, 2500 * MS - 1);
    assert_true(level(&s));
    wait(&s, 1);
    assert_false(level(&s));
    s.fixed.value[0] = 999;
    wait(&s, 1500 * MS);
    s.fixed.value[0] = FATHOM_SIM_NO_TARGET;
    wait(&s, 2500 * MS - 1);
    assert_true(level(&s));
    wait(&s, 1);
    assert_false(level(&s));
}

/* ! after the measurement: the level has turned with it */
static void expect_turns(const char *turns, const int32_t *values)
{
    stage_t s;
    script_t script = {values, (unsigned)strlen(turns), 0};
    set_a16(&s, 0, (fathom_sim_a16_config_t){.scene = {next_value, &script}});
    for (bool high = false; *turns != 0; turns++) {
        wait(&s, 500 * MS);
        if (*turns == '!') high = !high;
        assert_int_equal(level(&s), high);
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
    stage_t s;
    set_a16(&s, 299,
            (fathom_sim_a16_config_t){.threshold_mm = 300, .period_us = 100 * MS, .start_us = 700 * MS});
    wait(&s, 1000 * MS - 1);
    assert_false(level(&s));
    wait(&s, 1);
    assert_true(level(&s));
    s.fixed.value[0] = 301;
    wait(&s, 500 * MS);
    assert_false(level(&s));
}

/* ---- Modbus on the same pins ---- */

/* A16 6(4): the threshold to 2000 mm. */
static const uint8_t threshold_2000[8] = {0x01, 0x06, 0x02, 0x06, 0x07, 0xD0, 0x6B, 0xDF};
/* A16 6(4): the polarity to negative. */
static const uint8_t negative[8] = {0x01, 0x06, 0x02, 0x05, 0x00, 0x00, 0x98, 0x73};

TEST(a_fall_of_the_level_is_a_break_to_the_uart_and_a_rise_is_nothing)
{
    stage_t s;
    uint8_t bytes[32];
    uint8_t bad;
    set_a16(&s, 999, A16);
    wait(&s, 100 * MS);
    receive(&s, bytes, &bad); /* what power-on made */
    wait(&s, 1600 * MS);
    assert_true(level(&s));
    assert_int_equal(receive(&s, bytes, &bad), 0);
    s.fixed.value[0] = 1001;
    wait(&s, 2500 * MS);
    assert_false(level(&s));
    assert_int_equal(receive(&s, bytes, &bad), 1);
    assert_int_equal(bytes[0], 0);
    assert_int_equal(bad, 1);
}

TEST(an_answer_from_a_high_pin_stands_alone)
{
    stage_t s;
    uint8_t bytes[32];
    uint8_t bad;
    set_a16(&s, 999, A16);
    wait(&s, 1600 * MS);
    receive(&s, bytes, &bad);
    say(&s, threshold_2000, 8);
    wait(&s, 100 * MS);
    assert_int_equal(receive(&s, bytes, &bad), 8);
    assert_memory_equal(bytes, threshold_2000, 8);
    assert_int_equal(bad, 0);
    assert_int_equal(s.a16.threshold_mm, 2000);
    assert_int_equal(s.a16.device.counters.writes, 1);
}

TEST(an_answer_from_a_low_pin_has_a_break_before_and_behind_it)
{
    stage_t s;
    uint8_t bytes[32];
    uint8_t bad;
    set_a16(&s, 1500, A16);
    wait(&s, 2600 * MS);
    receive(&s, bytes, &bad);
    for (int i = 0; i != 2; i++) {
        say(&s, threshold_2000, 8);
        wait(&s, 100 * MS);
        assert_int_equal(receive(&s, bytes, &bad), 10);
        assert_int_equal(bytes[0], 0);
        assert_memory_equal(bytes + 1, threshold_2000, 8);
        assert_int_equal(bytes[9], 0);
        assert_int_equal(bad, 1); /* of the first eight bytes */
        assert_false(level(&s));
    }
    wait(&s, 1500 * MS); /* 1500 mm is under 2000 mm */
    assert_true(level(&s));
}

TEST(polarity_is_obeyed_at_once_and_kept_without_power)
{
    stage_t s;
    uint8_t bytes[32];
    uint8_t bad;
    set_a16(&s, 999, A16);
    wait(&s, 1700 * MS);
    assert_true(level(&s));
    receive(&s, bytes, &bad);
    say(&s, negative, 8);
    wait(&s, 8 * 1042 + 4000); /* the request, and the silence that ends it */
    assert_false(level(&s));
    wait(&s, 100 * MS);
    /* the fall, the break before the answer, the answer, the break behind it */
    assert_int_equal(receive(&s, bytes, &bad), 11);
    assert_memory_equal(bytes + 2, negative, 8);
    s.fixed.value[0] = 1001;
    wait(&s, 2500 * MS);
    assert_true(level(&s));
    fathom_sim_power_cycle(&s.line, &s.a16.device, 500 * MS, s.clock.now_us);
    assert_false(level(&s));
    wait(&s, 500 * MS);
    assert_true(level(&s)); /* nothing decided: far, which is high now */
    assert_int_equal(s.a16.polarity, 0);
}

TEST(a_setting_does_not_move_the_measurements)
{
    stage_t s;
    set_a16(&s, 999, A16);
    for (int i = 0; i != 7; i++) {
        say(&s, threshold_2000, 8);
        wait(&s, 200 * MS);
    }
    wait(&s, 100 * MS - 1);
    assert_int_equal(s.a16.device.counters.measurements, 2);
    assert_false(level(&s));
    wait(&s, 1);
    assert_int_equal(s.a16.device.counters.measurements, 3);
    assert_true(level(&s));
}

TEST(other_values_of_polarity_and_other_registers_are_silence)
{
    stage_t s;
    uint8_t bytes[32];
    uint8_t bad;
    /* CRCs by the bitwise algorithm: polarity 2, and register 0x0208 */
    static const uint8_t polarity_2[8] = {0x01, 0x06, 0x02, 0x05, 0x00, 0x02, 0x19, 0xB2};
    static const uint8_t unknown[8] = {0x01, 0x06, 0x02, 0x08, 0x00, 0x01, 0xC8, 0x70};
    set_a16(&s, 999, A16);
    wait(&s, 1700 * MS);
    receive(&s, bytes, &bad);
    say(&s, polarity_2, 8);
    wait(&s, 100 * MS);
    say(&s, unknown, 8);
    wait(&s, 100 * MS);
    assert_int_equal(receive(&s, bytes, &bad), 0);
    assert_int_equal(s.a16.device.counters.requests, 2);
    assert_int_equal(s.a16.device.counters.unserved, 2);
    assert_int_equal(s.a16.device.counters.writes, 0);
    assert_int_equal(s.a16.polarity, 1);
}
