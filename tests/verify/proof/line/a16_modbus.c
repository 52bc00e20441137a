/* SPDX-License-Identifier: MIT */
/*
 * proves: src/sensor/a16_modbus.c src/sensor/a16_settings.c src/engine/modbus_command.c src/engine/modbus_unit.c
 *          src/engine/modbus_setting.c src/sensor/dyp_modbus.c
 * with:   src/sensor/dyp.c src/engine/sensor.c src/codec/modbus_rtu.c src/codec/crc16.c
 * options: -eva-precision 0
 *          -eva-slevel-function fathom_modbus_unit_init:400,is_valid:50,fathom_dyp_modbus_init:20,main:5,fathom_a16_modbus_init:50
 *          -eva-split-return-function fathom_modbus_unit_init:0,is_valid:1,fathom_dyp_modbus_init:0,fathom_a16_modbus_init:0
 * quick:   yes
 *
 * The A16 by Modbus, with all that can be set, and the search for its address: any calls in any order.
 */
#include "fathom/sensor/a16_settings.h"
#include "transport.h"

static fathom_a16_modbus_t sensor;

static void read_or_set(void)
{
    uint8_t address;
    uint16_t threshold_mm;
    fathom_a16_polarity_t polarity;
    fathom_dyp_value_t value;
    int16_t temperature_dc;
    fathom_sample_t sample;
    switch (any_8_in(0, 12)) {
    case 0:
        (void)fathom_a16_modbus_get_address(&sensor, &address);
        break;
    case 1:
        (void)fathom_a16_modbus_set_address(&sensor, any_8());
        break;
    case 2:
        (void)fathom_a16_modbus_set_address_0(&sensor);
        break;
    case 3:
        (void)fathom_a16_modbus_set_operating_mode(&sensor, (fathom_a16_operating_mode_t)any_8());
        break;
    case 4:
        (void)fathom_a16_modbus_get_switch_polarity(&sensor, &polarity);
        break;
    case 5:
        (void)fathom_a16_modbus_set_switch_polarity(&sensor, (fathom_a16_polarity_t)any_8());
        break;
    case 6:
        (void)fathom_a16_modbus_get_switch_threshold_mm(&sensor, &threshold_mm);
        break;
    case 7:
        (void)fathom_a16_modbus_set_switch_threshold_mm(&sensor, any_16());
        break;
    case 8:
        (void)fathom_a16_modbus_get_automatic_value(&sensor, &value);
        break;
    case 9:
        (void)fathom_a16_modbus_set_automatic_value(&sensor, (fathom_dyp_value_t)any_8());
        break;
    case 10:
        (void)fathom_a16_modbus_measure(&sensor, (fathom_dyp_value_t)any_8(), &sample);
        break;
    case 11:
        (void)fathom_a16_modbus_get_temperature(&sensor, &temperature_dc);
        break;
    default:
        (void)fathom_a16_modbus_write_next_unchecked(&sensor);
    }
}

static void any_call(const fathom_sensor_t *handle)
{
    static fathom_dyp_modbus_find_t find;
    uint8_t address;
    switch (any_8_in(0, 7)) {
    case 0:
        any_poll(handle);
        break;
    case 1:
        fathom_a16_modbus_power_on(&sensor);
        break;
    case 2:
        fathom_a16_modbus_cancel(&sensor);
        break;
    case 3:
        (void)fathom_a16_modbus_is_written(&sensor);
        (void)fathom_a16_modbus_exception(&sensor);
        break;
    case 4:
        any_line_go_on(); /* another driver has polled the line */
        break;
    case 5:
        (void)fathom_dyp_modbus_find(&find, &assumed_transport, &address);
        break;
    case 6:
        fathom_dyp_modbus_find_cancel(&find, &assumed_transport);
        break;
    default:
        read_or_set();
    }
}

static const fathom_modbus_t no_line = {NULL, assumed_submit};
static const fathom_modbus_t no_initialised_line = {&blank_line, assumed_submit};

static void refuse(const fathom_modbus_t *transport, const fathom_a16_modbus_config_t *config)
{
    const fathom_status_t status = fathom_a16_modbus_init(&sensor, transport, config);
    /*@ assert status == FATHOM_ERR_ARGUMENT; */
}

void main(void)
{
    fathom_a16_modbus_config_t config;
    any_line_init();
    any_modbus_config(&config.modbus);
    config.start_us = any_32();
    config.model = any_facts();
    config.value = any_8();
    const fathom_sensor_t handle = fathom_a16_modbus_sensor(&sensor);
    any_call(&handle); /* in zeroed memory */
    refuse(NULL, &config);
    refuse(&no_line, &config);
    refuse(&no_initialised_line, &config);
    (void)fathom_a16_modbus_init(&sensor, &assumed_transport, NULL);
    if (fathom_a16_modbus_init(&sensor, &assumed_transport, &config) != FATHOM_OK) return;
    while (any_bool()) any_call(&handle);
    if (any_bool()) fathom_a16_modbus_deinit(&sensor);
    (void)fathom_a16_modbus_init(&sensor, &assumed_transport,
                                 &config); /* again, perhaps while a request is queued */
}
