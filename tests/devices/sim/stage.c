/* SPDX-License-Identifier: MIT */
#include "stage.h"

stage_t s;

/* ---- a port that can break ---- */

static int port_read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    return s.broken != 0 ? s.broken : s.inner.read(s.inner.ctx, bytes, capacity, rx);
}

static int port_write(void *ctx, const uint8_t *bytes, size_t length)
{
    return s.broken != 0 ? s.broken : s.inner.write(s.inner.ctx, bytes, length);
}

static bool port_sent(void *ctx) { return s.inner.sent(s.inner.ctx); }
static uint32_t port_leaves_in_us(void *ctx) { return s.inner.leaves_in_us(s.inner.ctx); }
static int port_set_line(void *ctx, const fathom_line_settings_t *to)
{
    return s.inner.set_line(s.inner.ctx, to);
}
static int port_set_break(void *ctx, bool on) { return s.inner.set_break(s.inner.ctx, on); }

/* ---- the stage ---- */

void stage_begin(const fathom_line_settings_t *settings, bool full_duplex, uint32_t loop_us)
{
    memset(&s, 0, sizeof s);
    bench_begin(settings, full_duplex);
    s.loop_us = loop_us;
    s.settings = *settings;
    fathom_sim_clock_init(&s.clock, bench_start_us, 0);
    fathom_sim_uart_init(&s.port, &bench.line, &s.clock);
    s.inner = fathom_sim_uart(&s.port);
    s.uart = (fathom_uart_t){.read = port_read,
                             .write = port_write,
                             .sent = port_sent,
                             .set_line = port_set_line,
                             .set_break = port_set_break,
                             .leaves_in_us = port_leaves_in_us};
    s.hal_clock = fathom_sim_clock(&s.clock);
    s.config = (fathom_line_parts_t){.uart = &s.uart,
                                     .senders = &fathom_line_senders,
                                     .clock = &s.hal_clock,
                                     .frame = s.frame,
                                     .frame_size = sizeof s.frame,
                                     .find_echo = fathom_line_find_echo,
                                     .marks = fathom_line_marks,
                                     .count = fathom_line_count,
                                     .counters = s.counters};
    assert_int_equal(fathom_line_init(&s.line, &s.config), FATHOM_OK);
    s.modbus = fathom_modbus_client_with_zero(&s.line);
}

void init_driver(driver_t *driver, model_t model, uint8_t unit, const fathom_line_settings_t *settings)
{
    const fathom_a16_modbus_config_t a16 = {.modbus.address = unit, .modbus.line_settings = settings};
    const fathom_a05_modbus_config_t a05 = {.modbus.address = unit, .modbus.line_settings = settings};
    const fathom_a05_dyp_config_t dyp = {.modbus.address = unit, .modbus.line_settings = settings};
    const fathom_hps167s_config_t hps = {.modbus.address = unit, .modbus.line_settings = settings};
    const fathom_hps167_uart_config_t hps167 = {.modbus.line_settings = settings};
    fathom_status_t status = FATHOM_PENDING;
    if (model == HPS167) status = fathom_hps167_uart_init(&driver->hps167, &s.line, &hps167);
    if (model == HPS) status = fathom_hps167s_init(&driver->hps, &s.modbus, &hps);
    if (model == A16) status = fathom_a16_modbus_init(&driver->a16, &s.modbus, &a16);
    if (model == A05) status = fathom_a05_modbus_init(&driver->a05, &s.modbus, &a05);
    if (model == A05_DYP) status = fathom_a05_dyp_init(&driver->dyp, &s.line, &dyp);
    assert_int_equal(status, FATHOM_OK);
}

fathom_sensor_t sensor_of(driver_t *driver, model_t model)
{
    if (model == HPS) return fathom_hps167s_sensor(&driver->hps);
    if (model == HPS167) return fathom_hps167_uart_sensor(&driver->hps167);
    if (model == A16) return fathom_a16_modbus_sensor(&driver->a16);
    return model == A05 ? fathom_a05_modbus_sensor(&driver->a05) : fathom_a05_dyp_sensor(&driver->dyp);
}

void set_echo(uint8_t echo)
{
    fathom_listener_t *const listener = s.line.listener;
    s.config.echo = echo;
    assert_int_equal(fathom_line_init(&s.line, &s.config), FATHOM_OK);
    (void)fathom_line_replace_listener(&s.line, listener);
}

void set_up(model_t model, uint8_t unit, uint32_t loop_us, uint8_t echo)
{
    const bool is_hps167 = model == HPS167;
    stage_begin(is_hps167 ? &bench_115200 : model == HPS ? &bench_19200 : &bench_9600, is_hps167, loop_us);
    bench.fixed = FIXED(1234, 2000, 1953, 3562);
    set_echo(echo);
    bench.line.echo = echo == FATHOM_LINE_ECHO_ON;
    s.model = model;
    init_driver(&s.driver, model, unit, &s.settings);
    s.sensor = sensor_of(&s.driver, model);
    if (model == HPS) add_hps((hps_config_t){.address = unit});
    if (model == HPS167) add_hps167((hps167_config_t){.seed = 1});
    if (model == A16) add_a16(FATHOM_SIM_A16_MODBUS, (a16_config_t){.address = unit});
    if (model == A05) add_a05(FATHOM_SIM_A05_MODBUS, (a05_config_t){.address = unit});
    if (model == A05_DYP) add_a05(FATHOM_SIM_A05_DYP, (a05_config_t){.address = unit});
    set_faults(1);
    bench.fault.clock = &s.clock;
}

fathom_modbus_unit_t *unit_of(void)
{
    if (s.model == HPS) return &s.driver.hps.unit;
    if (s.model == HPS167) return &s.driver.hps167.unit;
    if (s.model == A16) return &s.driver.a16.base.unit;
    return s.model == A05 ? &s.driver.a05.base.unit : &s.driver.dyp.base.unit;
}

void cancel(void)
{
    if (s.model == HPS) fathom_hps167s_cancel(&s.driver.hps);
    if (s.model == HPS167) fathom_hps167_uart_cancel(&s.driver.hps167);
    if (s.model == A16) fathom_a16_modbus_cancel(&s.driver.a16);
    if (s.model == A05) fathom_a05_modbus_cancel(&s.driver.a05);
    if (s.model == A05_DYP) fathom_a05_dyp_cancel(&s.driver.dyp);
}

void power_on(void)
{
    if (s.model == HPS) fathom_hps167s_power_on(&s.driver.hps);
    if (s.model == HPS167) fathom_hps167_uart_power_on(&s.driver.hps167);
    if (s.model == A16) fathom_a16_modbus_power_on(&s.driver.a16);
    if (s.model == A05) fathom_a05_modbus_power_on(&s.driver.a05);
    if (s.model == A05_DYP) fathom_a05_dyp_power_on(&s.driver.dyp);
}

fathom_status_t measure(void)
{
    const uint32_t start_us = s.clock.now_us;
    for (;;) {
        const fathom_status_t status = fathom_poll(&s.sensor, &s.sample);
        if (status != FATHOM_PENDING) return status;
        assert_ends(start_us);
        pass();
    }
}

bool recovers(void)
{
    const uint32_t start_us = s.clock.now_us;
    while (since_us(start_us) < 60 * SECOND) {
        if (measure() == FATHOM_OK) return s.sample.address == bench.device->address;
        pass();
    }
    return false;
}

void rest(uint32_t by_us)
{
    for (const uint32_t start_us = s.clock.now_us; since_us(start_us) < by_us;) {
        (void)fathom_line_poll(&s.line);
        fathom_sim_clock_idle(&s.clock, 50 * MS);
    }
}

bool same_place(void)
{
    const fathom_modbus_unit_t *const unit = unit_of();
    const fathom_line_settings_t *const settings =
        unit->line_settings != NULL ? unit->line_settings : &s.settings;
    return unit->address == bench.device->address && settings->baud == bench.device->settings.baud;
}

uint32_t kept_commands(void)
{
    const fathom_sim_counters_t *const counters = &bench.device->counters;
    return counters->resets > counters->writes ? counters->resets : counters->writes;
}

fathom_status_t round_of(fathom_status_t (*command)(void))
{
    const fathom_status_t status = command();
    if (status != FATHOM_PENDING) return status;
    /* Samples of a response from before may be left. */
    assert_true(fathom_poll(&s.sensor, &s.sample) >= FATHOM_OK);
    pass();
    return FATHOM_PENDING;
}

fathom_status_t carry_out(fathom_status_t (*command)(void))
{
    const uint32_t start_us = s.clock.now_us;
    for (;;) {
        const fathom_status_t status = round_of(command);
        if (status != FATHOM_PENDING) return status;
        assert_ends(start_us);
    }
}
