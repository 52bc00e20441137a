/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_SIM_COMMISSION_STAGE_H
#define FATHOM_TESTS_SIM_COMMISSION_STAGE_H

/* What the tests test_commission_*.c share: one driver, one simulated line and up to two devices, and everything that can
 * be set or asked as one list of jobs, so that whatever befalls one of them befalls all. */

#include "bench.h"

#include <stdio.h>
#include <string.h>

#include "fathom/fathom.h"
#include "sim/a05.h"
#include "sim/a16.h"
#include "sim/fault.h"
#include "sim/hps167s.h"
#include "sim/scene.h"
#include "sim/uart.h"

enum { MS = 1000, SECOND = 1000000 };
typedef enum { A16, A05, A05_DYP, HPS } model_t;

typedef struct {
    fathom_sim_clock_t clock;
    fathom_sim_line_t wire;
    fathom_sim_uart_t port;
    fathom_sim_fixed_t fixed;
    union {
        fathom_sim_a16_t a16;
        fathom_sim_a05_t a05;
        fathom_sim_hps167s_t hps;
    } device[2];
    fathom_sim_fault_t fault; /* of the first device */
    fathom_uart_t inner;
    fathom_uart_t uart; /* the same, and it can break */
    int broken;         /* what read and write return; 0: it works */
    fathom_clock_t hal_clock;
    fathom_line_config_t config;
    fathom_line_settings_t settings;
    fathom_line_t line;
    fathom_modbus_t modbus;
    uint8_t frame[64];
    union {
        fathom_a16_modbus_t a16;
        fathom_a05_modbus_t a05;
        fathom_a05_dyp_t dyp;
        fathom_hps167s_t hps;
    } driver;
    uint8_t model;
    uint32_t loop_us; /* 0: it sleeps as long as it may */
} commission_t;

/* One thing to set or to ask. */
typedef enum { KEPT, WRITE_ONLY, MOVES, READS } kind_t;
typedef struct {
    const char *name;
    fathom_status_t (*call)(commission_t *s);
    uint32_t (*has)(const commission_t *s); /* what the device has */
    uint32_t before;
    uint32_t wanted;
    uint8_t model;
    uint8_t kind;
    uint8_t unit; /* of the device, at first */
} job_t;

static inline fathom_sim_device_t *device_of(commission_t *s, unsigned which)
{
    if (s->model == HPS) return &s->device[which].hps.device;
    return s->model == A16 ? &s->device[which].a16.device : &s->device[which].a05.device;
}

static inline fathom_modbus_unit_t *unit_of(commission_t *s)
{
    if (s->model == HPS) return &s->driver.hps.unit;
    if (s->model == A16) return &s->driver.a16.base.unit;
    return s->model == A05 ? &s->driver.a05.base.unit : &s->driver.dyp.base.unit;
}

static inline fathom_sensor_t sensor_of(commission_t *s)
{
    if (s->model == HPS) return fathom_hps167s_sensor(&s->driver.hps);
    if (s->model == A16) return fathom_a16_modbus_sensor(&s->driver.a16);
    return s->model == A05 ? fathom_a05_modbus_sensor(&s->driver.a05) : fathom_a05_dyp_sensor(&s->driver.dyp);
}

static inline void cancel(commission_t *s)
{
    if (s->model == HPS) fathom_hps167s_cancel(&s->driver.hps);
    if (s->model == A16) fathom_a16_cancel(&s->driver.a16);
    if (s->model == A05) fathom_a05_modbus_cancel(&s->driver.a05);
    if (s->model == A05_DYP) fathom_a05_dyp_cancel(&s->driver.dyp);
}

static inline void power_on(commission_t *s)
{
    if (s->model == HPS) fathom_hps167s_power_on(&s->driver.hps);
    if (s->model == A16) fathom_a16_modbus_power_on(&s->driver.a16);
    if (s->model == A05) fathom_a05_modbus_power_on(&s->driver.a05);
    if (s->model == A05_DYP) fathom_a05_dyp_power_on(&s->driver.dyp);
}

/* ---- a port that can break ---- */

static inline int port_read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    const commission_t *const s = ctx;
    return s->broken != 0 ? s->broken : s->inner.read(s->inner.ctx, bytes, capacity, rx);
}

static inline int port_write(void *ctx, const uint8_t *bytes, size_t length)
{
    const commission_t *const s = ctx;
    return s->broken != 0 ? s->broken : s->inner.write(s->inner.ctx, bytes, length);
}

static inline bool port_sent(void *ctx)
{
    const commission_t *const s = ctx;
    return s->inner.sent(s->inner.ctx);
}

static inline int port_set_line(void *ctx, const fathom_line_settings_t *settings)
{
    const commission_t *const s = ctx;
    return s->inner.set_line(s->inner.ctx, settings);
}

/* ---- the stage ---- */

static inline void add_device(commission_t *s, unsigned which, uint8_t unit)
{
    const fathom_sim_scene_t scene = fathom_sim_fixed(&s->fixed);
    const fathom_sim_a16_config_t a16 = {.mode = FATHOM_SIM_A16_MODBUS, .unit = unit, .scene = scene};
    const fathom_sim_a05_config_t a05 = {
        .mode = s->model == A05 ? FATHOM_SIM_A05_MODBUS : FATHOM_SIM_A05_DYP, .unit = unit, .scene = scene};
    const fathom_sim_hps167s_config_t hps = {.unit = unit, .scene = scene};
    if (s->model == HPS)
        fathom_sim_hps167s_init(&s->device[which].hps, &hps);
    else if (s->model == A16)
        fathom_sim_a16_init(&s->device[which].a16, &a16);
    else
        fathom_sim_a05_init(&s->device[which].a05, &a05);
    if (which == 0) {
        fathom_sim_fault_init(&s->fault, 1);
        s->fault.clock = &s->clock;
        fathom_sim_fault_attach(&s->fault, &s->wire, device_of(s, 0));
    }
    fathom_sim_attach(&s->wire, device_of(s, which), s->clock.now_us);
}

static inline void init_driver(commission_t *s, uint8_t unit)
{
    const fathom_a16_modbus_config_t a16 = {
        .modbus = &s->modbus, .clock = &s->hal_clock, .address = unit, .settings = &s->settings};
    const fathom_a05_modbus_config_t a05 = {
        .modbus = &s->modbus, .clock = &s->hal_clock, .address = unit, .settings = &s->settings};
    const fathom_a05_dyp_config_t dyp = {.line = &s->line, .address = unit, .settings = &s->settings};
    const fathom_hps167s_config_t hps = {
        .modbus = &s->modbus, .clock = &s->hal_clock, .address = unit, .settings = &s->settings};
    fathom_status_t status = FATHOM_PENDING;
    if (s->model == HPS) status = fathom_hps167s_init(&s->driver.hps, &hps);
    if (s->model == A16) status = fathom_a16_modbus_init(&s->driver.a16, &a16);
    if (s->model == A05) status = fathom_a05_modbus_init(&s->driver.a05, &a05);
    if (s->model == A05_DYP) status = fathom_a05_dyp_init(&s->driver.dyp, &dyp);
    assert_int_equal(status, FATHOM_READY);
}

static inline void set_up(commission_t *s, uint8_t model, uint8_t unit, uint32_t loop_us, uint8_t echo)
{
    memset(s, 0, sizeof *s);
    s->model = model;
    s->loop_us = loop_us;
    s->fixed = (fathom_sim_fixed_t){{1234, 2000, 1953, 3562}};
    s->settings = model == HPS ? bench_19200 : bench_9600;
    fathom_sim_clock_init(&s->clock, bench_start_us, 0);
    fathom_sim_line_init(&s->wire, &s->settings, bench_start_us);
    fathom_sim_uart_init(&s->port, &s->wire, &s->clock);
    s->inner = fathom_sim_uart(&s->port);
    s->uart = (fathom_uart_t){
        .read = port_read, .write = port_write, .sent = port_sent, .set_line = port_set_line, .ctx = s};
    s->hal_clock = fathom_sim_clock(&s->clock);
    s->config = (fathom_line_config_t){.uart = &s->uart,
                                       .clock = &s->hal_clock,
                                       .frame = s->frame,
                                       .frame_size = sizeof s->frame,
                                       .echo = echo};
    s->wire.echo = echo == FATHOM_LINE_ECHO_ON;
    assert_int_equal(fathom_line_init(&s->line, &s->config), FATHOM_READY);
    s->modbus = fathom_modbus_client(&s->line);
    init_driver(s, unit);
    add_device(s, 0, unit);
}

static inline void pass(commission_t *s)
{
    const fathom_sensor_t sensor = sensor_of(s);
    const uint32_t due_us = fathom_due_us(&sensor, 1);
    if (s->loop_us != 0)
        fathom_sim_clock_advance(&s->clock, s->loop_us);
    else
        fathom_sim_clock_idle(&s->clock, due_us);
}

/* One round of an application's loop: the job, and the measurement beside it. */
static inline fathom_status_t round_of(commission_t *s, const job_t *job)
{
    const fathom_sensor_t sensor = sensor_of(s);
    fathom_sample_t sample;
    const fathom_status_t status = job->call(s);
    if (status != FATHOM_PENDING) return status;
    /* Samples of an answer from before may be left. */
    assert_true(fathom_poll(&sensor, &sample) >= FATHOM_PENDING);
    pass(s);
    return FATHOM_PENDING;
}

static inline fathom_status_t run(commission_t *s, const job_t *job)
{
    const uint32_t start_us = s->clock.now_us;
    for (;;) {
        const fathom_status_t status = round_of(s, job);
        if (status != FATHOM_PENDING) return status;
        if (fathom_elapsed_us(s->clock.now_us, start_us) > 60 * SECOND) fail_msg("%s never ends", job->name);
    }
}

static inline fathom_status_t measure(commission_t *s, fathom_sample_t *sample)
{
    const fathom_sensor_t sensor = sensor_of(s);
    const uint32_t start_us = s->clock.now_us;
    for (;;) {
        const fathom_status_t status = fathom_poll(&sensor, sample);
        if (status != FATHOM_PENDING) return status;
        if (fathom_elapsed_us(s->clock.now_us, start_us) > 60 * SECOND) fail_msg("no outcome for a minute");
        pass(s);
    }
}

/* Until it measures again; false: it did not in a minute. */
static inline bool recovers(commission_t *s)
{
    const uint32_t start_us = s->clock.now_us;
    fathom_sample_t sample;
    while (fathom_elapsed_us(s->clock.now_us, start_us) < 60 * SECOND) {
        if (measure(s, &sample) == FATHOM_READY) return sample.unit == device_of(s, 0)->unit;
        pass(s);
    }
    return false;
}

/* Lets late answers and dead times pass, with nothing asked. */
static inline void rest(commission_t *s, uint32_t by_us)
{
    for (uint32_t passed_us = 0; passed_us < by_us; passed_us += 5 * MS) {
        (void)fathom_line_poll(&s->line);
        fathom_sim_clock_advance(&s->clock, 5 * MS);
    }
}

static inline bool same_place(commission_t *s)
{
    const fathom_modbus_unit_t *const unit = unit_of(s);
    const fathom_line_settings_t *const settings = unit->settings != NULL ? unit->settings : &s->settings;
    return unit->address == device_of(s, 0)->unit && settings->baud == device_of(s, 0)->settings.baud;
}

/* How often the device was told something that it keeps, or was reset (by #6, which is a read; #13 is both). */
static inline uint32_t told(commission_t *s)
{
    const fathom_sim_counters_t *const counters = &device_of(s, 0)->counters;
    return counters->resets > counters->writes ? counters->resets : counters->writes;
}

extern const job_t jobs[];
extern const unsigned jobs_count;

#endif
