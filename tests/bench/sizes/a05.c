/* SPDX-License-Identifier: MIT */
#include "programs.h"

static fathom_a05_dyp_find_t a05_dyp_find;
static fathom_a05_relay_rule_t a05_relay_rule;

static const fathom_a05_auto_config_t selecting = {.select = {fathom_output_set_pin, &pin}};

DRIVER(a05_auto, listening_begin(), &line, &selecting)

void a05_auto_use(const fathom_sample_t *sample)
{
    outcome = sample->distance_mm;
    outcome = (uint16_t)fathom_a05_auto_select(&a05_auto, (fathom_dyp_value_t)argument);
}

DRIVER(a05_modbus, modbus_begin(), &modbus, NULL)

void a05_modbus_use(const fathom_sample_t *sample)
{
    uint8_t address;
    outcome = sample->distance_mm;
    fathom_a05_modbus_power_on(&a05_modbus);
    outcome = (uint16_t)fathom_a05_modbus_get_address(&a05_modbus, &address);
    outcome = (uint16_t)fathom_a05_modbus_set_address(&a05_modbus, (uint8_t)argument);
}

DRIVER(a05_dyp, line_begin(), &line, NULL)

void a05_dyp_use(const fathom_sample_t *sample)
{
    uint8_t address;
    outcome = sample->distance_mm;
    fathom_a05_dyp_power_on(&a05_dyp);
    outcome = (uint16_t)fathom_a05_dyp_broadcast_address(&a05_dyp, (uint8_t)argument);
    outcome = (uint16_t)fathom_a05_dyp_find(&a05_dyp_find, &line, &address);
}

DRIVER(a05_relay, (void)0, &pin, &clock, NULL)
ONLY(a05_relay, kind)

/* The rule is fed with the samples of any driver; here with those of the least one that there can be. */
static fathom_status_t stub_poll(void *ctx, fathom_sample_t *sample)
{
    sample->distance_mm = argument;
    return FATHOM_OK;
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
    outcome = fathom_a05_relay_rule_add_sample(&a05_relay_rule, sample);
}
