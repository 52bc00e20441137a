/* SPDX-License-Identifier: MIT */
/*
 * proves: src/sensor/a05_modbus.c
 * with:   src/codec/modbus_rtu.c src/sensor/dyp_modbus.c src/sensor/dyp.c src/engine/modbus_command.c src/engine/modbus_unit.c src/engine/modbus_setting.c
 *          src/engine/sensor.c
 * options: -eva-precision 0 -eva-ilevel 16
 *          -eva-slevel-function fathom_modbus_unit_init:400,is_valid:50,fathom_dyp_modbus_init:20,main:200,any_probes:20,fathom_dyp_measurement_next:20,fathom_dyp_first_probe:20,run:1,fathom_a05_modbus_init:50
 *          -eva-split-return-function fathom_modbus_unit_init:0,is_valid:1,fathom_dyp_modbus_init:0,fathom_a05_modbus_init:0
 * quick:   no
 *
 * The A05 by Modbus: any calls in any order. Which probes it has is told apart, so that a value stands beside its room.
 */
#include "fathom/sensor/a05_modbus.h"
#include "transport.h"

static fathom_a05_modbus_t sensor;

static void any_call(const fathom_sensor_t *handle)
{
    uint8_t address;
    switch (any_8_in(0, 7)) {
    case 0:
        any_poll(handle);
        break;
    case 1:
        fathom_a05_modbus_power_on(&sensor);
        break;
    case 2:
        fathom_a05_modbus_cancel(&sensor);
        break;
    case 3:
        (void)fathom_a05_modbus_is_written(&sensor);
        (void)fathom_a05_modbus_exception(&sensor);
        break;
    case 4:
        any_line_go_on(); /* another driver has polled the line */
        break;
    case 5:
        (void)fathom_a05_modbus_get_address(&sensor, &address);
        break;
    case 6:
        (void)fathom_a05_modbus_set_address(&sensor, any_8());
        break;
    default:
        (void)fathom_a05_modbus_set_address_0(&sensor);
    }
}

/* The same loop for each place where its probes begin. */
static void run(void)
{
    const fathom_sensor_t handle = fathom_a05_modbus_sensor(&sensor);
    while (any_bool()) any_call(&handle);
}

void main(void)
{
    fathom_a05_modbus_config_t config;
    any_line_init();
    any_modbus_config(&config.modbus);
    config.start_us = any_32();
    config.model = any_facts();
    config.registers = any_16();
    const uint8_t which = any_8_in(0, 5);
    /*@ split which; */
    config.probes = any_probes(which);
    const fathom_sensor_t none = fathom_a05_modbus_sensor(&sensor);
    any_call(&none); /* in zeroed memory */
    (void)fathom_a05_modbus_init(&sensor, &assumed_transport, NULL);
    if (fathom_a05_modbus_init(&sensor, &assumed_transport, &config) != FATHOM_OK) return;
    run();
    if (any_bool()) fathom_a05_modbus_deinit(&sensor);
    (void)fathom_a05_modbus_init(&sensor, &assumed_transport,
                                 &config); /* again, perhaps while a request is queued */
}
