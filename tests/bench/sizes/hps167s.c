/* SPDX-License-Identifier: MIT */
#include "programs.h"

static const fathom_line_settings_t settings = {19200, FATHOM_PARITY_EVEN, 1};
static const fathom_hps167s_config_t config = {.modbus.line_settings = &settings};

DRIVER(hps167s, modbus_begin(), &modbus, &config)

void hps167s_use(const fathom_sample_t *sample)
{
    outcome = sample->distance_mm;
    fathom_hps167s_power_on(&hps167s);
}

fathom_sensor_t hps167s_info_begin(void) { return hps167s_begin(); }

void hps167s_info_use(const fathom_sample_t *sample)
{
    fathom_hps167s_version_t version;
    fathom_hps167s_configuration_t configuration;
    fathom_hps167s_details_t details;
    fathom_hps167s_temperature_t temperature;
    hps167s_use(sample);
    outcome = (uint16_t)fathom_hps167s_get_interface_version(&hps167s, &version);
    outcome = (uint16_t)fathom_hps167s_get_configuration(&hps167s, &configuration);
    outcome = (uint16_t)fathom_hps167s_get_details(&hps167s, &details);
    outcome = (uint16_t)fathom_hps167s_get_temperature(&hps167s, &temperature);
}

fathom_sensor_t hps167s_settings_begin(void) { return hps167s_begin(); }

void hps167s_settings_use(const fathom_sample_t *sample)
{
    hps167s_use(sample);
    outcome = (uint16_t)fathom_hps167s_set_warm_up_s(&hps167s, (uint8_t)argument);
    outcome = (uint16_t)fathom_hps167s_set_address(&hps167s, (uint8_t)argument);
    outcome = (uint16_t)fathom_hps167s_set_baud(&hps167s, argument);
    outcome = (uint16_t)fathom_hps167s_set_measures_after_power_on(&hps167s, argument != 0);
    outcome = (uint16_t)fathom_hps167s_set_termination(&hps167s, argument != 0);
    outcome = (uint16_t)fathom_hps167s_set_distance_offset_mm(&hps167s, (int16_t)argument);
    outcome = (uint16_t)fathom_hps167s_load_user_settings(&hps167s);
    outcome = (uint16_t)fathom_hps167s_load_factory_settings(&hps167s);
    outcome = (uint16_t)fathom_hps167s_set_filter_sensitivity(&hps167s, (int16_t)argument);
    outcome = (uint16_t)fathom_hps167s_set_reconnect_time_ms(&hps167s, argument);
    outcome = (uint16_t)fathom_hps167s_restore_factory_settings(&hps167s);
}

DRIVER(hps167s_auto, listening_begin(), &line, NULL)
ONLY(hps167s_auto, distance_mm)

DRIVER(hps167_uart, line_begin(), &line, NULL)

void hps167_uart_use(const fathom_sample_t *sample)
{
    uint16_t temperature;
    outcome = sample->distance_mm;
    fathom_hps167_uart_power_on(&hps167_uart);
    outcome = (uint16_t)fathom_hps167_uart_get_temperature(&hps167_uart, &temperature);
    outcome = (uint16_t)fathom_hps167_uart_stop(&hps167_uart);
}
