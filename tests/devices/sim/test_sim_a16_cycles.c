/* SPDX-License-Identifier: MIT */
#include "fathom/engine/edges.h"
#include "stage.h"

/* Whole cycles: the drivers on the simulated pins, at each start of the clock, in a fine and in slow loops. */

static const uint32_t steps_us[] = {500, 20000, 70000};
enum { STEPS = sizeof steps_us / sizeof steps_us[0] };

static fathom_pin_t trigger;
static fathom_capture_t capture;
static fathom_a16_pwm_t pwm;
static fathom_a16_controlled_t controlled;
static fathom_sample_t last;
static unsigned samples, no_responses;
static unsigned errors; /* others */

static void set(uint8_t mode, int32_t distance, uint32_t step_us, a16_config_t config)
{
    stage_begin(&bench_9600, true, step_us);
    bench.fixed = FIXED(distance);
    add_a16(mode, config);
    fathom_sim_pins_init(&s.pins, bench.device, &bench.line, &s.clock);
    trigger = fathom_sim_rx_pin(&s.pins);
    capture = fathom_sim_capture(&s.pins);
    samples = no_responses = errors = 0;
}

static void begin_pwm(bool by_break)
{
    const fathom_output_t edge = by_break ? fathom_output_break(&s.uart) : fathom_output_pin(&trigger);
    assert_int_equal(fathom_a16_pwm_init(&pwm, &capture, &s.hal_clock, &edge, NULL), FATHOM_OK);
    s.sensor = fathom_a16_pwm_sensor(&pwm);
}

static fathom_output_t output(bool by_break)
{
    return by_break ? fathom_output_line_break(&s.line) : fathom_output_pin(&trigger);
}

static void begin_controlled(bool by_break)
{
    const fathom_output_t edge = output(by_break);
    assert_int_equal(fathom_a16_controlled_init(&controlled, &s.line, &edge, NULL), FATHOM_OK);
    s.sensor = fathom_a16_controlled_sensor(&controlled);
}

static void poll(void)
{
    const fathom_status_t status = fathom_poll(&s.sensor, &s.sample);
    if (status == FATHOM_OK) {
        last = s.sample;
        assert_int_equal(last.sequence, ++samples);
    } else if (status == FATHOM_ERR_NO_RESPONSE) {
        no_responses++;
    } else if (status != FATHOM_PENDING) {
        errors++;
    }
}

static void run(uint32_t for_us)
{
    for (uint32_t passed_us = 0; passed_us < for_us; passed_us += s.loop_us) {
        pass_us(s.loop_us);
        poll();
    }
}

#define DEFAULTS ((a16_config_t){0})

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
        for (size_t n = 0; n < STEPS; n++) {
            set(FATHOM_SIM_A16_PWM, readings[i].scene, steps_us[n], DEFAULTS);
            begin_pwm(by_break);
            run(3000 * MS);
            assert_true(samples >= 3000 / (221 + 2 * 70) - 1);
            assert_int_equal(last.kind, readings[i].kind);
            assert_int_equal(last.raw, readings[i].width_us);
            assert_int_equal(last.distance_mm, readings[i].mm);
            assert_int_equal(no_responses + errors, 0);
            COUNTED(.unserved = NONE); /* no trigger came too early */
            assert_in_range(bench.device->counters.answered, samples, samples + 1);
        }
    }
}

static const suite_t suite = {BENCH_ROUNDS};

TEST(pwm_by_a_pin_reads_every_width_each_cycle) { every_width_is_read_each_cycle(false); }

TEST(pwm_by_a_break_reads_every_width_each_cycle) { every_width_is_read_each_cycle(true); }

static fathom_edges_t edges;

static void on_edge(void *ctx, bool high, uint32_t time_us) { fathom_edges_feed(&edges, high, time_us); }

static void on_edge_twice(void *ctx, bool high, uint32_t time_us)
{
    on_edge(ctx, high, time_us);
    on_edge(ctx, high, time_us + 40);
}

TEST(edges_of_a_pin_interrupt_read_as_a_capture_does_also_doubled)
{
    for (size_t i = 0; i < 2 * STEPS; i++) {
        set(FATHOM_SIM_A16_PWM, 15000, steps_us[i % STEPS], DEFAULTS);
        const fathom_pin_t level = fathom_sim_tx_pin(&s.pins);
        fathom_edges_init(&edges, &level);
        capture = fathom_edges_capture(&edges);
        s.pins.on_edge = i < STEPS ? on_edge : on_edge_twice;
        begin_pwm(false);
        run(3000 * MS);
        assert_true(samples >= 7);
        assert_int_equal(last.raw, 86250);
        assert_int_equal(no_responses + errors, 0);
        fathom_sim_tx_wire(&s.pins, FATHOM_SIM_WIRE_HIGH);
        run(1000 * MS);
        assert_int_equal(last.kind, FATHOM_FAULT);
    }
}

TEST(a_cut_wire_is_no_response_and_a_mended_one_is_read_again)
{
    for (size_t n = 0; n < STEPS; n++) {
        set(FATHOM_SIM_A16_PWM, 1739, steps_us[n], DEFAULTS);
        begin_pwm(false);
        fathom_sim_tx_wire(&s.pins, FATHOM_SIM_WIRE_LOW);
        run(2000 * MS);
        assert_int_equal(samples, 0);
        assert_true(no_responses >= 5);
        fathom_sim_tx_wire(&s.pins, FATHOM_SIM_WIRE_WHOLE);
        run(600 * MS);
        const unsigned before = no_responses;
        run(1000 * MS);
        assert_int_equal(no_responses, before);
        assert_int_equal(last.distance_mm, 1739);
    }
}

TEST(a_stuck_wire_is_a_fault_each_cycle_and_never_a_distance)
{
    for (size_t n = 0; n < STEPS; n++) {
        set(FATHOM_SIM_A16_PWM, 1739, steps_us[n], DEFAULTS);
        begin_pwm(false);
        fathom_sim_tx_wire(&s.pins, FATHOM_SIM_WIRE_HIGH);
        for (unsigned i = 0; i < 5; i++) {
            const unsigned before = samples;
            run(400 * MS);
            assert_true(samples > before);
            assert_int_equal(last.kind, FATHOM_FAULT);
            assert_int_equal(last.raw, 0);
        }
        assert_int_equal(no_responses, 0);
    }
}

TEST(noise_between_trigger_and_pulse_changes_no_reading)
{
    set(FATHOM_SIM_A16_PWM, 1739, 500, DEFAULTS);
    begin_pwm(false);
    for (unsigned cycle = 0; cycle < 10; cycle++) {
        const uint32_t falls = bench.device->counters.requests;
        while (bench.device->counters.requests == falls) run(500);
        for (uint32_t noise_us = 500; noise_us <= 2500; noise_us += 500) {
            run(10 * MS);
            fathom_sim_tx_wire(&s.pins, FATHOM_SIM_WIRE_HIGH);
            run(noise_us);
            fathom_sim_tx_wire(&s.pins, FATHOM_SIM_WIRE_WHOLE);
        }
        run(100 * MS);
        assert_int_equal(samples, cycle + 1);
        assert_int_equal(last.raw, 9999);
    }
    assert_int_equal(pwm.meter.noises, 50);
    assert_int_equal(no_responses + errors, 0);
}

TEST(a_module_without_power_is_no_response)
{
    set(FATHOM_SIM_A16_PWM, 1739, 20000, (a16_config_t){.start_us = 1500 * MS});
    begin_pwm(false);
    run(1400 * MS);
    assert_int_equal(samples, 0);
    assert_true(no_responses >= 4);
    run(1000 * MS);
    assert_true(samples >= 2);
}

TEST(who_sleeps_until_it_is_due_or_woken_reads_each_cycle)
{
    set(FATHOM_SIM_A16_PWM, 1739, 500, DEFAULTS);
    begin_pwm(false);
    const uint32_t start_us = s.clock.now_us;
    for (unsigned polls = 0; samples < 20; polls++) {
        assert_true(polls < 20 * 8);
        fathom_sim_clock_idle(&s.clock, fathom_due_us(&s.sensor, 1));
        poll();
    }
    assert_int_equal(no_responses, 0);
    /* 2 ms, 19 cycles of 221 ms, 110 ms and the pulse */
    assert_in_range(since_us(start_us), 4320999, 4321100);
}

static void controlled_reads_each_trigger(bool by_break, bool knows)
{
    for (size_t n = 0; n < STEPS; n++) {
        set(FATHOM_SIM_A16_CONTROLLED, 1953, steps_us[n], DEFAULTS);
        if (!knows) s.port.knows = 0;
        begin_controlled(by_break);
        run(5000 * MS);
        assert_true(samples >= 5000 / (121 + 3 * 70) - 1);
        assert_int_equal(last.distance_mm, 1953);
        assert_int_equal(no_responses + errors, 0);
        assert_int_equal(controlled.late, 0);
        COUNTED(.unserved = NONE);
        assert_in_range(bench.device->counters.answered, samples, samples + 1);
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

static void delay(void *ctx, fathom_sim_frame_t *frame) { frame->delay_us = *delays_us; }

TEST(late_and_lost_responses_are_no_response_and_never_the_next_ones)
{
    static const uint32_t late_us[] = {45 * MS, 60 * MS, 85 * MS};
    static const fathom_sim_faults_t faults = {.outgoing = delay};
    for (size_t i = 0; i < 3; i++) {
        delays_us = &late_us[i];
        set(FATHOM_SIM_A16_CONTROLLED, 1953, 500, (a16_config_t){.faults = &faults});
        begin_controlled(true);
        run(2000 * MS);
        assert_int_equal(samples, 0);
        assert_true(no_responses >= 10);
        assert_in_range(controlled.late, no_responses - 2, no_responses + 1);
    }
}

static void the_select_of_the_automatic_mode_reaches_the_module(bool by_break)
{
    fathom_a16_auto_t automatic;
    bench.processed = FIXED(1000);
    set(FATHOM_SIM_A16_UART, 2000, 20000, (a16_config_t){.processed = PROCESSED});
    const fathom_a16_auto_config_t config = {.select = output(by_break)};
    assert_int_equal(fathom_a16_auto_init(&automatic, &s.line, &config), FATHOM_OK);
    s.sensor = fathom_a16_auto_sensor(&automatic);
    run(1000 * MS);
    assert_int_equal(last.distance_mm, 1000);
    assert_int_equal(fathom_a16_auto_select(&automatic, true), FATHOM_OK);
    run(300 * MS);
    assert_int_equal(last.distance_mm, 2000);
    assert_int_equal(fathom_a16_auto_select(&automatic, false), FATHOM_OK);
    run(300 * MS);
    assert_int_equal(last.distance_mm, 1000);
    assert_int_equal(errors, 0);
}

TEST(the_select_works_by_a_pin_and_by_a_break)
{
    the_select_of_the_automatic_mode_reaches_the_module(false);
    the_select_of_the_automatic_mode_reaches_the_module(true);
}
