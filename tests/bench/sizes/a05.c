/* SPDX-License-Identifier: MIT */
#include "programs.h"

static fathom_a05_auto_t a05_auto;
static fathom_a05_modbus_t a05_modbus;
static fathom_a05_dyp_t a05_dyp;
static fathom_a05_dyp_find_t a05_dyp_find;
static fathom_a05_relay_t a05_relay;
static fathom_a05_relay_rule_t a05_relay_rule;

fathom_sensor_t a05_auto_begin(void)
{
    static const fathom_a05_auto_config_t config = {.line = &line, .select = &pin};
    line_begin();
    fathom_a05_auto_init(&a05_auto, &config);
    return fathom_a05_auto_sensor(&a05_auto);
}

void a05_auto_use(const fathom_sample_t *sample)
{
    outcome = sample->distance_mm;
    outcome = (uint16_t)fathom_a05_auto_power_on(&a05_auto, (fathom_a05_value_t)argument);
}

fathom_sensor_t a05_modbus_begin(void)
{
    static const fathom_a05_modbus_config_t config = {.modbus = &modbus, .clock = &clock};
    modbus_begin();
    fathom_a05_modbus_init(&a05_modbus, &config);
    return fathom_a05_modbus_sensor(&a05_modbus);
}

void a05_modbus_use(const fathom_sample_t *sample)
{
    uint8_t address;
    outcome = sample->distance_mm;
    fathom_a05_modbus_power_on(&a05_modbus);
    outcome = (uint16_t)fathom_a05_modbus_address(&a05_modbus, &address);
    outcome = (uint16_t)fathom_a05_modbus_set_address(&a05_modbus, (uint8_t)argument);
}

fathom_sensor_t a05_dyp_begin(void)
{
    static const fathom_a05_dyp_config_t config = {.line = &line};
    line_begin();
    fathom_a05_dyp_init(&a05_dyp, &config);
    return fathom_a05_dyp_sensor(&a05_dyp);
}

void a05_dyp_use(const fathom_sample_t *sample)
{
    uint8_t address;
    outcome = sample->distance_mm;
    fathom_a05_dyp_power_on(&a05_dyp);
    outcome = (uint16_t)fathom_a05_dyp_set_every_address(&a05_dyp, (uint8_t)argument);
    outcome = (uint16_t)fathom_a05_dyp_find(&a05_dyp_find, &line, &address);
}

fathom_sensor_t a05_relay_begin(void)
{
    static const fathom_a05_relay_config_t config = {.pin = &pin, .clock = &clock};
    fathom_a05_relay_init(&a05_relay, &config);
    return fathom_a05_relay_sensor(&a05_relay);
}

void a05_relay_use(const fathom_sample_t *sample) { outcome = sample->kind; }

/* The rule is fed with the samples of any driver; here with those of the least one that there can be. */
static fathom_status_t stub_poll(void *ctx, fathom_sample_t *sample)
{
    (void)ctx;
    sample->distance_mm = argument;
    return FATHOM_READY;
}

fathom_sensor_t a05_relay_rule_begin(void)
{
    static const fathom_a05_relay_rule_config_t config = {.threshold_mm = 1000};
    const fathom_sensor_t sensor = {stub_poll, NULL, NULL};
    fathom_a05_relay_rule_init(&a05_relay_rule, &config);
    return sensor;
}

void a05_relay_rule_use(const fathom_sample_t *sample)
{
    outcome = fathom_a05_relay_rule_sample(&a05_relay_rule, sample);
}
