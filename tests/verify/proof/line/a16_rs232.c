/* SPDX-License-Identifier: MIT */
/*
 * proves: src/sensor/a16_rs232.c
 * with:   src/sensor/a16_modbus.c src/sensor/a16_settings.c src/sensor/a16_auto.c src/sensor/dyp_modbus.c
 *          src/sensor/dyp_auto.c src/sensor/dyp.c src/engine/modbus_command.c src/engine/modbus_unit.c src/engine/modbus_setting.c
 *          src/engine/stream.c src/engine/output.c src/engine/sensor.c src/codec/dyp_stream.c src/codec/modbus_rtu.c
 * options: -eva-precision 0
 *          -eva-slevel-function fathom_modbus_unit_init:400,is_valid:50,fathom_dyp_modbus_init:20,main:30,fathom_a16_modbus_init:50,fathom_a16_auto_init:50,fathom_dyp_auto_init:20,take:40
 *          -eva-split-return-function fathom_modbus_unit_init:0,is_valid:1,fathom_dyp_modbus_init:0,fathom_a16_modbus_init:0,fathom_a16_auto_init:0,fathom_dyp_auto_init:0
 * quick:   no
 *
 * The A16 by RS232, which is told to send by itself again: both drivers and the way back, any calls in any order.
 */
#include "fathom/sensor/a16_rs232.h"
#include "transport.h"

static fathom_a16_modbus_t modbus;
static fathom_a16_auto_t automatic;
static fathom_a16_rs232_t rs232;

static void any_call(const fathom_sensor_t *of_modbus, const fathom_sensor_t *of_automatic)
{
    fathom_sample_t sample;
    switch (any_8_in(0, 5)) {
    case 0:
        any_poll(of_modbus);
        break;
    case 1:
        any_poll(of_automatic);
        break;
    case 2:
        (void)fathom_line_poll(&any_line); /* another driver has */
        break;
    case 3:
        fathom_a16_rs232_cancel(&rs232);
        break;
    case 4:
        (void)fathom_a16_rs232_due_us(&rs232);
        break;
    default:
        (void)fathom_a16_rs232_return_to_automatic(&rs232, &sample);
    }
}

void main(void)
{
    fathom_a16_modbus_config_t config;
    fathom_a16_auto_config_t config_automatic;
    any_line_init();
    any_modbus_config(&config.modbus);
    config.start_us = any_32();
    config.model = any_facts();
    config.value = any_8();
    config_automatic.select.set = NULL;
    config_automatic.select.ctx = NULL;
    config_automatic.stale_us = any_32();
    config_automatic.gap_us = any_16();
    config_automatic.value = any_8();
    config_automatic.model = any_facts();
    if (fathom_a16_modbus_init(&modbus, &assumed_transport, &config) != FATHOM_OK) return;
    if (fathom_a16_auto_init(&automatic, &any_line, &config_automatic) != FATHOM_OK) return;
    fathom_a16_rs232_init(&rs232, &modbus, &automatic);
    rs232.return_us = any_32();
    const fathom_sensor_t of_modbus = fathom_a16_modbus_sensor(&modbus);
    const fathom_sensor_t of_automatic = fathom_a16_auto_sensor(&automatic);
    while (any_bool()) any_call(&of_modbus, &of_automatic);
}
