/* SPDX-License-Identifier: MIT */
#include "bench.h"

#include <string.h>

#include "fathom/fathom.h"
#include "sim/a05.h"
#include "sim/a16.h"
#include "sim/fault.h"
#include "sim/scene.h"
#include "sim/uart.h"

/* Addresses are set through the drivers, on simulated lines, in a loop that sleeps as long as it may and in one that
 * comes round every 20 ms. */

enum { MS = 1000, SECOND = 1000000, A16 = 0, A05 = 1, A05_DYP = 2, MODELS = 3 };

typedef struct {
    fathom_sim_clock_t clock;
    fathom_sim_line_t wire;
    fathom_sim_uart_t port;
    fathom_sim_fixed_t fixed;
    fathom_sim_a16_t a16[2];
    fathom_sim_a05_t a05[2];
    fathom_sim_fault_t fault; /* of the first device */
    fathom_uart_t uart;
    fathom_clock_t hal_clock;
    fathom_line_config_t config;
    fathom_line_t line;
    fathom_modbus_t modbus;
    uint8_t frame[32];
    union {
        fathom_a16_modbus_t a16;
        fathom_a05_modbus_t a05;
        fathom_a05_dyp_t a05_dyp;
    } driver;
    uint8_t model;
    uint32_t loop_us; /* 0: it sleeps as long as it may */
} stage_t;

static fathom_sim_device_t *device_of(stage_t *s, unsigned which)
{
    return s->model == A16 ? &s->a16[which].device : &s->a05[which].device;
}

static void add_device(stage_t *s, unsigned which, uint8_t unit)
{
    const fathom_sim_scene_t scene = fathom_sim_fixed(&s->fixed);
    const fathom_sim_a16_config_t a16 = {.mode = FATHOM_SIM_A16_MODBUS, .unit = unit, .scene = scene};
    const fathom_sim_a05_config_t a05 = {
        .mode = s->model == A05 ? FATHOM_SIM_A05_MODBUS : FATHOM_SIM_A05_DYP, .unit = unit, .scene = scene};
    if (s->model == A16)
        fathom_sim_a16_init(&s->a16[which], &a16);
    else
        fathom_sim_a05_init(&s->a05[which], &a05);
    if (which == 0) {
        fathom_sim_fault_init(&s->fault, 1);
        fathom_sim_fault_attach(&s->fault, &s->wire, device_of(s, 0));
    }
    fathom_sim_attach(&s->wire, device_of(s, which), s->clock.now_us);
}

static void set_up(stage_t *s, uint8_t model, uint32_t loop_us)
{
    memset(s, 0, sizeof *s);
    s->model = model;
    s->loop_us = loop_us;
    s->fixed = (fathom_sim_fixed_t){{1000, 2000, 1953, 3562}};
    fathom_sim_clock_init(&s->clock, bench_start_us, 0);
    fathom_sim_line_init(&s->wire, &bench_9600, bench_start_us);
    fathom_sim_uart_init(&s->port, &s->wire, &s->clock);
    s->uart = fathom_sim_uart(&s->port);
    s->hal_clock = fathom_sim_clock(&s->clock);
    s->config = (fathom_line_config_t){
        .uart = &s->uart, .clock = &s->hal_clock, .frame = s->frame, .frame_size = sizeof s->frame};
    assert_int_equal(fathom_line_init(&s->line, &s->config), FATHOM_READY);
    s->modbus = fathom_modbus_client(&s->line);
    const fathom_a16_modbus_config_t a16 = {.modbus = &s->modbus, .clock = &s->hal_clock};
    const fathom_a05_modbus_config_t a05 = {.modbus = &s->modbus, .clock = &s->hal_clock};
    const fathom_a05_dyp_config_t a05_dyp = {.line = &s->line};
    fathom_status_t status = FATHOM_READY;
    if (model == A16)
        status = fathom_a16_modbus_init(&s->driver.a16, &a16);
    else if (model == A05)
        status = fathom_a05_modbus_init(&s->driver.a05, &a05);
    else
        status = fathom_a05_dyp_init(&s->driver.a05_dyp, &a05_dyp);
    assert_int_equal(status, FATHOM_READY);
    add_device(s, 0, 1);
}

static void pass(stage_t *s, uint32_t due_us)
{
    if (s->loop_us != 0)
        fathom_sim_clock_advance(&s->clock, s->loop_us);
    else
        fathom_sim_clock_idle(&s->clock, due_us);
}

static fathom_sensor_t sensor_of(stage_t *s)
{
    if (s->model == A16) return fathom_a16_modbus_sensor(&s->driver.a16);
    if (s->model == A05) return fathom_a05_modbus_sensor(&s->driver.a05);
    return fathom_a05_dyp_sensor(&s->driver.a05_dyp);
}

static fathom_status_t set_address_once(stage_t *s, uint8_t address)
{
    if (s->model == A16) return fathom_a16_set_address(&s->driver.a16, address);
    if (s->model == A05) return fathom_a05_modbus_set_address(&s->driver.a05, address);
    return fathom_a05_dyp_set_every_address(&s->driver.a05_dyp, address);
}

/* The measurement is polled in the same loop, as an application does. */
static fathom_status_t set_address(stage_t *s, uint8_t address)
{
    const uint32_t start_us = s->clock.now_us;
    for (;;) {
        const fathom_sensor_t sensor = sensor_of(s);
        fathom_sample_t sample;
        const fathom_status_t status = set_address_once(s, address);
        if (status != FATHOM_PENDING) return status;
        assert_true(fathom_poll(&sensor, &sample) >= 0); /* samples of an answer from before may be left */
        assert_true(fathom_elapsed_us(s->clock.now_us, start_us) < 20 * SECOND);
        pass(s, fathom_due_us(&sensor, 1));
    }
}

static fathom_status_t read_once(stage_t *s, fathom_sample_t *sample)
{
    const fathom_sensor_t sensor = sensor_of(s);
    for (;;) {
        const fathom_status_t status = fathom_poll(&sensor, sample);
        if (status != FATHOM_PENDING) return status;
        pass(s, fathom_due_us(&sensor, 1));
    }
}

/* Every model, in either loop. */
static void for_all(void (*test)(uint8_t model, uint32_t loop_us))
{
    for (uint8_t model = 0; model != MODELS; model++) {
        test(model, 0);
        test(model, 20 * MS);
    }
}

static void follow(uint8_t model, uint32_t loop_us)
{
    stage_t s;
    fathom_sample_t sample;
    set_up(&s, model, loop_us);
    assert_int_equal(set_address(&s, 5), FATHOM_READY);
    assert_int_equal(device_of(&s, 0)->unit, 5);
    assert_int_equal(device_of(&s, 0)->counters.writes, 1);
    assert_int_equal(read_once(&s, &sample), FATHOM_READY);
    assert_int_equal(sample.unit, 5);
    assert_int_equal(sample.distance_mm, 1000);
    assert_int_equal(set_address(&s, 5), FATHOM_READY); /* and once more: it is so already */
    assert_int_equal(device_of(&s, 0)->counters.writes, 1);
}

static const suite_t suite = {BENCH_ROUNDS};

TEST(an_address_that_is_set_is_followed_and_not_set_twice) { for_all(follow); }

static void in_use(uint8_t model, uint32_t loop_us)
{
    stage_t s;
    set_up(&s, model, loop_us);
    add_device(&s, 1, 5);
    assert_int_equal(set_address(&s, 5), FATHOM_ERR_IN_USE);
    assert_int_equal(device_of(&s, 0)->unit, 1);
    assert_int_equal(device_of(&s, 0)->counters.writes + device_of(&s, 1)->counters.writes, 0);
}

TEST(an_address_at_which_another_answers_is_not_given) { for_all(in_use); }

static void lost_confirmation(uint8_t model, uint32_t loop_us)
{
    /* its first frame answers the first look; from the second on, the acknowledgement, nothing comes */
    stage_t s;
    fathom_sample_t sample;
    set_up(&s, model, loop_us);
    fathom_sim_fault_rule_t *const rule =
        fathom_sim_fault_add(&s.fault, FATHOM_SIM_FAULT_SILENCE, FATHOM_SIM_FAULT_ALWAYS_PPM, 2);
    assert_non_null(rule);
    rule->run = 1000;
    assert_int_equal(set_address(&s, 5), FATHOM_ERR_UNCONFIRMED);
    assert_int_equal(device_of(&s, 0)->unit, 5);
    assert_int_equal(device_of(&s, 0)->counters.writes, 1);
    assert_int_equal(read_once(&s, &sample), FATHOM_ERR_NO_ANSWER); /* the driver is where it was */
}

TEST(without_confirmation_it_is_at_one_of_the_two) { for_all(lost_confirmation); }

static void lost_acknowledgement(uint8_t model, uint32_t loop_us)
{
    stage_t s;
    set_up(&s, model, loop_us);
    assert_non_null(fathom_sim_fault_add(&s.fault, FATHOM_SIM_FAULT_SILENCE, FATHOM_SIM_FAULT_ALWAYS_PPM, 2));
    assert_int_equal(set_address(&s, 5), FATHOM_READY);
    assert_int_equal(device_of(&s, 0)->counters.writes, 1); /* it is not written again */
}

TEST(a_lost_acknowledgement_does_not_matter_if_the_reading_confirms) { for_all(lost_acknowledgement); }

static void nobody(uint8_t model, uint32_t loop_us)
{
    for (unsigned echo = 0; echo != 2; echo++) {
        stage_t s;
        set_up(&s, model, loop_us);
        s.wire.echo = echo != 0;
        fathom_sim_detach(&s.wire, device_of(&s, 0), s.clock.now_us);
        assert_int_equal(set_address(&s, 5), FATHOM_ERR_NO_ANSWER);
    }
}

TEST(a_dead_device_does_not_look_like_success_where_the_line_echoes) { for_all(nobody); }

static void follow_with_echo(uint8_t model, uint32_t loop_us)
{
    stage_t s;
    set_up(&s, model, loop_us);
    s.wire.echo = true;
    assert_int_equal(set_address(&s, 5), FATHOM_READY);
    assert_int_equal(device_of(&s, 0)->unit, 5);
}

TEST(it_works_where_the_line_echoes) { for_all(follow_with_echo); }

/* ---- the hazard of 55 AA 03 ---- */

TEST(every_a05_takes_the_address_of_55_aa_03_and_one_that_of_modbus)
{
    stage_t s;
    set_up(&s, A05_DYP, 0);
    add_device(&s, 1, 9);
    (void)set_address(&s, 5); /* what it reads from two devices at once is anybody's guess */
    assert_int_equal(s.a05[0].device.unit, 5);
    assert_int_equal(s.a05[1].device.unit, 5);

    set_up(&s, A05, 0);
    add_device(&s, 1, 9);
    assert_int_equal(set_address(&s, 5), FATHOM_READY);
    assert_int_equal(s.a05[0].device.unit, 5);
    assert_int_equal(s.a05[1].device.unit, 9);
}

/* ---- requests of others ---- */

TEST(what_waits_for_the_old_address_is_cancelled)
{
    stage_t s;
    uint16_t value = 0;
    fathom_modbus_request_t request = {.exchange = {.timeout_us = 100 * MS}};
    fathom_modbus_request_t other = {.exchange = {.timeout_us = 100 * MS}};
    set_up(&s, A16, 0);
    fathom_modbus_read_holding_registers(&request.message, 1, 0x0101, 1, &value);
    fathom_modbus_read_holding_registers(&other.message, 9, 0x0101, 1, &value);
    /* Submitted in mid-write: behind it in the queue. */
    const uint32_t start_us = s.clock.now_us;
    while (device_of(&s, 0)->counters.writes == 0) {
        const fathom_sensor_t sensor = sensor_of(&s);
        assert_int_equal(set_address_once(&s, 5), FATHOM_PENDING);
        assert_true(fathom_elapsed_us(s.clock.now_us, start_us) < 20 * SECOND);
        pass(&s, fathom_due_us(&sensor, 1));
    }
    assert_int_equal(fathom_modbus_client_submit(&s.line, &request), FATHOM_PENDING);
    assert_int_equal(fathom_modbus_client_submit(&s.line, &other), FATHOM_PENDING);
    assert_int_equal(set_address(&s, 5), FATHOM_READY);
    assert_int_equal(request.exchange.status, FATHOM_ERR_CANCELLED);
    assert_int_equal(request.exchange.attempts, 0);
    assert_int_equal(other.exchange.status, FATHOM_ERR_NO_ANSWER);
}

TEST(what_is_given_up_leaves_driver_and_device_at_the_old_address_or_unknown)
{
    stage_t s;
    fathom_sample_t sample;
    uint8_t address = 0;
    set_up(&s, A05, 0);
    assert_int_equal(fathom_a05_modbus_set_address(&s.driver.a05, 5), FATHOM_PENDING);
    fathom_a05_modbus_cancel(&s.driver.a05);
    assert_int_equal(read_once(&s, &sample), FATHOM_READY);
    assert_int_equal(sample.unit, 1);
    fathom_status_t status;
    while ((status = fathom_a05_modbus_address(&s.driver.a05, &address)) == FATHOM_PENDING) pass(&s, 1000);
    assert_int_equal(status, FATHOM_READY);
    assert_int_equal(address, 1);

    set_up(&s, A05_DYP, 0);
    assert_int_equal(fathom_a05_dyp_set_every_address(&s.driver.a05_dyp, 5), FATHOM_PENDING);
    fathom_a05_dyp_cancel(&s.driver.a05_dyp);
    assert_int_equal(read_once(&s, &sample), FATHOM_READY);
    assert_int_equal(sample.unit, 1);
}

TEST(addresses_of_everybody_are_refused)
{
    for (uint8_t model = 0; model != MODELS; model++) {
        stage_t s;
        set_up(&s, model, 0);
        assert_int_equal(set_address_once(&s, 0), FATHOM_ERR_ARGUMENT);
        assert_int_equal(set_address_once(&s, 255), FATHOM_ERR_ARGUMENT);
        assert_null(s.line.head);
    }
}

TEST(after_power_on_an_a05_that_is_silent_warms_up)
{
    for (uint8_t model = A05; model != MODELS; model++) {
        stage_t s;
        fathom_sample_t sample;
        set_up(&s, model, 0);
        fathom_sim_detach(&s.wire, device_of(&s, 0), s.clock.now_us);
        if (model == A05)
            fathom_a05_modbus_power_on(&s.driver.a05);
        else
            fathom_a05_dyp_power_on(&s.driver.a05_dyp);
        const uint32_t start_us = s.clock.now_us;
        while (read_once(&s, &sample) == FATHOM_ERR_WARMING_UP) continue;
        ASSERT_SPAN(s.clock.now_us, start_us, 1500 * MS, 2500 * MS);
        assert_int_equal(read_once(&s, &sample), FATHOM_ERR_NO_ANSWER);
    }
}
