/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_SIM_SWITCH_STAGE_H
#define FATHOM_TESTS_SIM_SWITCH_STAGE_H

/* The drivers of switch and relay at simulated modules, with a log of what they said, and a second line for what is
 * compared with them. */

#include <string.h>

#include "bench.h"
#include "fathom/a05_relay.h"
#include "fathom/a16_settings.h"
#include "fathom/a16_switch.h"
#include "fathom/modbus_client.h"
#include "sim/a05.h"
#include "sim/a16.h"
#include "sim/pin.h"
#include "sim/scene.h"

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

static inline void set_up_port(port_t *port, fathom_sim_device_t *device)
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

static inline void begin(int32_t distance)
{
    memset(&s, 0, sizeof s);
    fathom_sim_clock_init(&s.sim_clock, bench_start_us, 0);
    s.clock = fathom_sim_clock(&s.sim_clock);
    for (int i = 0; i != 4; i++) s.fixed.value[i] = distance;
}

static inline void set_a16(int32_t distance)
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

static inline void set_a05(int32_t distance, fathom_sim_a05_config_t config, uint8_t wiring)
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

static inline void look(void)
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

static inline void run(uint32_t for_us, uint32_t step_us)
{
    for (uint32_t passed_us = 0; passed_us < for_us; passed_us += step_us) {
        fathom_sim_clock_advance(&s.sim_clock, step_us);
        look();
    }
}

/* One kind a letter. */
static inline void expect(const char *kinds)
{
    assert_int_equal(s.samples, strlen(kinds));
    for (unsigned i = 0; kinds[i] != 0; i++)
        assert_int_equal(s.kinds[i], kinds[i] == 'N' ? FATHOM_NEAR : FATHOM_FAR);
    assert_int_equal(s.errors, 0);
}

#endif
