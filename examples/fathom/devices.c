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

void device_hps167s(device_t *device, const device_settings_t *settings)
{
    const fathom_sim_hps167s_config_t config = {
        .unit = settings->address, .seed = settings->seed, .scene = settings->scene};
    fathom_sim_hps167s_init(&device->model.hps167s, &config);
    device->base = &device->model.hps167s.device;
}
