/* SPDX-License-Identifier: MIT */
/*
 * proves: src/sensor/hps167s_auto.c
 * with:   src/codec/modbus_rtu.c src/sensor/hps167s.c src/sensor/hps167s_info.c src/codec/hps167s_registers.c src/codec/crc16.c
 *          src/engine/modbus_command.c src/engine/modbus_unit.c src/engine/sensor.c
 * options: -eva-precision 0 -eva-auto-loop-unroll 700 -eva-widening-delay 20
 *          -eva-slevel-function fathom_modbus_unit_init:400,is_valid:50,is_valid_0:50,fathom_hps167s_init:50,fathom_hps167s_auto_init:50,main:200,run:1,receive:20,drop_first:20,fathom_crc16:20
 *          -eva-split-return-function fathom_modbus_unit_init:0,is_valid:1,is_valid_0:1,fathom_hps167s_init:0,fathom_hps167s_auto_init:0
 * quick:   no
 *
 * The HPS-167S that sends by itself, alone and beside a driver that sends requests: any calls in any order, any bytes.
 */
#include "fathom/sensor/hps167s_auto.h"
#include "fathom/sensor/hps167s_info.h"
#include "hps167s_config.h"

static fathom_hps167s_auto_t sensor;
static fathom_hps167s_t beside;

static void any_call(const fathom_sensor_t *handle, const fathom_sensor_t *other)
{
    fathom_hps167s_configuration_t configuration;
    switch (any_8_in(0, 5)) {
    case 0:
        any_poll(handle);
        break;
    case 1:
        (void)fathom_line_poll(&any_line); /* another driver has */
        break;
    case 2:
        any_poll(other);
        break;
    case 3:
        (void)fathom_hps167s_get_configuration(&beside, &configuration);
        break;
    case 4:
        fathom_hps167s_power_on(&beside);
        break;
    default:
        (void)fathom_hps167s_auto_set_limits(&sensor, &any_limits);
    }
}

/* Alone, and beside the other driver. */
static void run(void)
{
    const fathom_sensor_t handle = fathom_hps167s_auto_sensor(&sensor);
    const fathom_sensor_t other = fathom_hps167s_sensor(&beside);
    while (any_bool()) any_call(&handle, &other);
    fathom_hps167s_auto_deinit(&sensor);
}

void main(void)
{
    fathom_hps167s_auto_config_t config;
    fathom_hps167s_config_t config_beside;
    any_line_init();
    config.stale_us = any_32();
    config.address = any_8();
    const fathom_status_t status = fathom_hps167s_auto_init(&sensor, &blank_line, &config);
    /*@ assert status == FATHOM_ERR_ARGUMENT; */
    fathom_line_t *const line = any_bool() ? &any_line : NULL;
    any_hps167s_config(&config_beside);
    const fathom_sensor_t handle = fathom_hps167s_auto_sensor(&sensor);
    any_poll(&handle); /* in zeroed memory */
    const bool is_beside = any_bool();
    /*@ split is_beside; */
    if (fathom_hps167s_init(&beside, &assumed_transport, &config_beside) != FATHOM_OK) return;
    if (fathom_hps167s_auto_init(&sensor, line, NULL) == FATHOM_OK) fathom_hps167s_auto_deinit(&sensor);
    if (fathom_hps167s_auto_init(&sensor, line, &config) != FATHOM_OK) return;
    if (is_beside) fathom_hps167s_auto_follow(&sensor, &beside);
    run();
}
