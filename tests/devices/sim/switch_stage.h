/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_SIM_SWITCH_STAGE_H
#define FATHOM_TESTS_SIM_SWITCH_STAGE_H

/* The drivers of switch and relay at simulated modules, with a log of what they said. */

#include "stage.h"

enum { LOG = 64 };

static fathom_pin_t pin;
static fathom_contact_guard_t guard;
static fathom_a16_switch_t a16;
static fathom_a05_relay_t a05;
static fathom_a16_modbus_t *const settings = &s.driver.a16;
static uint8_t kinds[LOG]; /* of all samples */
static uint32_t times_us[LOG];
static unsigned samples, errors;

static inline void begin(int32_t mm)
{
    stage_begin(&bench_9600, true, 0);
    bench.fixed = FIXED(mm, mm, mm, mm);
    set_echo(FATHOM_LINE_ECHO_OFF);
    samples = errors = 0;
}

static inline void take_pin(void)
{
    fathom_sim_pins_init(&s.pins, bench.device, &bench.line, &s.clock);
    pin = fathom_sim_tx_pin(&s.pins);
}

static inline void set_switch(int32_t mm)
{
    begin(mm);
    add_a16(FATHOM_SIM_A16_SWITCH, (a16_config_t){0});
    take_pin();
    guard = fathom_contact_line_guard(&s.line);
    const fathom_a16_switch_config_t own = {.guard = &guard,
                                            .timing.period_us = FATHOM_MAX_DURATION_US, /* changes alone */
                                            .address = 1};
    assert_int_equal(fathom_a16_switch_init(&a16, &pin, &s.hal_clock, &own), FATHOM_OK);
    s.sensor = fathom_a16_switch_sensor(&a16);
    init_driver(&s.driver, A16, 1, NULL);
}

static inline void set_relay(int32_t mm, a05_config_t config, uint8_t wiring)
{
    begin(mm);
    add_a05(FATHOM_SIM_A05_RELAY, config);
    take_pin();
    const fathom_a05_relay_config_t own = {.timing.period_us = FATHOM_MAX_DURATION_US, /* changes alone */
                                           .wiring = wiring};
    assert_int_equal(fathom_a05_relay_init(&a05, &pin, &s.hal_clock, &own), FATHOM_OK);
    s.sensor = fathom_a05_relay_sensor(&a05);
}

static inline void look(void)
{
    const fathom_status_t status = fathom_poll(&s.sensor, &s.sample);
    if (status == FATHOM_OK) {
        assert_true(samples < LOG);
        kinds[samples] = s.sample.kind;
        times_us[samples++] = s.sample.time_us;
    }
    errors += status < 0;
}

static inline void run(uint32_t for_us, uint32_t step_us)
{
    for (uint32_t passed_us = 0; passed_us < for_us; passed_us += step_us) {
        pass_us(step_us);
        look();
    }
}

/* One kind a letter. */
static inline void expect_kinds(const char *letters)
{
    assert_int_equal(samples, strlen(letters));
    for (unsigned i = 0; letters[i] != 0; i++)
        assert_int_equal(kinds[i], letters[i] == 'N' ? FATHOM_NEAR : FATHOM_FAR);
    assert_int_equal(errors, 0);
}

#endif
