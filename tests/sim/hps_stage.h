/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_HPS_STAGE_H
#define FATHOM_TESTS_HPS_STAGE_H

#include "bench.h"

#include <string.h>

#include "fathom/fathom.h"
#include "sim/fault.h"
#include "sim/hps167s.h"
#include "sim/scene.h"
#include "sim/uart.h"

/* The HPS-167S's driver on a simulated line with simulated sensors: in a loop that sleeps as long as it may, or in one
 * that comes round so often. */
enum { MS = 1000, SECOND = 1000000, TARGET_MM = 2083 };

typedef struct {
    fathom_sim_clock_t clock;
    fathom_sim_line_t wire;
    fathom_sim_uart_t port;
    fathom_sim_fixed_t fixed;
    fathom_sim_hps167s_t sim[2];
    fathom_sim_fault_t fault; /* of the first */
    fathom_uart_t uart;
    fathom_clock_t hal_clock;
    fathom_line_config_t config;
    fathom_line_t line;
    fathom_modbus_t modbus;
    uint8_t frame[32];
    fathom_hps167s_t hps;
    fathom_sensor_t sensor;
    fathom_sample_t sample;
    int32_t argument; /* of the command */
    uint32_t loop_us; /* 0: it sleeps as long as it may */
} stage_t;

static stage_t stage;
static bool line_echoes; /* of the next stage */

static const fathom_line_settings_t factory = {19200, FATHOM_PARITY_EVEN, 1};

static inline fathom_sim_device_t *device(void) { return &stage.sim[0].device; }

static inline void add(unsigned which, fathom_sim_hps167s_config_t config)
{
    config.scene = fathom_sim_fixed(&stage.fixed);
    fathom_sim_hps167s_init(&stage.sim[which], &config);
    if (which == 0) {
        fathom_sim_fault_init(&stage.fault, 1);
        fathom_sim_fault_attach(&stage.fault, &stage.wire, device());
    }
    fathom_sim_attach(&stage.wire, &stage.sim[which].device, stage.clock.now_us);
}

/* One device, and a driver for it. `at` is NULL where no settings are to be named. */
static inline void set_stage(uint32_t loop_us, fathom_sim_hps167s_config_t config,
                             const fathom_line_settings_t *at)
{
    memset(&stage, 0, sizeof stage);
    stage.loop_us = loop_us;
    stage.fixed = (fathom_sim_fixed_t){{TARGET_MM, 0, 0, 0}};
    fathom_sim_clock_init(&stage.clock, bench_start_us, 0);
    fathom_sim_line_init(&stage.wire, &bench_19200, bench_start_us);
    stage.wire.echo = line_echoes;
    fathom_sim_uart_init(&stage.port, &stage.wire, &stage.clock);
    stage.uart = fathom_sim_uart(&stage.port);
    stage.hal_clock = fathom_sim_clock(&stage.clock);
    stage.config = (fathom_line_config_t){.uart = &stage.uart,
                                          .clock = &stage.hal_clock,
                                          .frame = stage.frame,
                                          .frame_size = sizeof stage.frame,
                                          .silence_us = FATHOM_T3_5_US(19200, 11)};
    assert_int_equal(fathom_line_init(&stage.line, &stage.config), FATHOM_READY);
    stage.modbus = fathom_modbus_client(&stage.line);
    const fathom_hps167s_config_t driver = {.modbus = &stage.modbus,
                                            .clock = &stage.hal_clock,
                                            .settings = at,
                                            .address = config.unit,
                                            .timeout_us = 100 * MS};
    assert_int_equal(fathom_hps167s_init(&stage.hps, &driver), FATHOM_READY);
    stage.sensor = fathom_hps167s_sensor(&stage.hps);
    add(0, config);
}

static inline void pass(void)
{
    if (stage.loop_us != 0)
        fathom_sim_clock_advance(&stage.clock, stage.loop_us);
    else
        fathom_sim_clock_idle(&stage.clock, fathom_due_us(&stage.sensor, 1));
}

/* The command until it has ended; the measurement is polled in the same loop, as an application does. */
static inline fathom_status_t carry_out(fathom_status_t (*command)(void))
{
    const uint32_t start_us = stage.clock.now_us;
    for (;;) {
        const fathom_status_t status = command();
        if (status != FATHOM_PENDING) return status;
        (void)fathom_poll(&stage.sensor, &stage.sample);
        assert_true(fathom_elapsed_us(stage.clock.now_us, start_us) < 30 * SECOND);
        pass();
    }
}

/* The next outcome of measuring. */
static inline fathom_status_t measure(void)
{
    for (;;) {
        const fathom_status_t status = fathom_poll(&stage.sensor, &stage.sample);
        if (status != FATHOM_PENDING) return status;
        pass();
    }
}

static inline void assert_measures(uint8_t unit, uint16_t mm)
{
    assert_int_equal(measure(), FATHOM_READY);
    assert_int_equal(stage.sample.kind, FATHOM_TARGET);
    assert_int_equal(stage.sample.unit, unit);
    assert_int_equal(stage.sample.distance_mm, mm);
}

/* From its n-th frame on the device says nothing, for `run` frames. */
static inline void silence_from(uint32_t frame, uint32_t run)
{
    fathom_sim_fault_rule_t *const rule =
        fathom_sim_fault_add(&stage.fault, FATHOM_SIM_FAULT_SILENCE, FATHOM_SIM_FAULT_ALWAYS_PPM, frame);
    assert_non_null(rule);
    rule->run = run;
}

#endif
