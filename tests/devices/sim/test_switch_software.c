/* SPDX-License-Identifier: MIT */
#include "fathom/processing/debounce.h"
#include "fathom/sensor/a05_auto.h"
#include "fathom/sensor/a05_relay_rule.h"
#include "fathom/sensor/a16_auto.h"
#include "switch_stage.h"

/* The switches in software beside the modules whose rules they are. */

static uint32_t random_state;
static int32_t any_distance(void)
{
    static const int32_t choice[] = {400, 999, 1000, 1001, 3000, FATHOM_SIM_NO_TARGET};
    random_state = random_state * UINT32_C(1664525) + UINT32_C(1013904223);
    return choice[(random_state >> 16) % 6];
}

static void forget_old_samples(void)
{
    if (samples <= LOG / 2) return;
    kinds[0] = kinds[samples - 1];
    samples = 1;
}

/* A second line on the same clock, with s.other on it. */
static struct {
    fathom_sim_line_t wire;
    fathom_sim_uart_t port;
    fathom_uart_t uart;
    uint8_t frame[13];
    fathom_line_parts_t config;
    fathom_line_t line;
} beside;

static void begin_beside(void)
{
    fathom_sim_line_init(&beside.wire, &bench_9600, bench_start_us);
    beside.wire.full_duplex = true;
    fathom_sim_attach(&beside.wire, &s.other.a16.device, bench_start_us);
    fathom_sim_uart_init(&beside.port, &beside.wire, &s.clock);
    beside.uart = fathom_sim_uart(&beside.port);
    beside.config = s.config;
    beside.config.uart = &beside.uart;
    beside.config.frame = beside.frame;
    beside.config.frame_size = sizeof beside.frame;
    assert_int_equal(fathom_line_init(&beside.line, &beside.config), FATHOM_OK);
}

static const suite_t suite = {BENCH_ROUNDS};

/* An A16 that sends by itself every 500 ms sees what the switch sees: its frames, debounced, are that switch. */
TEST(a_debounced_a16_is_the_switch_of_one)
{
    fathom_a16_auto_t automatic;
    fathom_debounce_t gate;
    random_state = 1;
    set_switch(2000);
    const a16_config_t config = {
        .mode = FATHOM_SIM_A16_UART, .scene = fathom_sim_fixed(&bench.fixed), .period_us = 500 * MS};
    fathom_sim_a16_init(&s.other.a16, &config);
    begin_beside();
    assert_int_equal(fathom_a16_auto_init(&automatic, &beside.line, NULL), FATHOM_OK);
    assert_int_equal(fathom_debounce_init(&gate, &(fathom_debounce_config_t){0}), FATHOM_OK);
    const fathom_sensor_t sensor = fathom_a16_auto_sensor(&automatic);
    unsigned changes = 0;
    run(100 * MS, 20 * MS); /* from here the scene changes between the measurements */
    for (unsigned n = 0; n != 1000; n++) {
        fathom_sample_t sample;
        if (n % 6 == 0) bench.fixed.value[0] = any_distance();
        for (unsigned step = 0; step != 25; step++) {
            run(20 * MS, 20 * MS);
            while (fathom_poll(&sensor, &sample) == FATHOM_OK)
                changes += fathom_debounce_add_sample(&gate, &sample);
        }
        if (gate.level != 0) assert_int_equal(gate.level, kinds[samples - 1]);
        forget_old_samples();
    }
    assert_in_range(changes, 30, 600);
    assert_int_equal(errors, 0);
}

/* An A05 that sends by itself measures with the relay, every 300 ms. */
TEST(the_rule_over_an_a05_is_the_relay_of_one)
{
    fathom_a05_auto_t automatic;
    fathom_a05_relay_rule_t rule;
    random_state = 2;
    set_relay(3000, (a05_config_t){.probes = 0x0B}, 0);
    const a05_config_t config = {.mode = FATHOM_SIM_A05_AUTO, .scene = fathom_sim_fixed(&bench.fixed)};
    fathom_sim_a05_init(&s.other.a05, &config);
    begin_beside();
    const fathom_a05_auto_config_t own = {.probes = 0x0B};
    assert_int_equal(fathom_a05_auto_init(&automatic, &beside.line, &own), FATHOM_OK);
    const fathom_a05_relay_rule_config_t same = {.probes = 0x0B};
    assert_int_equal(fathom_a05_relay_rule_init(&rule, &same), FATHOM_OK);
    const fathom_sensor_t sensor = fathom_a05_auto_sensor(&automatic);
    unsigned changes = 0;
    run(100 * MS, 20 * MS); /* from here the scene changes between the measurements */
    for (unsigned n = 0; n != 1000; n++) {
        fathom_sample_t sample;
        for (unsigned i = 0; i != 4; i++)
            if (n % 2 == 0) bench.fixed.value[i] = n % 8 < 4 ? any_distance() : 3000;
        for (unsigned step = 0; step != 15; step++) {
            run(20 * MS, 20 * MS);
            while (fathom_poll(&sensor, &sample) == FATHOM_OK)
                changes += fathom_a05_relay_rule_add_sample(&rule, &sample);
        }
        assert_int_equal(rule.debounce.level, kinds[samples - 1]);
        forget_old_samples();
    }
    assert_in_range(changes, 100, 1000);
    assert_int_equal(errors, 0);
}

/* First contact 3: probe 3 says 7000 mm, which none can measure; probe 1 is near, then it is not, and what stands
 * before probe 3 stays unknown. */
TEST(an_odd_probe_neither_hides_one_that_is_near_nor_keeps_the_level_for_ever)
{
    static const uint8_t levels[] = {FATHOM_NEAR, FATHOM_UNKNOWN};
    fathom_a05_auto_t automatic;
    fathom_a05_relay_rule_t rule;
    set_relay(3000, (a05_config_t){0}, 0);
    const a05_config_t config = {.mode = FATHOM_SIM_A05_AUTO, .scene = fathom_sim_fixed(&bench.fixed)};
    fathom_sim_a05_init(&s.other.a05, &config);
    begin_beside();
    assert_int_equal(fathom_a05_auto_init(&automatic, &beside.line, NULL), FATHOM_OK);
    assert_int_equal(fathom_a05_relay_rule_init(&rule, &(fathom_a05_relay_rule_config_t){0}), FATHOM_OK);
    const fathom_sensor_t sensor = fathom_a05_auto_sensor(&automatic);
    for (unsigned i = 0; i != 2; i++) {
        fathom_sample_t sample;
        bench.fixed = (fathom_sim_fixed_t){{i == 0 ? 500 : 2000, 2000, 7000, 3000}};
        for (unsigned ms = 0; ms != 6000; ms += 20) {
            run(20 * MS, 20 * MS);
            while (fathom_poll(&sensor, &sample) == FATHOM_OK)
                (void)fathom_a05_relay_rule_add_sample(&rule, &sample);
            (void)fathom_debounce_advance(&rule.debounce, s.clock.now_us);
        }
        assert_int_equal(rule.debounce.level, levels[i]);
    }
}
