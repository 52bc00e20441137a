/* SPDX-License-Identifier: MIT */
/*
 * A level, with a guard and without, and the two sensors that are read by it: any config, any looks. What sets the
 * polarity by Modbus is there with any status; line and drivers are proved elsewhere.
 *
 * proves: src/engine/contact.c src/sensor/a05_relay.c src/sensor/a16_switch.c
 * with: src/engine/sensor.c
 * options: -eva-split-return-function fathom_contact_sensor_poll:0,fathom_poll:0,can_be_read:1
 *         -eva-split-return-function fathom_contact_init:0,fathom_a05_relay_init:0,fathom_a16_switch_init:0
 */
#include "assumptions.h"
#include "fathom/sensor/a05_relay.h"
#include "fathom/sensor/a16_switch.h"

static fathom_status_t any_status(void)
{
    if (any_bool()) return (fathom_status_t)Frama_C_interval(FATHOM_ERR_OTHER_MASTER, FATHOM_ERR_ARGUMENT);
    return any_bool() ? FATHOM_OK : FATHOM_PENDING;
}

static fathom_status_t guard_poll(void *ctx)
{
    /*@ assert ctx == &assumed_ctx; */
    return any_bool() ? FATHOM_PENDING : FATHOM_ERR_PORT;
}

static bool guard_is_clear(void *ctx, uint32_t now_us)
{
    /*@ assert ctx == &assumed_ctx; */
    return any_bool();
}

static const fathom_contact_guard_t guard = {guard_poll, guard_is_clear, assumed_now_us, &assumed_ctx};

/* Of a16_settings.h. */
fathom_status_t fathom_a16_modbus_set_switch_polarity(fathom_a16_modbus_t *sensor,
                                                      fathom_a16_polarity_t polarity)
{
    return any_status();
}

static fathom_contact_timing_t any_timing(void)
{
    fathom_contact_timing_t timing;
    timing.settle_us = any_32();
    timing.period_us = any_32();
    timing.interval_us = any_32();
    timing.stale_us = any_32();
    return timing;
}

static void look(const fathom_sensor_t *sensor)
{
    fathom_sample_t sample;
    if (fathom_poll(sensor, &sample) == FATHOM_OK) {
        /*@ assert \initialized(&sample.raw) && \initialized(&sample.kind) && \initialized(&sample.probe); */
    }
    (void)fathom_due_us(sensor, 1);
}

static void relay(const fathom_pin_t *pin)
{
    static fathom_a05_relay_t relay, blank;
    fathom_a05_relay_config_t config;
    const fathom_clock_t *clock;
    const bool has_clock = any_bool();
    /*@ split has_clock; */
    clock = has_clock ? &assumed_clock : NULL;
    config.timing = any_timing();
    config.wiring = any_8();
    config.level = any_8();
    const fathom_sensor_t none = fathom_a05_relay_sensor(&blank);
    look(&none); /* in zeroed memory */
    (void)fathom_a05_relay_init(&relay, pin, clock, NULL);
    if (fathom_a05_relay_init(&relay, pin, clock, &config) != FATHOM_OK) return;
    const fathom_sensor_t sensor = fathom_a05_relay_sensor(&relay);
    while (any_bool()) look(&sensor);
}

/* A guard or a clock without one of its functions is refused. */
static void refused(void)
{
    static const fathom_contact_guard_t no_poll = {NULL, guard_is_clear, assumed_now_us, &assumed_ctx};
    static const fathom_contact_guard_t no_is_clear = {guard_poll, NULL, assumed_now_us, &assumed_ctx};
    static const fathom_contact_guard_t no_due_us = {guard_poll, guard_is_clear, NULL, &assumed_ctx};
    static const fathom_clock_t no_time = {NULL, &assumed_ctx};
    static fathom_a16_switch_t object;
    fathom_a16_switch_config_t config;
    config.timing = any_timing();
    config.negative = any_bool();
    config.address = any_8();
    config.guard = &no_poll;
    fathom_status_t status = fathom_a16_switch_init(&object, &assumed_input, &assumed_clock, &config);
    /*@ assert status == FATHOM_ERR_ARGUMENT; */
    config.guard = &no_is_clear;
    status = fathom_a16_switch_init(&object, &assumed_input, &assumed_clock, &config);
    /*@ assert status == FATHOM_ERR_ARGUMENT; */
    config.guard = &no_due_us;
    status = fathom_a16_switch_init(&object, &assumed_input, &assumed_clock, &config);
    /*@ assert status == FATHOM_ERR_ARGUMENT; */
    config.guard = NULL;
    status = fathom_a16_switch_init(&object, &assumed_input, &no_time, &config);
    /*@ assert status == FATHOM_ERR_ARGUMENT; */
}

static void a_switch(const fathom_pin_t *pin)
{
    static fathom_a16_switch_t object, blank;
    static fathom_a16_modbus_t modbus;
    fathom_a16_switch_config_t config;
    const fathom_clock_t *clock;
    const bool has_clock = any_bool();
    /*@ split has_clock; */
    clock = has_clock ? &assumed_clock : NULL;
    config.guard = any_bool() ? &guard : NULL;
    config.timing = any_timing();
    config.negative = any_bool();
    config.address = any_8();
    const fathom_sensor_t none = fathom_a16_switch_sensor(&blank);
    look(&none); /* in zeroed memory */
    (void)fathom_a16_switch_init(&object, pin, clock, NULL);
    if (fathom_a16_switch_init(&object, pin, clock, &config) != FATHOM_OK) return;
    const fathom_sensor_t sensor = fathom_a16_switch_sensor(&object);
    while (any_bool()) {
        look(&sensor);
        const fathom_a16_polarity_t polarity = any_bool() ? FATHOM_A16_POSITIVE : FATHOM_A16_NEGATIVE;
        if (any_bool()) (void)fathom_a16_switch_set_polarity(&object, &modbus, polarity);
        if (any_bool()) fathom_a16_switch_note_polarity(&object, polarity);
    }
}

int main(void)
{
    relay(NULL);
    relay(&assumed_output);
    relay(&assumed_input);
    refused();
    a_switch(NULL);
    a_switch(&assumed_output);
    a_switch(&assumed_input);
    return 0;
}
