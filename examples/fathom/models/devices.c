/* SPDX-License-Identifier: MIT */
#include "models/devices.h"

#include "fathom/hps167s_registers.h"

static void make_a16(device_t *device, const device_settings_t *settings, uint8_t mode)
{
    const uint32_t *const traits = settings->traits;
    const fathom_sim_a16_config_t config = {.unit = settings->address,
                                            .unit_zero = settings->address == 0,
                                            .mode = mode,
                                            .exceptions = traits[DEVICE_EXCEPTIONS] != 0,
                                            .answers_broadcast = traits[DEVICE_ANSWERS_BROADCAST] != 0,
                                            .answers_from_new = traits[DEVICE_ANSWERS_FROM_NEW] != 0,
                                            .real_time = traits[DEVICE_REAL_TIME] != 0,
                                            .seed = settings->seed,
                                            .scene = settings->scene};
    fathom_sim_a16_init(&device->simulator.a16, &config);
    device->base = &device->simulator.a16.device;
}

static void make_a05(device_t *device, const device_settings_t *settings, uint8_t mode)
{
    const uint32_t *const traits = settings->traits;
    const fathom_sim_a05_config_t config = {.unit = settings->address,
                                            .unit_zero = settings->address == 0,
                                            .mode = mode,
                                            .exceptions = traits[DEVICE_EXCEPTIONS] != 0,
                                            .answers_broadcast = traits[DEVICE_ANSWERS_BROADCAST] != 0,
                                            .answers_from_new = traits[DEVICE_ANSWERS_FROM_NEW] != 0,
                                            .real_time = traits[DEVICE_REAL_TIME] != 0,
                                            .seed = settings->seed,
                                            .scene = settings->scene};
    fathom_sim_a05_init(&device->simulator.a05, &config);
    device->base = &device->simulator.a05.device;
}

void device_a16_auto(device_t *device, const device_settings_t *settings)
{
    make_a16(device, settings, FATHOM_SIM_A16_AUTO);
}

void device_a16_controlled(device_t *device, const device_settings_t *settings)
{
    make_a16(device, settings, FATHOM_SIM_A16_CONTROLLED);
}

void device_a16_modbus(device_t *device, const device_settings_t *settings)
{
    make_a16(device, settings, FATHOM_SIM_A16_MODBUS);
}

void device_a05_auto(device_t *device, const device_settings_t *settings)
{
    make_a05(device, settings, FATHOM_SIM_A05_AUTO);
}

void device_a05_modbus(device_t *device, const device_settings_t *settings)
{
    make_a05(device, settings, FATHOM_SIM_A05_MODBUS);
}

void device_a05_dyp(device_t *device, const device_settings_t *settings)
{
    make_a05(device, settings, FATHOM_SIM_A05_DYP);
}

static uint8_t warm_up_says(const uint32_t *traits)
{
    if (traits[DEVICE_WARM_UP_ABNORMAL] != 0) return FATHOM_SIM_HPS167S_ABNORMAL;
    return traits[DEVICE_WARM_UP_REFUSES] != 0 ? FATHOM_SIM_HPS167S_EXCEPTION : FATHOM_SIM_HPS167S_SILENCE;
}

void device_hps167s(device_t *device, const device_settings_t *settings)
{
    const uint32_t *const traits = settings->traits;
    const fathom_sim_hps167s_config_t config = {
        .unit = settings->address,
        .baud_code = fathom_hps167s_baud_code(settings->baud),
        .warm_up_s = (uint8_t)traits[DEVICE_WARM_UP],
        .warm_up_says = warm_up_says(traits),
        .wrong_length = traits[DEVICE_COUNT_EXCEPTION] != 0 ? FATHOM_MODBUS_ILLEGAL_DATA_VALUE : 0,
        .no_termination = traits[DEVICE_NO_TERMINATION] != 0,
        .no_auto_output = traits[DEVICE_NO_OUTPUT] != 0,
        .baud_at_power_on = traits[DEVICE_BAUD_LATER] != 0,
        .offset_adds = traits[DEVICE_OFFSET_ADDS] != 0,
        .reconnect_ms = traits[DEVICE_RECONNECT],
        .no_baud_code = traits[DEVICE_NO_BAUD_CODE] != 0,
        .answers_from_new = traits[DEVICE_ANSWERS_FROM_NEW] != 0,
        .unasked_us = traits[DEVICE_UNASKED],
        .seed = settings->seed,
        .scene = settings->scene};
    fathom_sim_hps167s_init(&device->simulator.hps167s, &config);
    device->base = &device->simulator.hps167s.device;
}
