/* SPDX-License-Identifier: MIT */
/*
 * proves: src/sensor/hps167s_settings.c
 * with:   src/codec/modbus_rtu.c src/sensor/hps167s.c src/sensor/hps167s_info.c src/codec/hps167s_registers.c src/engine/modbus_command.c src/engine/modbus_unit.c
 *          src/engine/modbus_setting.c src/engine/sensor.c
 * options: -eva-precision 0 -eva-auto-loop-unroll 700 -eva-ilevel 32
 *          -eva-slevel-function fathom_modbus_unit_init:400,is_valid:50,is_valid_0:50,fathom_hps167s_init:50,main:5,fathom_hps167s_baud_code:10,set:4,set_all:4
 *          -eva-slevel-function fathom_hps167s_set_address:4,fathom_hps167s_set_baud:4,fathom_hps167s_set_reconnect_time_ms:4
 *          -eva-slevel-function fathom_hps167s_restore_factory_settings:4
 *          -eva-split-return-function fathom_modbus_unit_init:0,is_valid:1,is_valid_0:1,fathom_hps167s_init:0,begin:0
 * quick:   no
 *
 * The HPS-167S, with all that can be set: any calls in any order.
 */
#include "fathom/sensor/hps167s_settings.h"
#include "hps167s_config.h"

static fathom_hps167s_t sensor;

static void set_any(void)
{
    switch (any_8_in(0, 13)) {
    case 0:
        (void)fathom_hps167s_set_warm_up_s(&sensor, any_8());
        break;
    case 1:
        (void)fathom_hps167s_set_measures_after_power_on(&sensor, any_bool());
        break;
    case 2:
        (void)fathom_hps167s_set_termination(&sensor, any_bool());
        break;
    case 3:
        (void)fathom_hps167s_set_distance_offset_mm(&sensor, (int16_t)Frama_C_interval(INT16_MIN, INT16_MAX));
        break;
    case 4:
        (void)fathom_hps167s_load_user_settings(&sensor);
        break;
    case 5:
        (void)fathom_hps167s_load_factory_settings(&sensor);
        break;
    case 6:
        (void)fathom_hps167s_set_filter_sensitivity(&sensor, (int16_t)Frama_C_interval(INT16_MIN, INT16_MAX));
        break;
    case 7:
        (void)fathom_hps167s_set_reconnect_time_ms(&sensor, any_32());
        break;
    case 8:
        (void)fathom_hps167s_broadcast_measures_after_power_on(&sensor, any_bool());
        break;
    case 9:
        (void)fathom_hps167s_broadcast_termination(&sensor, any_bool());
        break;
    case 10:
        (void)fathom_hps167s_set_address(&sensor, any_8());
        break;
    case 11:
        (void)fathom_hps167s_set_baud(&sensor, any_32());
        break;
    case 12:
        (void)fathom_hps167s_restore_factory_settings(&sensor);
        break;
    default:
        (void)fathom_hps167s_write_next_unchecked(&sensor);
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
        (void)fathom_hps167s_is_written(&sensor);
        break;
    default:
        set_any();
    }
}

void main(void)
{
    fathom_hps167s_config_t config;
    any_line_init();
    any_hps167s_config(&config);
    const fathom_sensor_t handle = fathom_hps167s_sensor(&sensor);
    any_call(&handle); /* in zeroed memory */
    if (fathom_hps167s_init(&sensor, &assumed_transport, &config) != FATHOM_OK) return;
    while (any_bool()) any_call(&handle);
    if (any_bool()) fathom_hps167s_deinit(&sensor);
    (void)fathom_hps167s_init(&sensor, &assumed_transport,
                              &config); /* again, perhaps while a request is queued */
}
