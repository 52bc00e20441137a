/* SPDX-License-Identifier: MIT */
#include "devices.h"

static void make_a16(device_t *device, const device_settings_t *settings, uint8_t mode)
{
    const fathom_sim_a16_config_t config = {
        .unit = settings->address, .mode = mode, .seed = settings->seed, .scene = settings->scene};
    fathom_sim_a16_init(&device->model.a16, &config);
    device->base = &device->model.a16.device;
}

static void make_a05(device_t *device, const device_settings_t *settings, uint8_t mode)
{
    const fathom_sim_a05_config_t config = {
        .unit = settings->address, .mode = mode, .seed = settings->seed, .scene = settings->scene};
    fathom_sim_a05_init(&device->model.a05, &config);
    device->base = &device->model.a05.device;
}

void device_a16_auto(device_t *device, const device_settings_t *settings)
{
    make_a16(device, settings, FATHOM_SIM_A16_AUTO);
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

/* As command #9 counts them; 0: the default. */
static uint8_t baud_code(uint32_t baud)
{
    static const uint32_t rates[] = {19200, 57600, 115200, 230400};
    for (uint8_t i = 0; i != sizeof rates / sizeof rates[0]; i++)
        if (rates[i] == baud) return (uint8_t)(i + 1);
    return 0;
}

void device_hps167s(device_t *device, const device_settings_t *settings)
{
    const fathom_sim_hps167s_config_t config = {.unit = settings->address,
                                                .baud_code = baud_code(settings->baud),
                                                .seed = settings->seed,
                                                .scene = settings->scene};
    fathom_sim_hps167s_init(&device->model.hps167s, &config);
    device->base = &device->model.hps167s.device;
}
