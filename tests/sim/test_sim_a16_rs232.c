/* SPDX-License-Identifier: MIT */
#include "bench.h"

#include <string.h>

#include "fathom/fathom.h"
#include "sim/a16.h"
#include "sim/fault.h"
#include "sim/scene.h"
#include "sim/uart.h"

/* An A16 with RS232 output (A16 5): from automatic output to Modbus and back. */

enum { MS = 1000, SECOND = 1000000 };

typedef struct {
    fathom_sim_clock_t clock;
    fathom_sim_line_t wire;
    fathom_sim_uart_t port;
    fathom_sim_fixed_t fixed;
    fathom_sim_a16_t a16;
    fathom_sim_fault_t fault;
    fathom_uart_t inner;
    fathom_uart_t uart;
    bool is_broken;
    fathom_clock_t hal_clock;
    fathom_line_config_t config;
    fathom_line_t line;
    fathom_modbus_t modbus;
    uint8_t frame[32];
    fathom_a16_auto_t automatic;
    fathom_a16_modbus_t asked;
    fathom_a16_rs232_t rs232;
    uint32_t loop_us; /* 0: it sleeps as long as it may */
} stage_t;

static int read_port(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    stage_t *const s = ctx;
    return s->is_broken ? -1 : s->inner.read(s->inner.ctx, bytes, capacity, rx);
}
static int write_port(void *ctx, const uint8_t *bytes, size_t length)
{
    stage_t *const s = ctx;
    return s->inner.write(s->inner.ctx, bytes, length);
}
static bool port_sent(void *ctx)
{
    stage_t *const s = ctx;
    return s->inner.sent(s->inner.ctx);
}

static void set_up(stage_t *s, uint8_t mode, uint32_t loop_us)
{
    memset(s, 0, sizeof *s);
    s->loop_us = loop_us;
    s->fixed = (fathom_sim_fixed_t){{1953}};
    fathom_sim_clock_init(&s->clock, bench_start_us, 0);
    fathom_sim_line_init(&s->wire, &bench_9600, bench_start_us);
    s->wire.full_duplex = true;
    fathom_sim_uart_init(&s->port, &s->wire, &s->clock);
    s->inner = fathom_sim_uart(&s->port);
    s->uart = (fathom_uart_t){read_port, write_port, port_sent, NULL, NULL, s};
    s->hal_clock = fathom_sim_clock(&s->clock);
    s->config = (fathom_line_config_t){.uart = &s->uart,
                                       .clock = &s->hal_clock,
                                       .frame = s->frame,
                                       .frame_size = sizeof s->frame,
                                       .echo = FATHOM_LINE_ECHO_OFF};
    assert_int_equal(fathom_line_init(&s->line, &s->config), FATHOM_READY);
    s->modbus = fathom_modbus_client(&s->line);
    const fathom_a16_auto_config_t automatic = {.line = &s->line};
    const fathom_a16_modbus_config_t asked = {.modbus = &s->modbus, .clock = &s->hal_clock};
    assert_int_equal(fathom_a16_auto_init(&s->automatic, &automatic), FATHOM_READY);
    assert_int_equal(fathom_a16_modbus_init(&s->asked, &asked), FATHOM_READY);
    fathom_a16_rs232_init(&s->rs232, &s->asked, &s->automatic);
    const fathom_sim_a16_config_t config = {.mode = mode, .scene = fathom_sim_fixed(&s->fixed)};
    fathom_sim_a16_init(&s->a16, &config);
    fathom_sim_fault_init(&s->fault, 1);
    fathom_sim_fault_attach(&s->fault, &s->wire, &s->a16.device);
    fathom_sim_attach(&s->wire, &s->a16.device, s->clock.now_us);
}

static void pass(stage_t *s, uint32_t due_us)
{
    if (s->loop_us != 0)
        fathom_sim_clock_advance(&s->clock, s->loop_us);
    else
        fathom_sim_clock_idle(&s->clock, due_us);
}

static fathom_status_t wait(stage_t *s, fathom_sensor_t sensor, fathom_sample_t *sample)
{
    for (;;) {
        const fathom_status_t status = fathom_poll(&sensor, sample);
        if (status != FATHOM_PENDING) return status;
        pass(s, fathom_due_us(&sensor, 1));
    }
}

static fathom_status_t hear(stage_t *s, fathom_sample_t *sample)
{
    return wait(s, fathom_a16_auto_sensor(&s->automatic), sample);
}

static fathom_status_t ask(stage_t *s, fathom_sample_t *sample)
{
    return wait(s, fathom_a16_modbus_sensor(&s->asked), sample);
}

static fathom_status_t go_back(stage_t *s, fathom_sample_t *sample)
{
    const uint32_t start_us = s->clock.now_us;
    for (;;) {
        const fathom_status_t status = fathom_a16_rs232_return_to_automatic(&s->rs232, sample);
        if (status != FATHOM_PENDING) return status;
        assert_true(fathom_elapsed_us(s->clock.now_us, start_us) < 10 * SECOND);
        pass(s, fathom_a16_rs232_due_us(&s->rs232));
    }
}

static const suite_t suite = {BENCH_ROUNDS};

TEST(the_first_modbus_command_ends_automatic_output_and_0202_brings_it_back)
{
    for (unsigned loop = 0; loop != 2; loop++) {
        stage_t s;
        fathom_sample_t sample;
        set_up(&s, FATHOM_SIM_A16_AUTO, loop * 20 * MS);
        assert_int_equal(hear(&s, &sample), FATHOM_READY);
        assert_int_equal(ask(&s, &sample), FATHOM_READY);
        assert_int_equal(sample.distance_mm, 1953);
        assert_int_equal(sample.unit, 1);
        while (hear(&s, &sample) == FATHOM_READY) continue; /* frames linger around the first answer */
        const uint32_t sent = s.a16.device.counters.automatic;
        assert_int_equal(hear(&s, &sample), FATHOM_ERR_STALE);
        assert_int_equal(s.a16.device.counters.automatic, sent);

        assert_int_equal(go_back(&s, &sample), FATHOM_READY);
        assert_int_equal(sample.unit, 0);
        assert_int_equal(sample.distance_mm, 1953);
        assert_int_equal(s.a16.device.counters.automatic, sent + 1);
        for (unsigned i = 0; i != 10; i++) assert_int_equal(hear(&s, &sample), FATHOM_READY);
    }
}

TEST(a_frame_from_before_the_command_confirms_nothing)
{
    stage_t s;
    fathom_sample_t sample;
    set_up(&s, FATHOM_SIM_A16_AUTO, 0);
    for (unsigned i = 0; i != 300; i++) { /* a frame comes and nobody takes it */
        fathom_sim_clock_advance(&s.clock, 1 * MS);
        (void)fathom_line_poll(&s.line);
    }
    fathom_sim_detach(&s.wire, &s.a16.device, s.clock.now_us);
    assert_int_equal(go_back(&s, &sample), FATHOM_ERR_UNCONFIRMED);
    assert_true(s.automatic.base.stream.counters[FATHOM_STREAM_FRAMES] != 0);
}

TEST(one_that_acknowledges_and_does_not_send_is_found_out_after_two_seconds)
{
    stage_t s;
    fathom_sample_t sample;
    for (unsigned loop = 0; loop != 2; loop++) {
        set_up(&s, FATHOM_SIM_A16_MODBUS, loop * 20 * MS);
        const uint32_t start_us = s.clock.now_us;
        assert_int_equal(go_back(&s, &sample), FATHOM_ERR_UNCONFIRMED);
        ASSERT_SPAN(s.clock.now_us, start_us, 2000 * MS, 3000 * MS);
        assert_int_equal(s.a16.device.counters.answered, 2);
    }
}

TEST(a_refusal_and_a_broken_port_are_told_as_they_are)
{
    stage_t s;
    fathom_sample_t sample;
    set_up(&s, FATHOM_SIM_A16_MODBUS, 0);
    assert_non_null(
        fathom_sim_fault_add(&s.fault, FATHOM_SIM_FAULT_EXCEPTION, FATHOM_SIM_FAULT_ALWAYS_PPM, 2));
    assert_int_equal(go_back(&s, &sample), FATHOM_ERR_EXCEPTION);

    set_up(&s, FATHOM_SIM_A16_MODBUS, 0);
    s.is_broken = true;
    assert_int_equal(go_back(&s, &sample), FATHOM_ERR_PORT);

    set_up(&s, FATHOM_SIM_A16_MODBUS, 0); /* broken while it listens */
    assert_int_equal(ask(&s, &sample), FATHOM_READY);
    while (!s.rs232.is_listening) {
        assert_int_equal(fathom_a16_rs232_return_to_automatic(&s.rs232, &sample), FATHOM_PENDING);
        pass(&s, fathom_a16_rs232_due_us(&s.rs232));
    }
    s.is_broken = true;
    assert_int_equal(go_back(&s, &sample), FATHOM_ERR_PORT);
    assert_false(s.rs232.is_listening);
}

TEST(a_lost_or_damaged_acknowledgement_leaves_it_to_the_frames)
{
    static const uint8_t kinds[] = {FATHOM_SIM_FAULT_FLIP_BIT, FATHOM_SIM_FAULT_TRUNCATE,
                                    FATHOM_SIM_FAULT_FUNCTION, FATHOM_SIM_FAULT_SILENCE};
    for (size_t i = 0; i != sizeof kinds; i++) {
        stage_t s;
        fathom_sample_t sample;
        set_up(&s, FATHOM_SIM_A16_MODBUS, 0);
        /* the address is the first frame, the acknowledgement the second */
        assert_non_null(fathom_sim_fault_add(&s.fault, kinds[i], FATHOM_SIM_FAULT_ALWAYS_PPM, 2));
        const uint32_t start_us = s.clock.now_us;
        assert_int_equal(go_back(&s, &sample), FATHOM_ERR_UNCONFIRMED);
        ASSERT_SPAN(s.clock.now_us, start_us, 2000 * MS, 4000 * MS);
        assert_int_equal(s.a16.device.counters.writes, 1);
    }
}

/* A first answer with noise before it does not show whether the line echoes (line.h). */
TEST(an_acknowledgement_that_may_be_an_echo_leaves_it_to_the_frames)
{
    stage_t s;
    fathom_sample_t sample;
    set_up(&s, FATHOM_SIM_A16_MODBUS, 0);
    s.config.echo = FATHOM_LINE_ECHO_AUTO;
    assert_non_null(fathom_sim_fault_add(&s.fault, FATHOM_SIM_FAULT_BREAK, FATHOM_SIM_FAULT_ALWAYS_PPM, 1));
    const uint32_t start_us = s.clock.now_us;
    assert_int_equal(go_back(&s, &sample), FATHOM_ERR_UNCONFIRMED);
    ASSERT_SPAN(s.clock.now_us, start_us, 3000 * MS, 4000 * MS); /* the time-out of the write before */
}

TEST(another_commands_outcome_comes_first)
{
    stage_t s;
    fathom_sample_t sample;
    uint16_t threshold_mm = 0;
    fathom_status_t status;
    set_up(&s, FATHOM_SIM_A16_AUTO, 0);
    assert_int_equal(fathom_a16_switch_threshold_mm(&s.asked, &threshold_mm), FATHOM_PENDING);
    assert_int_equal(fathom_a16_rs232_return_to_automatic(&s.rs232, &sample), FATHOM_ERR_BUSY);
    while ((status = fathom_a16_switch_threshold_mm(&s.asked, &threshold_mm)) == FATHOM_PENDING)
        fathom_sim_clock_advance(&s.clock, 1 * MS);
    assert_int_equal(status, FATHOM_READY);
    assert_int_equal(go_back(&s, &sample), FATHOM_READY);
}

TEST(due_is_never_later_than_the_end_of_the_wait)
{
    stage_t s;
    fathom_sample_t sample;
    set_up(&s, FATHOM_SIM_A16_MODBUS, 0);
    while (!s.rs232.is_listening) {
        assert_int_equal(fathom_a16_rs232_return_to_automatic(&s.rs232, &sample), FATHOM_PENDING);
        pass(&s, fathom_a16_rs232_due_us(&s.rs232));
    }
    fathom_sim_clock_advance(&s.clock, 1999 * MS);
    assert_true(fathom_a16_rs232_due_us(&s.rs232) <= 1 * MS);
    fathom_sim_clock_advance(&s.clock, 1 * MS);
    assert_int_equal(fathom_a16_rs232_due_us(&s.rs232), 0);
    assert_int_equal(fathom_a16_rs232_return_to_automatic(&s.rs232, &sample), FATHOM_ERR_UNCONFIRMED);
}
