/* SPDX-License-Identifier: MIT */
#include "programs.h"

static fathom_a16_rs232_t a16_rs232;
static fathom_edges_t edges;
static fathom_capture_t edges_capture;

static const fathom_output_t output = {fathom_output_set_pin, &pin};
static const fathom_a16_auto_config_t selecting = {.select = {fathom_output_set_pin, &pin}};

DRIVER(a16_auto, listening_begin(), &line, &selecting)

void a16_auto_use(const fathom_sample_t *sample)
{
    outcome = sample->distance_mm;
    outcome = (uint16_t)fathom_a16_auto_select(&a16_auto, (fathom_dyp_value_t)argument);
}

DRIVER(a16_controlled, listening_begin(), &line, &output, NULL)
ONLY(a16_controlled, distance_mm)

DRIVER(a16_modbus, modbus_begin(), &modbus, NULL)

void a16_modbus_use(const fathom_sample_t *sample)
{
    outcome = sample->distance_mm;
    fathom_a16_modbus_power_on(&a16_modbus);
}

fathom_sensor_t a16_settings_begin(void) { return a16_modbus_begin(); }

void a16_settings_use(const fathom_sample_t *sample)
{
    uint8_t address;
    uint16_t threshold_mm;
    fathom_a16_polarity_t polarity;
    fathom_dyp_value_t value;
    fathom_sample_t once;
    a16_modbus_use(sample);
    outcome = (uint16_t)fathom_a16_modbus_measure(&a16_modbus, (fathom_dyp_value_t)argument, &once);
    outcome = once.distance_mm;
    outcome = (uint16_t)fathom_a16_modbus_get_address(&a16_modbus, &address);
    outcome = (uint16_t)fathom_a16_modbus_set_address(&a16_modbus, (uint8_t)argument);
    outcome =
        (uint16_t)fathom_a16_modbus_set_operating_mode(&a16_modbus, (fathom_a16_operating_mode_t)argument);
    outcome = (uint16_t)fathom_a16_modbus_get_switch_polarity(&a16_modbus, &polarity);
    outcome = (uint16_t)fathom_a16_modbus_set_switch_polarity(&a16_modbus, (fathom_a16_polarity_t)argument);
    outcome = (uint16_t)fathom_a16_modbus_get_switch_threshold_mm(&a16_modbus, &threshold_mm);
    outcome = (uint16_t)fathom_a16_modbus_set_switch_threshold_mm(&a16_modbus, argument);
    outcome = (uint16_t)fathom_a16_modbus_get_automatic_value(&a16_modbus, &value);
    outcome = (uint16_t)fathom_a16_modbus_set_automatic_value(&a16_modbus, (fathom_dyp_value_t)argument);
}

DRIVER(a16_pwm, (void)0, &capture, &clock, &output, NULL)
ONLY(a16_pwm, distance_mm)

fathom_sensor_t a16_pwm_edges_begin(void)
{
    fathom_edges_init(&edges, &pin);
    edges_capture = fathom_edges_capture(&edges);
    fathom_a16_pwm_init(&a16_pwm, &edges_capture, &clock, &output, NULL);
    return fathom_a16_pwm_sensor(&a16_pwm);
}

void a16_pwm_edges_use(const fathom_sample_t *sample)
{
    outcome = sample->distance_mm;
    fathom_edges_feed(&edges, level != 0, argument);
}

fathom_sensor_t a16_rs232_begin(void)
{
    const fathom_sensor_t sensor = a16_modbus_begin();
    fathom_a16_auto_init(&a16_auto, &line, NULL);
    fathom_a16_rs232_init(&a16_rs232, &a16_modbus, &a16_auto);
    return argument != 0 ? fathom_a16_auto_sensor(&a16_auto) : sensor;
}

void a16_rs232_use(const fathom_sample_t *sample)
{
    fathom_sample_t first;
    a16_modbus_use(sample);
    outcome = (uint16_t)fathom_a16_rs232_return_to_automatic(&a16_rs232, &first);
    outcome = first.distance_mm;
    outcome = (uint16_t)fathom_a16_rs232_due_us(&a16_rs232);
}

DRIVER(a16_switch, (void)0, &pin, &clock, NULL)
ONLY(a16_switch, kind)

fathom_sensor_t a16_switch_set_begin(void)
{
    static fathom_contact_guard_t guard;
    static const fathom_a16_switch_config_t config = {.guard = &guard};
    a16_modbus_begin();
    guard = fathom_contact_line_guard(&line);
    fathom_a16_switch_init(&a16_switch, &pin, &clock, &config);
    return fathom_a16_switch_sensor(&a16_switch);
}

void a16_switch_set_use(const fathom_sample_t *sample)
{
    outcome = sample->kind;
    outcome =
        (uint16_t)fathom_a16_switch_set_polarity(&a16_switch, &a16_modbus, (fathom_a16_polarity_t)argument);
    outcome = (uint16_t)fathom_a16_modbus_set_switch_threshold_mm(&a16_modbus, argument);
}
