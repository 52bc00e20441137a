/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "bench.h"
#include "fathom/a05_auto.h"
#include "fathom/a05_relay.h"
#include "fathom/a05_relay_rule.h"
#include "fathom/a16_auto.h"
#include "fathom/a16_settings.h"
#include "fathom/a16_switch.h"
#include "fathom/debounce.h"
#include "fathom/modbus_client.h"
#include "sim/a05.h"
#include "sim/a16.h"
#include "sim/pin.h"
#include "sim/scene.h"

/* The drivers of switch and relay at simulated modules, and the same switches in software beside them. */

enum { MS = 1000, LOG = 64 };

/* A line with a module on it, and what the host has of them. */
typedef struct {
    fathom_sim_line_t wire;
    fathom_sim_uart_t uart;
    fathom_sim_pins_t pins;
    fathom_uart_t hal;
    fathom_pin_t pin;
    uint8_t frame[13];
    fathom_line_config_t config;
    fathom_line_t line;
} port_t;

typedef struct {
    fathom_sim_clock_t sim_clock;
    fathom_clock_t clock;
    port_t port[2];
    fathom_sim_fixed_t fixed;
    fathom_sim_a16_t sim_a16[2];
    fathom_sim_a05_t sim_a05[2];
    fathom_a16_switch_t a16;
    fathom_a05_relay_t a05;
    fathom_sensor_t sensor;
    fathom_modbus_t modbus;
    fathom_a16_modbus_t settings;
    uint8_t kinds[LOG]; /* of all samples */
    uint32_t times_us[LOG];
    unsigned samples;
    unsigned errors;
} stage_t;

static stage_t s;

static void set_up_port(port_t *port, fathom_sim_device_t *device)
{
    fathom_sim_line_init(&port->wire, &bench_9600, bench_start_us);
    port->wire.full_duplex = true;
    fathom_sim_attach(&port->wire, device, bench_start_us);
    fathom_sim_uart_init(&port->uart, &port->wire, &s.sim_clock);
    fathom_sim_pins_init(&port->pins, device, &port->wire, &s.sim_clock);
    port->hal = fathom_sim_uart(&port->uart);
    port->pin = fathom_sim_tx_pin(&port->pins);
    port->config = (fathom_line_config_t){.uart = &port->hal,
                                          .clock = &s.clock,
                                          .frame = port->frame,
                                          .frame_size = sizeof port->frame,
                                          .echo = FATHOM_LINE_ECHO_OFF};
    assert_int_equal(fathom_line_init(&port->line, &port->config), FATHOM_READY);
}

static void begin(int32_t distance)
{
    memset(&s, 0, sizeof s);
    fathom_sim_clock_init(&s.sim_clock, bench_start_us, 0);
    s.clock = fathom_sim_clock(&s.sim_clock);
    for (int i = 0; i != 4; i++) s.fixed.value[i] = distance;
}

static void set_a16(int32_t distance)
{
    begin(distance);
    const fathom_sim_a16_config_t config = {.mode = FATHOM_SIM_A16_SWITCH,
                                            .scene = fathom_sim_fixed(&s.fixed)};
    fathom_sim_a16_init(&s.sim_a16[0], &config);
    set_up_port(&s.port[0], &s.sim_a16[0].device);
    const fathom_a16_switch_config_t own = {
        .pin = &s.port[0].pin, .clock = &s.clock, .line = &s.port[0].line, .address = 1};
    assert_int_equal(fathom_a16_switch_init(&s.a16, &own), FATHOM_READY);
    s.sensor = fathom_a16_switch_sensor(&s.a16);
    s.modbus = fathom_modbus_client(&s.port[0].line);
    const fathom_a16_modbus_config_t asks = {.modbus = &s.modbus, .clock = &s.clock};
    assert_int_equal(fathom_a16_modbus_init(&s.settings, &asks), FATHOM_READY);
}

static void set_a05(int32_t distance, fathom_sim_a05_config_t config, uint8_t wiring)
{
    begin(distance);
    config.mode = FATHOM_SIM_A05_RELAY;
    config.scene = fathom_sim_fixed(&s.fixed);
    fathom_sim_a05_init(&s.sim_a05[0], &config);
    set_up_port(&s.port[0], &s.sim_a05[0].device);
    const fathom_a05_relay_config_t own = {.pin = &s.port[0].pin, .clock = &s.clock, .wiring = wiring};
    assert_int_equal(fathom_a05_relay_init(&s.a05, &own), FATHOM_READY);
    s.sensor = fathom_a05_relay_sensor(&s.a05);
}

static void look(void)
{
    fathom_sample_t sample;
    const fathom_status_t status = fathom_poll(&s.sensor, &sample);
    if (status == FATHOM_READY) {
        assert_true(s.samples < LOG);
        s.kinds[s.samples] = sample.kind;
        s.times_us[s.samples++] = sample.time_us;
    }
    s.errors += status < 0;
}

static void run(uint32_t for_us, uint32_t step_us)
{
    for (uint32_t passed_us = 0; passed_us < for_us; passed_us += step_us) {
        fathom_sim_clock_advance(&s.sim_clock, step_us);
        look();
    }
}

/* One kind a letter. */
static void expect(const char *kinds)
{
    assert_int_equal(s.samples, strlen(kinds));
    for (unsigned i = 0; kinds[i] != 0; i++)
        assert_int_equal(s.kinds[i], kinds[i] == 'N' ? FATHOM_NEAR : FATHOM_FAR);
    assert_int_equal(s.errors, 0);
}

static const uint32_t steps_us[] = {500, 7000, 20000};
enum { STEPS = sizeof steps_us / sizeof *steps_us };

/* ---- A16 ---- */

static void the_switch_of_an_a16_is_read_in_any_loop(void **state)
{
    (void)state;
    for (unsigned i = 0; i != STEPS; i++) {
        const uint32_t step_us = steps_us[i];
        set_a16(2000);
        run(200 * MS, step_us);
        expect("F");
        for (unsigned n = 0; n != 2; n++) {
            s.fixed.value[0] = 999;
            const uint32_t came_us = s.sim_clock.now_us;
            run(2100 * MS, step_us);
            ASSERT_SPAN(s.times_us[s.samples - 1], came_us, 1000 * MS, 1500 * MS + step_us);
            s.fixed.value[0] = 1001;
            const uint32_t went_us = s.sim_clock.now_us;
            run(3100 * MS, step_us);
            /* and the byte that the UART makes of the fall keeps it waiting for 5 ms and a look */
            ASSERT_SPAN(s.times_us[s.samples - 1], went_us, 2000 * MS, 2500 * MS + 2 * step_us + 7 * MS);
        }
        expect("FNFNF");
    }
}

static void a_program_that_sleeps_as_long_as_it_is_told_sees_each_change(void **state)
{
    unsigned looks = 0;
    (void)state;
    set_a16(2000);
    for (int32_t mm = 999; mm <= 1001; mm += 2) {
        s.fixed.value[0] = mm;
        const uint32_t from_us = s.sim_clock.now_us;
        while (fathom_elapsed_us(s.sim_clock.now_us, from_us) < 4000 * MS) {
            fathom_sim_clock_idle(&s.sim_clock, fathom_due_us(&s.sensor, 1));
            look();
            looks++;
        }
    }
    expect("FNF");
    assert_in_range(looks, 700, 1000); /* 8 s at 10 ms, and what happens besides */
}

static void set_threshold(uint16_t mm, uint32_t step_us)
{
    fathom_status_t status;
    while ((status = fathom_a16_set_switch_threshold_mm(&s.settings, mm)) == FATHOM_PENDING)
        run(step_us, step_us);
    assert_int_equal(status, FATHOM_READY);
    uint16_t read_mm = 0;
    while ((status = fathom_a16_switch_threshold_mm(&s.settings, &read_mm)) == FATHOM_PENDING)
        run(step_us, step_us);
    assert_int_equal(status, FATHOM_READY);
    assert_int_equal(read_mm, mm);
}

static void the_threshold_is_set_on_the_same_pins_and_no_answer_is_a_change(void **state)
{
    (void)state;
    for (unsigned i = 0; i != STEPS; i++) {
        set_a16(1500);
        run(3000 * MS, steps_us[i]);
        expect("F");
        set_threshold(1400, steps_us[i]); /* with the pin low */
        set_threshold(1300, steps_us[i]);
        run(3000 * MS, steps_us[i]);
        expect("F");
        set_threshold(1501, steps_us[i]);
        run(3000 * MS, steps_us[i]);
        expect("FN");
        set_threshold(1600, steps_us[i]); /* with the pin high */
        set_threshold(1502, steps_us[i]);
        run(3000 * MS, steps_us[i]);
        expect("FN");
        set_threshold(1499, steps_us[i]);
        run(3500 * MS, steps_us[i]);
        expect("FNF");
        assert_int_equal(s.sim_a16[0].device.counters.writes, 6);
        assert_true(s.port[0].line.counters[FATHOM_LINE_BAD_BYTES] >= 10); /* breaks around answers */
        assert_int_equal(s.port[0].line.counters[FATHOM_LINE_NO_ANSWERS], 0);
        assert_int_equal(s.port[0].line.counters[FATHOM_LINE_CHECKSUM_ERRORS], 0);
    }
}

/* A port that marks nothing: the bytes of a break are noise, and a line that is not told does not find out that it has
 * no echo. Then a write is not believed by its answer, but by the value that is read back. */
static void a_port_that_knows_nothing_will_do(void **state)
{
    (void)state;
    set_a16(1500);
    s.port[0].config.echo = FATHOM_LINE_ECHO_AUTO;
    s.port[0].uart.knows = 0;
    run(3000 * MS, 20000);
    set_threshold(1501, 20000);
    run(3000 * MS, 20000);
    set_threshold(1400, 20000);
    run(4000 * MS, 20000);
    expect("FNF");
    assert_true(s.port[0].line.counters[FATHOM_LINE_DROPPED_BYTES] >= 4);
    assert_int_equal(s.port[0].line.counters[FATHOM_LINE_NO_ANSWERS], 1);
}

static fathom_status_t set_polarity(fathom_a16_polarity_t polarity, uint32_t step_us)
{
    fathom_status_t status;
    while ((status = fathom_a16_switch_set_polarity(&s.a16, &s.settings, polarity)) == FATHOM_PENDING)
        run(step_us, step_us);
    return status;
}

static void the_polarity_is_set_and_the_driver_reads_by_it(void **state)
{
    (void)state;
    for (unsigned i = 0; i != STEPS; i++) {
        const uint32_t step_us = steps_us[i];
        for (int32_t mm = 999; mm <= 1001; mm += 2) {
            set_a16(mm);
            run(3100 * MS, step_us);
            const unsigned before = s.samples;
            assert_int_equal(set_polarity(FATHOM_A16_NEGATIVE, step_us), FATHOM_READY);
            run(3000 * MS, step_us);
            assert_int_equal(s.samples, before); /* nothing has come nearer or gone */
            assert_int_equal(s.sim_a16[0].polarity, 0);
            s.fixed.value[0] = 2000 - mm;
            run(3100 * MS, step_us);
            assert_int_equal(set_polarity(FATHOM_A16_POSITIVE, step_us), FATHOM_READY);
            s.fixed.value[0] = mm;
            run(3100 * MS, step_us);
            expect(mm == 999 ? "FNFN" : "FNF");
        }
    }
}

static void a_polarity_that_could_not_be_set_changes_nothing(void **state)
{
    (void)state;
    set_a16(999);
    run(2100 * MS, 20000);
    expect("FN");
    fathom_sim_detach(&s.port[0].wire, &s.sim_a16[0].device, s.sim_clock.now_us);
    assert_int_equal(set_polarity(FATHOM_A16_NEGATIVE, 20000), FATHOM_ERR_NO_ANSWER);
    run(1000 * MS, 20000);
    expect("FN");
    /* it can be told what somebody else has done */
    fathom_a16_switch_polarity_is(&s.a16, FATHOM_A16_NEGATIVE);
    run(100 * MS, 20000);
    expect("FNF");
}

static void while_the_polarity_is_being_set_the_level_is_not_looked_at(void **state)
{
    (void)state;
    set_a16(999);
    run(2100 * MS, 20000);
    assert_int_equal(fathom_a16_switch_set_polarity(&s.a16, &s.settings, FATHOM_A16_NEGATIVE),
                     FATHOM_PENDING);
    fathom_a16_cancel(&s.settings);
    fathom_sim_tx_wire(&s.port[0].pins, FATHOM_SIM_WIRE_LOW);
    run(1500 * MS, 20000);
    expect("FN");
    run(600 * MS, 20000);
    assert_int_equal(s.errors, 1); /* FATHOM_ERR_STALE */
    s.errors = 0;
    fathom_a16_switch_polarity_is(&s.a16, FATHOM_A16_POSITIVE);
    run(100 * MS, 20000);
    expect("FNF");
}

/* ---- A05 ---- */

static void the_relay_of_an_a05_is_read_in_any_loop_and_by_either_contact(void **state)
{
    (void)state;
    for (unsigned i = 0; i != STEPS; i++) {
        for (unsigned closed = 0; closed != 2; closed++) {
            const fathom_sim_a05_config_t bounces = {.bounces = 10, .normally_closed = closed != 0};
            set_a05(FATHOM_SIM_NO_TARGET, bounces,
                    closed != 0 ? FATHOM_A05_RELAY_NORMALLY_CLOSED : FATHOM_A05_RELAY_NORMALLY_OPEN);
            run(2000 * MS, steps_us[i]);
            expect("F");
            for (unsigned probe = 0; probe != 4; probe++) {
                s.fixed.value[probe] = 500;
                run(400 * MS, steps_us[i]);
                s.fixed.value[probe] = 3000;
                run(400 * MS, steps_us[i]);
                assert_int_equal(s.samples, 2 + 2 * probe); /* held for 1 s */
                run(2000 * MS, steps_us[i]);
            }
            expect("FNFNFNFNF");
            for (unsigned n = 2; n != s.samples; n++)
                assert_true(fathom_elapsed_us(s.times_us[n], s.times_us[n - 1]) >= 1000 * MS - steps_us[i]);
        }
    }
}

/* ---- the same in software ---- */

static uint32_t random_state;
static int32_t any_distance(void)
{
    static const int32_t choice[] = {400, 999, 1000, 1001, 3000, FATHOM_SIM_NO_TARGET};
    random_state = random_state * UINT32_C(1664525) + UINT32_C(1013904223);
    return choice[(random_state >> 16) % 6];
}

static void forget_old_samples(void)
{
    if (s.samples <= LOG / 2) return;
    s.kinds[0] = s.kinds[s.samples - 1];
    s.samples = 1;
}

/* An A16 that sends by itself every 500 ms sees what the switch sees: its frames, debounced, are that switch. */
static void a_debounced_a16_is_the_switch_of_one(void **state)
{
    fathom_a16_auto_t automatic;
    fathom_debounce_t gate;
    (void)state;
    random_state = 1;
    set_a16(2000);
    const fathom_sim_a16_config_t config = {
        .mode = FATHOM_SIM_A16_UART, .scene = fathom_sim_fixed(&s.fixed), .period_us = 500 * MS};
    fathom_sim_a16_init(&s.sim_a16[1], &config);
    set_up_port(&s.port[1], &s.sim_a16[1].device);
    const fathom_a16_auto_config_t own = {.line = &s.port[1].line};
    assert_int_equal(fathom_a16_auto_init(&automatic, &own), FATHOM_READY);
    assert_int_equal(fathom_debounce_init(&gate, &(fathom_debounce_config_t){0}), FATHOM_READY);
    const fathom_sensor_t sensor = fathom_a16_auto_sensor(&automatic);
    unsigned changes = 0;
    run(100 * MS, 20 * MS); /* from here the scene changes between the measurements */
    for (unsigned n = 0; n != 1000; n++) {
        fathom_sample_t sample;
        if (n % 6 == 0) s.fixed.value[0] = any_distance();
        for (unsigned step = 0; step != 25; step++) {
            run(20 * MS, 20 * MS);
            while (fathom_poll(&sensor, &sample) == FATHOM_READY)
                changes += fathom_debounce_sample(&gate, &sample);
        }
        if (gate.level != 0) assert_int_equal(gate.level, s.kinds[s.samples - 1]);
        forget_old_samples();
    }
    assert_in_range(changes, 30, 600);
    assert_int_equal(s.errors, 0);
}

/* An A05 that sends by itself measures with the relay, every 300 ms. */
static void the_rule_over_an_a05_is_the_relay_of_one(void **state)
{
    fathom_a05_auto_t automatic;
    fathom_a05_relay_rule_t rule;
    (void)state;
    random_state = 2;
    set_a05(3000, (fathom_sim_a05_config_t){.probes = 0x0B}, 0);
    const fathom_sim_a05_config_t config = {.mode = FATHOM_SIM_A05_AUTO, .scene = fathom_sim_fixed(&s.fixed)};
    fathom_sim_a05_init(&s.sim_a05[1], &config);
    set_up_port(&s.port[1], &s.sim_a05[1].device);
    const fathom_a05_auto_config_t own = {.line = &s.port[1].line, .probes = 0x0B};
    assert_int_equal(fathom_a05_auto_init(&automatic, &own), FATHOM_READY);
    const fathom_a05_relay_rule_config_t same = {.probes = 0x0B};
    assert_int_equal(fathom_a05_relay_rule_init(&rule, &same), FATHOM_READY);
    const fathom_sensor_t sensor = fathom_a05_auto_sensor(&automatic);
    unsigned changes = 0;
    run(100 * MS, 20 * MS); /* from here the scene changes between the measurements */
    for (unsigned n = 0; n != 1000; n++) {
        fathom_sample_t sample;
        for (unsigned i = 0; i != 4; i++)
            if (n % 2 == 0) s.fixed.value[i] = n % 8 < 4 ? any_distance() : 3000;
        for (unsigned step = 0; step != 15; step++) {
            run(20 * MS, 20 * MS);
            while (fathom_poll(&sensor, &sample) == FATHOM_READY)
                changes += fathom_a05_relay_rule_sample(&rule, &sample);
        }
        assert_int_equal(rule.debounce.level, s.kinds[s.samples - 1]);
        forget_old_samples();
    }
    assert_in_range(changes, 100, 1000);
    assert_int_equal(s.errors, 0);
}

static const struct CMUnitTest tests[] = {
    cmocka_unit_test(the_switch_of_an_a16_is_read_in_any_loop),
    cmocka_unit_test(a_program_that_sleeps_as_long_as_it_is_told_sees_each_change),
    cmocka_unit_test(the_threshold_is_set_on_the_same_pins_and_no_answer_is_a_change),
    cmocka_unit_test(a_port_that_knows_nothing_will_do),
    cmocka_unit_test(the_polarity_is_set_and_the_driver_reads_by_it),
    cmocka_unit_test(a_polarity_that_could_not_be_set_changes_nothing),
    cmocka_unit_test(while_the_polarity_is_being_set_the_level_is_not_looked_at),
    cmocka_unit_test(the_relay_of_an_a05_is_read_in_any_loop_and_by_either_contact),
    cmocka_unit_test(a_debounced_a16_is_the_switch_of_one),
    cmocka_unit_test(the_rule_over_an_a05_is_the_relay_of_one),
};

BENCH_MAIN(tests)
