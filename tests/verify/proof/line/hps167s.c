/* SPDX-License-Identifier: MIT */
/*
 * proves: src/sensor/hps167s.c src/sensor/hps167s_info.c
 * with:   src/codec/modbus_rtu.c src/codec/hps167s_registers.c src/engine/modbus_command.c src/engine/modbus_unit.c src/engine/modbus_setting.c src/engine/sensor.c
 * options: -eva-precision 0 -eva-auto-loop-unroll 700
 *          -eva-slevel-function fathom_modbus_unit_init:400,is_valid:50,is_valid_0:50,fathom_hps167s_init:50,main:5
 *          -eva-split-return-function fathom_modbus_unit_init:0,is_valid:1,is_valid_0:1,fathom_hps167s_init:0
 * quick:   yes
 *
 * The HPS-167S, measuring and asked what it is: any calls in any order.
 */
#include "fathom/sensor/hps167s_info.h"
#include "hps167s_config.h"

static fathom_hps167s_t sensor;

static void inform(void)
{
    fathom_hps167s_version_t version;
    fathom_hps167s_configuration_t configuration;
    fathom_hps167s_details_t details;
    fathom_hps167s_temperature_t temperature;
    const uint16_t registers[4] = {any_16(), any_16(), any_16(), any_16()};
    switch (any_8_in(0, 4)) {
    case 0:
        (void)fathom_hps167s_get_interface_version(&sensor, &version);
        break;
    case 1:
        (void)fathom_hps167s_get_configuration(&sensor, &configuration);
        break;
    case 2:
        (void)fathom_hps167s_get_details(&sensor, &details);
        break;
    case 3:
        (void)fathom_hps167s_get_temperature(&sensor, &temperature);
        break;
    default:
        (void)fathom_hps167s_accept_unsolicited(&sensor, registers, any_32());
    }
}

static void any_call(const fathom_sensor_t *handle)
{
    switch (any_8_in(0, 5)) {
    case 0:
        any_poll(handle);
        break;
    case 1:
        fathom_hps167s_power_on(&sensor);
        break;
    case 2:
        fathom_hps167s_cancel(&sensor);
        break;
    case 3:
        any_line_go_on(); /* another driver has polled the line */
        break;
    case 4:
        (void)fathom_hps167s_set_limits(&sensor, &any_limits);
        break;
    default:
        inform();
    }
}

void main(void)
{
    fathom_hps167s_config_t config;
    any_line_init();
    any_hps167s_config(&config);
    const fathom_sensor_t handle = fathom_hps167s_sensor(&sensor);
    any_call(&handle); /* in zeroed memory */
    (void)fathom_hps167s_init(&sensor, &assumed_transport, NULL);
    if (fathom_hps167s_init(&sensor, &assumed_transport, &config) != FATHOM_OK) return;
    while (any_bool()) any_call(&handle);
    if (any_bool()) fathom_hps167s_deinit(&sensor);
    (void)fathom_hps167s_init(&sensor, &assumed_transport,
                              &config); /* again, perhaps while a request is queued */
}
