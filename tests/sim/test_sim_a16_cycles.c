/* SPDX-License-Identifier: MIT */
#include "bench.h"

#include <string.h>

#include "fathom/a16_auto.h"
#include "fathom/a16_controlled.h"
#include "fathom/a16_pwm.h"
#include "fathom/edges.h"
#include "sim/a16.h"
#include "sim/pin.h"
#include "sim/scene.h"
#include "sim/uart.h"

/* Whole cycles: the drivers on the simulated pins, at each start of the clock, in a fine and in slow loops. */

enum { MS = 1000 };

static const uint32_t steps_us[] = {500, 20000, 70000};
enum { STEPS = sizeof steps_us / sizeof steps_us[0] };

typedef struct {
    fathom_sim_clock_t sim_clock;
    fathom_sim_line_t sim_line;
    fathom_sim_uart_t sim_uart;
    fathom_sim_fixed_t fixed;
    fathom_sim_a16_t a16;
    fathom_sim_pins_t pins;

    /* the application's */
    fathom_clock_t clock;
    fathom_uart_t uart;
    fathom_pin_t trigger;
    fathom_pin_t level;
    fathom_capture_t capture;
    fathom_edges_t edges;
    uint8_t frame[13];
    fathom_line_config_t line_config;
    fathom_line_t line;
    fathom_a16_pwm_t pwm;
    fathom_a16_controlled_t controlled;
    fathom_a16_auto_t automatic;
    fathom_sensor_t sensor;

    uint32_t step_us;
    fathom_sample_t last;
    unsigned samples;
    unsigned no_answers;
    unsigned errors; /* others */
} desk_t;

static desk_t desk;

static void set(uint8_t mode, int32_t distance, uint32_t step_us, fathom_sim_a16_config_t config)
{
    memset(&desk, 0, sizeof desk);
    desk.step_us = step_us;
    desk.fixed.value[0] = distance;
    config.mode = mode;
    config.scene = fathom_sim_fixed(&desk.fixed);
    fathom_sim_clock_init(&desk.sim_clock, bench_start_us, 0);
    fathom_sim_line_init(&desk.sim_line, &bench_9600, desk.sim_clock.now_us);
    desk.sim_line.full_duplex = true;
    fathom_sim_uart_init(&desk.sim_uart, &desk.sim_line, &desk.sim_clock);
    fathom_sim_a16_init(&desk.a16, &config);
    fathom_sim_attach(&desk.sim_line, &desk.a16.device, desk.sim_clock.now_us);
    fathom_sim_pins_init(&desk.pins, &desk.a16.device, &desk.sim_line, &desk.sim_clock);
    desk.clock = fathom_sim_clock(&desk.sim_clock);
    desk.uart = fathom_sim_uart(&desk.sim_uart);
    desk.trigger = fathom_sim_rx_pin(&desk.pins);
    desk.level = fathom_sim_tx_pin(&desk.pins);
    desk.capture = fathom_sim_capture(&desk.pins);
    desk.line_config = (fathom_line_config_t){.uart = &desk.uart,
                                              .clock = &desk.clock,
                                              .frame = desk.frame,
                                              .frame_size = sizeof desk.frame,
                                              .silence_us = FATHOM_T3_5_US(9600, 10)};
    assert_int_equal(fathom_line_init(&desk.line, &desk.line_config), FATHOM_READY);
}

static void begin_pwm(bool by_break)
{
    const fathom_a16_pwm_config_t config = {.clock = &desk.clock,
                                            .capture = &desk.capture,
                                            .trigger = by_break ? NULL : &desk.trigger,
                                            .uart = by_break ? &desk.uart : NULL};
    assert_int_equal(fathom_a16_pwm_init(&desk.pwm, &config), FATHOM_READY);
    desk.sensor = fathom_a16_pwm_sensor(&desk.pwm);
}

static void begin_controlled(bool by_break)
{
    const fathom_a16_controlled_config_t config = {.line = &desk.line,
                                                   .trigger = by_break ? NULL : &desk.trigger};
    assert_int_equal(fathom_a16_controlled_init(&desk.controlled, &config), FATHOM_READY);
    desk.sensor = fathom_a16_controlled_sensor(&desk.controlled);
}

static void poll(void)
{
    fathom_sample_t sample;
    const fathom_status_t status = fathom_poll(&desk.sensor, &sample);
    if (status == FATHOM_READY) {
        desk.last = sample;
        assert_int_equal(sample.sequence, ++desk.samples);
    } else if (status == FATHOM_ERR_NO_ANSWER) {
        desk.no_answers++;
    } else if (status != FATHOM_PENDING) {
        desk.errors++;
    }
}

static void run(uint32_t for_us)
{
    for (uint32_t passed_us = 0; passed_us < for_us; passed_us += desk.step_us) {
        fathom_sim_clock_advance(&desk.sim_clock, desk.step_us);
        poll();
    }
}

#define DEFAULTS ((fathom_sim_a16_config_t){0})

/* ---- PWM ---- */

/* By hand, T2 = 3..94 ms (A16 1(3)), mm = T * 4 / 23. */
static const struct {
    int32_t scene;
    uint32_t width_us;
    uint8_t kind;
    uint16_t mm;
} readings[] = {
    {0x00FF, 3000, FATHOM_TARGET, 522}, /* in the blind zone */
    {522, 3002, FATHOM_TARGET, 522},    /* 522.1 */
    {1739, 9999, FATHOM_TARGET, 1739},
    {15000, 86250, FATHOM_TARGET, 15000},
    {15999, 91994, FATHOM_TARGET, 15999},
    {16001, 92006, FATHOM_NO_TARGET, 0},
    {FATHOM_SIM_NO_TARGET, 94000, FATHOM_NO_TARGET, 0},
    {FATHOM_SIM_INTERFERENCE, 94000, FATHOM_NO_TARGET, 0},
};

static void every_width_is_read_each_cycle(bool by_break)
{
    for (size_t i = 0; i < sizeof readings / sizeof *readings; i++) {
        for (size_t s = 0; s < STEPS; s++) {
            set(FATHOM_SIM_A16_PWM, readings[i].scene, steps_us[s], DEFAULTS);
            begin_pwm(by_break);
            run(3000 * MS);
            assert_true(desk.samples >= 3000 / (221 + 2 * 70) - 1);
            assert_int_equal(desk.last.kind, readings[i].kind);
            assert_int_equal(desk.last.raw, readings[i].width_us);
            assert_int_equal(desk.last.distance_mm, readings[i].mm);
            assert_int_equal(desk.no_answers + desk.errors, 0);
            assert_int_equal(desk.a16.device.counters.unserved, 0); /* no trigger came too early */
            assert_in_range(desk.a16.device.counters.answered, desk.samples, desk.samples + 1);
        }
    }
}

static const suite_t suite = {BENCH_ROUNDS};

TEST(pwm_by_a_pin_reads_every_width_each_cycle) { every_width_is_read_each_cycle(false); }

TEST(pwm_by_a_break_reads_every_width_each_cycle) { every_width_is_read_each_cycle(true); }

static void on_edge(void *ctx, bool high, uint32_t time_us)
{
    (void)ctx;
    fathom_edges_feed(&desk.edges, high, time_us);
}

static void on_edge_twice(void *ctx, bool high, uint32_t time_us)
{
    on_edge(ctx, high, time_us);
    on_edge(ctx, high, time_us + 40);
}

TEST(edges_of_a_pin_interrupt_read_as_a_capture_does_also_doubled)
{
    for (size_t i = 0; i < 2 * STEPS; i++) {
        set(FATHOM_SIM_A16_PWM, 15000, steps_us[i % STEPS], DEFAULTS);
        fathom_edges_init(&desk.edges, &desk.level);
        desk.capture = fathom_edges_capture(&desk.edges);
        desk.pins.on_edge = i < STEPS ? on_edge : on_edge_twice;
        begin_pwm(false);
        run(3000 * MS);
        assert_true(desk.samples >= 7);
        assert_int_equal(desk.last.raw, 86250);
        assert_int_equal(desk.no_answers + desk.errors, 0);
        fathom_sim_tx_wire(&desk.pins, FATHOM_SIM_WIRE_HIGH);
        run(1000 * MS);
        assert_int_equal(desk.last.kind, FATHOM_FAULT);
    }
}

TEST(a_cut_wire_is_no_answer_and_a_mended_one_is_read_again)
{
    for (size_t s = 0; s < STEPS; s++) {
        set(FATHOM_SIM_A16_PWM, 1739, steps_us[s], DEFAULTS);
        begin_pwm(false);
        fathom_sim_tx_wire(&desk.pins, FATHOM_SIM_WIRE_LOW);
        run(2000 * MS);
        assert_int_equal(desk.samples, 0);
        assert_true(desk.no_answers >= 5);
        fathom_sim_tx_wire(&desk.pins, FATHOM_SIM_WIRE_WHOLE);
        run(600 * MS);
        const unsigned no_answers = desk.no_answers;
        run(1000 * MS);
        assert_int_equal(desk.no_answers, no_answers);
        assert_int_equal(desk.last.distance_mm, 1739);
    }
}

TEST(a_stuck_wire_is_a_fault_each_cycle_and_never_a_distance)
{
    for (size_t s = 0; s < STEPS; s++) {
        set(FATHOM_SIM_A16_PWM, 1739, steps_us[s], DEFAULTS);
        begin_pwm(false);
        fathom_sim_tx_wire(&desk.pins, FATHOM_SIM_WIRE_HIGH);
        for (unsigned i = 0; i < 5; i++) {
            const unsigned samples = desk.samples;
            run(400 * MS);
            assert_true(desk.samples > samples);
            assert_int_equal(desk.last.kind, FATHOM_FAULT);
            assert_int_equal(desk.last.raw, 0);
        }
        assert_int_equal(desk.no_answers, 0);
    }
}

TEST(noise_between_trigger_and_pulse_changes_no_reading)
{
    set(FATHOM_SIM_A16_PWM, 1739, 500, DEFAULTS);
    begin_pwm(false);
    for (unsigned cycle = 0; cycle < 10; cycle++) {
        const uint32_t falls = desk.a16.device.counters.requests;
        while (desk.a16.device.counters.requests == falls) run(500);
        for (uint32_t noise_us = 500; noise_us <= 2500; noise_us += 500) {
            run(10 * MS);
            fathom_sim_tx_wire(&desk.pins, FATHOM_SIM_WIRE_HIGH);
            run(noise_us);
            fathom_sim_tx_wire(&desk.pins, FATHOM_SIM_WIRE_WHOLE);
        }
        run(100 * MS);
        assert_int_equal(desk.samples, cycle + 1);
        assert_int_equal(desk.last.raw, 9999);
    }
    assert_int_equal(desk.pwm.meter.noises, 50);
    assert_int_equal(desk.no_answers + desk.errors, 0);
}

TEST(a_module_without_power_is_no_answer)
{
    set(FATHOM_SIM_A16_PWM, 1739, 20000, (fathom_sim_a16_config_t){.start_us = 1500 * MS});
    begin_pwm(false);
    run(1400 * MS);
    assert_int_equal(desk.samples, 0);
    assert_true(desk.no_answers >= 4);
    run(1000 * MS);
    assert_true(desk.samples >= 2);
}

TEST(who_sleeps_until_it_is_due_or_woken_reads_each_cycle)
{
    set(FATHOM_SIM_A16_PWM, 1739, 500, DEFAULTS);
    begin_pwm(false);
    const uint32_t start_us = desk.sim_clock.now_us;
    for (unsigned polls = 0; desk.samples < 20; polls++) {
        assert_true(polls < 20 * 8);
        fathom_sim_clock_idle(&desk.sim_clock, fathom_due_us(&desk.sensor, 1));
        poll();
    }
    assert_int_equal(desk.no_answers, 0);
    /* 2 ms, 19 cycles of 221 ms, 110 ms and the pulse */
    assert_in_range(fathom_elapsed_us(desk.sim_clock.now_us, start_us), 4320999, 4321100);
}

/* ---- controlled ---- */

static void controlled_reads_each_trigger(bool by_break, bool knows)
{
    for (size_t s = 0; s < STEPS; s++) {
        set(FATHOM_SIM_A16_CONTROLLED, 1953, steps_us[s], DEFAULTS);
        if (!knows) desk.sim_uart.knows = 0;
        begin_controlled(by_break);
        run(5000 * MS);
        assert_true(desk.samples >= 5000 / (121 + 3 * 70) - 1);
        assert_int_equal(desk.last.distance_mm, 1953);
        assert_int_equal(desk.no_answers + desk.errors, 0);
        assert_int_equal(desk.controlled.late, 0);
        assert_int_equal(desk.a16.device.counters.unserved, 0);
        assert_in_range(desk.a16.device.counters.answered, desk.samples, desk.samples + 1);
    }
}

TEST(controlled_by_a_break_reads_each_trigger)
{
    controlled_reads_each_trigger(true, true);
    controlled_reads_each_trigger(true, false); /* a port that knows nothing */
}

TEST(controlled_by_a_pin_reads_each_trigger)
{
    controlled_reads_each_trigger(false, true);
    controlled_reads_each_trigger(false, false);
}

static const uint32_t *delays_us;

static void delay(void *ctx, fathom_sim_frame_t *frame)
{
    (void)ctx;
    frame->delay_us = *delays_us;
}

TEST(late_and_lost_answers_are_no_answer_and_never_the_next_ones)
{
    static const uint32_t late_us[] = {45 * MS, 60 * MS, 85 * MS};
    static const fathom_sim_faults_t faults = {.outgoing = delay};
    for (size_t i = 0; i < 3; i++) {
        delays_us = &late_us[i];
        set(FATHOM_SIM_A16_CONTROLLED, 1953, 500, (fathom_sim_a16_config_t){.faults = &faults});
        begin_controlled(true);
        run(2000 * MS);
        assert_int_equal(desk.samples, 0);
        assert_true(desk.no_answers >= 10);
        assert_in_range(desk.controlled.late, desk.no_answers - 2, desk.no_answers + 1);
    }
}

/* ---- automatic, with its select ---- */

static void the_select_of_the_automatic_mode_reaches_the_module(bool by_break)
{
    fathom_sim_fixed_t processed = {{1000}};
    set(FATHOM_SIM_A16_UART, 2000, 20000,
        (fathom_sim_a16_config_t){.processed = fathom_sim_fixed(&processed)});
    const fathom_a16_auto_config_t config = {.line = &desk.line, .select = by_break ? NULL : &desk.trigger};
    assert_int_equal(fathom_a16_auto_init(&desk.automatic, &config), FATHOM_READY);
    desk.sensor = fathom_a16_auto_sensor(&desk.automatic);
    run(1000 * MS);
    assert_int_equal(desk.last.distance_mm, 1000);
    assert_int_equal(fathom_a16_auto_select(&desk.automatic, true), FATHOM_READY);
    run(300 * MS);
    assert_int_equal(desk.last.distance_mm, 2000);
    assert_int_equal(fathom_a16_auto_select(&desk.automatic, false), FATHOM_READY);
    run(300 * MS);
    assert_int_equal(desk.last.distance_mm, 1000);
    assert_int_equal(desk.errors, 0);
}

TEST(the_select_works_by_a_pin_and_by_a_break)
{
    the_select_of_the_automatic_mode_reaches_the_module(false);
    the_select_of_the_automatic_mode_reaches_the_module(true);
}
