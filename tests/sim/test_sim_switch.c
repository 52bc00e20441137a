/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "bench.h"
#include "sim/a05.h"
#include "sim/a16.h"
#include "sim/pin.h"
#include "sim/scene.h"

/* The switch output of a simulated A16 and the relay of a simulated A05, seen at the pin and on the wire. */

enum { MS = 1000 };

/* What the module measures, one after the other; the last one stays. */
typedef struct {
    const int32_t *values;
    unsigned count;
    unsigned next;
} script_t;

typedef struct {
    fathom_sim_clock_t clock;
    fathom_sim_line_t line;
    script_t script;
    fathom_sim_fixed_t fixed;
    fathom_sim_a16_t a16;
    fathom_sim_a05_t a05;
    fathom_sim_pins_t pins;
    fathom_pin_t pin;
    unsigned edges;
    uint32_t edge_us;
} stage_t;

static int32_t next_value(void *ctx, uint8_t probe, uint32_t now_us)
{
    script_t *const script = ctx;
    (void)probe;
    (void)now_us;
    const int32_t value = script->values[script->next];
    if (script->next + 1 < script->count) script->next++;
    return value;
}

static void on_edge(void *ctx, bool high, uint32_t time_us)
{
    stage_t *const s = ctx;
    (void)high;
    s->edges++;
    s->edge_us = time_us;
}

static void attach(stage_t *s, fathom_sim_device_t *device)
{
    s->line.full_duplex = true;
    fathom_sim_attach(&s->line, device, s->clock.now_us);
    fathom_sim_pins_init(&s->pins, device, &s->line, &s->clock);
    s->pins.on_edge = on_edge;
    s->pins.on_edge_ctx = s;
    s->pin = fathom_sim_tx_pin(&s->pins);
}

static void begin(stage_t *s)
{
    memset(s, 0, sizeof *s);
    fathom_sim_clock_init(&s->clock, bench_start_us, 0);
    fathom_sim_line_init(&s->line, &bench_9600, bench_start_us);
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

static void set_a05(stage_t *s, int32_t distance, fathom_sim_a05_config_t config)
{
    begin(s);
    for (int i = 0; i != 4; i++) s->fixed.value[i] = distance;
    config.mode = FATHOM_SIM_A05_RELAY;
    config.scene = fathom_sim_fixed(&s->fixed);
    fathom_sim_a05_init(&s->a05, &config);
    attach(s, &s->a05.device);
}

#define A16 ((fathom_sim_a16_config_t){0})
#define A05 ((fathom_sim_a05_config_t){0})

static void wait(stage_t *s, uint32_t by_us) { fathom_sim_clock_advance(&s->clock, by_us); }

static bool level(const stage_t *s) { return s->pin.get(s->pin.ctx); }

/* ---- A16 4(2) ---- */

static void three_measurements_500_ms_apart_make_it_high_and_five_low(void **state)
{
    stage_t s;
    (void)state;
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

static void a_row_is_unbroken_and_equality_breaks_it(void **state)
{
    static const int32_t rows[] = {999,  999,  1001, 999,  999, 1000, 999,  999,    1, 1,
                                   1001, 1001, 1001, 1001, 999, 1001, 2000, 0xFFFD, 0, -1};
    (void)state;
    expect_turns("........!..........!", rows);
}

static void the_period_the_threshold_and_the_start_are_options(void **state)
{
    stage_t s;
    (void)state;
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

static size_t receive(stage_t *s, uint8_t *bytes, uint8_t *bad)
{
    size_t count = 0;
    *bad = 0;
    for (;;) {
        fathom_rx_t rx = {0, 0};
        const size_t n = fathom_sim_transmit_timed(&s->line, s->clock.now_us, bytes + count, 1, 0xFF, &rx);
        if (n == 0) return count;
        if ((rx.flags & FATHOM_RX_FRAMING) != 0) *bad |= (uint8_t)(1u << count);
        count++;
    }
}

static void say(stage_t *s, const uint8_t *bytes, size_t count)
{
    assert_int_equal(fathom_sim_receive(&s->line, bytes, count, s->clock.now_us), count);
}

/* A16 6(4): the threshold to 2000 mm. */
static const uint8_t threshold_2000[8] = {0x01, 0x06, 0x02, 0x06, 0x07, 0xD0, 0x6B, 0xDF};
/* A16 6(4): the polarity to negative. */
static const uint8_t negative[8] = {0x01, 0x06, 0x02, 0x05, 0x00, 0x00, 0x98, 0x73};

static void a_fall_of_the_level_is_a_break_to_the_uart_and_a_rise_is_nothing(void **state)
{
    stage_t s;
    uint8_t bytes[32];
    uint8_t bad;
    (void)state;
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

static void an_answer_from_a_high_pin_stands_alone(void **state)
{
    stage_t s;
    uint8_t bytes[32];
    uint8_t bad;
    (void)state;
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

static void an_answer_from_a_low_pin_has_a_break_before_and_behind_it(void **state)
{
    stage_t s;
    uint8_t bytes[32];
    uint8_t bad;
    (void)state;
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

static void polarity_is_obeyed_at_once_and_kept_without_power(void **state)
{
    stage_t s;
    uint8_t bytes[32];
    uint8_t bad;
    (void)state;
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
    fathom_sim_detach(&s.line, &s.a16.device, s.clock.now_us);
    wait(&s, 500 * MS);
    fathom_sim_attach(&s.line, &s.a16.device, s.clock.now_us);
    assert_true(level(&s)); /* nothing decided: far, which is high now */
    assert_int_equal(s.a16.polarity, 0);
}

static void a_setting_does_not_move_the_measurements(void **state)
{
    stage_t s;
    (void)state;
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

static void other_values_of_polarity_and_other_registers_are_silence(void **state)
{
    stage_t s;
    uint8_t bytes[32];
    uint8_t bad;
    /* CRCs by the bitwise algorithm: polarity 2, and register 0x0208 */
    static const uint8_t polarity_2[8] = {0x01, 0x06, 0x02, 0x05, 0x00, 0x02, 0x19, 0xB2};
    static const uint8_t unknown[8] = {0x01, 0x06, 0x02, 0x08, 0x00, 0x01, 0xC8, 0x70};
    (void)state;
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

/* ---- A05 4 ---- */

static void the_relay_closes_for_any_probe_that_is_nearer(void **state)
{
    stage_t s;
    (void)state;
    for (int i = 0; i != 4; i++) {
        set_a05(&s, FATHOM_SIM_NO_TARGET, A05);
        wait(&s, 300 * MS);
        assert_true(level(&s)); /* open, pulled up */
        s.fixed.value[i] = 999;
        wait(&s, 300 * MS);
        assert_false(level(&s));
        s.fixed.value[i] = 1000; /* equality holds */
        wait(&s, 5000 * MS);
        assert_false(level(&s));
        s.fixed.value[i] = 1001;
        wait(&s, 300 * MS);
        assert_true(level(&s));
        assert_int_equal(s.edges, 2);
    }
}

static void each_state_of_the_relay_lasts_a_second(void **state)
{
    stage_t s;
    (void)state;
    set_a05(&s, 999, A05);
    wait(&s, 300 * MS);
    assert_false(level(&s));
    const uint32_t closed_us = s.edge_us;
    for (int i = 0; i != 4; i++) s.fixed.value[i] = 2000;
    wait(&s, 1199 * MS);
    assert_false(level(&s));
    wait(&s, 1 * MS); /* the first measurement after a second */
    assert_true(level(&s));
    ASSERT_SPAN(s.edge_us, closed_us, 1200 * MS, 1200 * MS);
    s.fixed.value[2] = 1;
    wait(&s, 1200 * MS);
    assert_false(level(&s));
    assert_int_equal(s.edges, 3);
    set_a05(&s, 999, (fathom_sim_a05_config_t){.hold_us = 200 * MS});
    wait(&s, 300 * MS);
    assert_false(level(&s));
    for (int i = 0; i != 4; i++) s.fixed.value[i] = 2000;
    wait(&s, 300 * MS);
    assert_true(level(&s));
}

static void what_is_taught_and_wired_are_options(void **state)
{
    stage_t s;
    (void)state;
    set_a05(&s, 2999,
            (fathom_sim_a05_config_t){.threshold_mm = 3000, .normally_closed = true, .period_us = 100 * MS});
    assert_false(level(&s)); /* it conducts */
    wait(&s, 100 * MS);
    assert_true(level(&s));
    set_a05(&s, 3001, (fathom_sim_a05_config_t){.probes = 0x0D, .threshold_mm = 3000});
    s.fixed.value[1] = 1; /* not fitted */
    wait(&s, 3000 * MS);
    assert_true(level(&s));
    assert_int_equal(s.a05.device.counters.measurements, 30);
}

static void a_contact_may_bounce(void **state)
{
    stage_t s;
    (void)state;
    set_a05(&s, 999, (fathom_sim_a05_config_t){.bounces = 6});
    wait(&s, 300 * MS);
    assert_int_equal(s.edges, 1);
    assert_false(level(&s));
    wait(&s, 700);
    assert_true(level(&s));
    wait(&s, 5 * 700);
    assert_int_equal(s.edges, 7);
    assert_false(level(&s));
    wait(&s, 5000 * MS);
    assert_int_equal(s.edges, 7);
    assert_false(level(&s));
}

static void the_relay_has_no_ears_and_no_voice(void **state)
{
    stage_t s;
    uint8_t bytes[32];
    uint8_t bad;
    (void)state;
    set_a05(&s, 999, A05);
    say(&s, (const uint8_t[]){0x01, 0x03, 0x01, 0x06, 0x00, 0x01, 0x65, 0xF7}, 8); /* A05 3(4) example 1 */
    wait(&s, 5000 * MS);
    assert_int_equal(receive(&s, bytes, &bad), 0);
    assert_int_equal(s.a05.device.counters.unheard, 8);
}

static const struct CMUnitTest tests[] = {
    cmocka_unit_test(three_measurements_500_ms_apart_make_it_high_and_five_low),
    cmocka_unit_test(a_row_is_unbroken_and_equality_breaks_it),
    cmocka_unit_test(the_period_the_threshold_and_the_start_are_options),
    cmocka_unit_test(a_fall_of_the_level_is_a_break_to_the_uart_and_a_rise_is_nothing),
    cmocka_unit_test(an_answer_from_a_high_pin_stands_alone),
    cmocka_unit_test(an_answer_from_a_low_pin_has_a_break_before_and_behind_it),
    cmocka_unit_test(polarity_is_obeyed_at_once_and_kept_without_power),
    cmocka_unit_test(a_setting_does_not_move_the_measurements),
    cmocka_unit_test(other_values_of_polarity_and_other_registers_are_silence),
    cmocka_unit_test(the_relay_closes_for_any_probe_that_is_nearer),
    cmocka_unit_test(each_state_of_the_relay_lasts_a_second),
    cmocka_unit_test(what_is_taught_and_wired_are_options),
    cmocka_unit_test(a_contact_may_bounce),
    cmocka_unit_test(the_relay_has_no_ears_and_no_voice),
};

BENCH_MAIN(tests)
