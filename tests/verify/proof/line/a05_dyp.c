/* SPDX-License-Identifier: MIT */
/*
 * proves: src/sensor/a05_dyp.c
 * with:   src/engine/dyp_client.c src/codec/dyp_55aa.c src/codec/dyp_stream.c src/codec/modbus_rtu.c src/codec/crc16.c
 *          src/sensor/dyp_modbus.c src/sensor/dyp.c src/engine/modbus_command.c src/engine/modbus_unit.c src/engine/modbus_setting.c
 *          src/engine/sensor.c
 * options: -eva-precision 0 -eva-ilevel 16
 *          -eva-slevel-function fathom_modbus_unit_init:400,fathom_dyp_modbus_init:20,main:200,fathom_dyp_measurement_next:20,fathom_dyp_first_probe:20,fathom_dyp_stream_decode:10,fathom_dyp_55aa_value_count:5,run:1,fathom_a05_dyp_init:50,fathom_line_submit:20
 *          -eva-split-return-function fathom_modbus_unit_init:0,fathom_dyp_modbus_init:0,fathom_a05_dyp_init:0
 * quick:   no
 *
 * The A05 by 55 AA, with the search for its address, over any line: any calls in any order.
 */
#include "fathom/sensor/a05_dyp.h"
#include "any_line.h"

static fathom_a05_dyp_t sensor;
static fathom_a05_dyp_find_t find;

static void any_call(const fathom_sensor_t *handle)
{
    uint8_t address;
    switch (any_8_in(0, 8)) {
    case 0:
        any_poll(handle);
        break;
    case 1:
        fathom_a05_dyp_power_on(&sensor);
        break;
    case 2:
        fathom_a05_dyp_cancel(&sensor);
        break;
    case 3:
        (void)fathom_a05_dyp_is_written(&sensor);
        break;
    case 4:
        (void)fathom_line_poll(&any_line); /* another driver has */
        break;
    case 5:
        (void)fathom_a05_dyp_broadcast_address(&sensor, any_8());
        break;
    case 6:
        (void)fathom_a05_dyp_find(&find, &any_line, &address);
        break;
    case 7:
        (void)fathom_modbus_write_next_unchecked(&sensor.base.unit);
        break;
    default:
        fathom_a05_dyp_find_cancel(&find, &any_line);
    }
}

/* The same loop for each place where its probes begin. */
static void run(void)
{
    const fathom_sensor_t handle = fathom_a05_dyp_sensor(&sensor);
    while (any_bool()) any_call(&handle);
}

void main(void)
{
    fathom_a05_dyp_config_t config;
    any_line_init();
    const fathom_sensor_t none = fathom_a05_dyp_sensor(&sensor);
    any_call(&none); /* in zeroed memory */
    any_modbus_config(&config.modbus);
    config.start_us = any_32();
    config.model = any_facts();
    config.probes = any_8_in(0, 16); /* from 16 on they are refused */
    /*@ split config.probes; */
    (void)fathom_a05_dyp_init(&sensor, &any_line, NULL);
    if (fathom_a05_dyp_init(&sensor, &any_line, &config) != FATHOM_OK) return;
    const uint8_t first = sensor.base.measurement.first;
    /*@ split first; */
    /*@ merge config.probes; */
    /*@ slevel merge; */
    run();
    if (any_bool()) fathom_a05_dyp_deinit(&sensor);
    (void)fathom_a05_dyp_init(&sensor, &any_line, &config); /* again, perhaps while a request is queued */
}
