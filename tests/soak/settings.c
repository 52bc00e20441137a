/* SPDX-License-Identifier: MIT */
#include "settings.h"

#include <string.h>

/*
 * Periods, time-outs and answer times: a16_modbus.h, a05_modbus.h, a05_dyp.h, hps167s.h, stream.h, and the
 * simulator's a16.h, a05.h, hps167s.h. A byte takes 10 bits at 9600 baud, 11 at 19200.
 */
const soak_facts_t soak_facts[SOAK_SETTINGS] = {
    [SOAK_A16_AUTO] = {"a16-auto", SOAK_GAP, FATHOM_A16, 1, 1, 4, 1042, 1, 16300, 100000, 2000000, 0},
    [SOAK_A16_TIGHT] = {"a16-tight", SOAK_NO_GAP, FATHOM_A16, 1, 1, 4, 1042, 1, 16300, 4168, 2000000, 0},
    [SOAK_A05_AUTO] = {"a05-auto", SOAK_GAP, FATHOM_A05, 1, 4, 10, 1042, 1, 5990, 300000, 2000000, 0},
    [SOAK_A05_TIGHT] = {"a05-tight", SOAK_NO_GAP, FATHOM_A05, 1, 4, 10, 1042, 1, 5990, 10420, 2000000, 0},
    [SOAK_A16_PROCESSED] = {"a16-processed", SOAK_CRC, FATHOM_A16, 1, 1, 7, 1042, 1, 16300, 120000, 1000000,
                            520000},
    [SOAK_A16_REAL_TIME] = {"a16-real-time", SOAK_CRC, FATHOM_A16, 1, 1, 7, 1042, 1, 16300, 120000, 300000,
                            120000},
    [SOAK_A05_MODBUS] = {"a05-modbus", SOAK_CRC, FATHOM_A05, 1, 4, 13, 1042, 1, 5990, 400000, 600000, 400000},
    [SOAK_A05_DYP] = {"a05-dyp", SOAK_SUM, FATHOM_A05, 1, 4, 13, 1042, 1, 5990, 250000, 500000, 210000},
    [SOAK_A05_DYP_ONE] = {"a05-dyp-one", SOAK_SUM, FATHOM_A05, 3, 1, 7, 1042, 1, 5990, 100000, 200000, 75000},
    [SOAK_HPS167S] = {"hps167s", SOAK_CRC, FATHOM_HPS167S, 1, 1, 13, 573, 80, 17900, 18519, 500000, 21019},
};

bool soak_is_asked(uint8_t setting) { return soak_facts[setting].proof >= SOAK_CRC; }

static fathom_sim_device_t *init_a16(fathom_sim_a16_t *a16, uint8_t setting, uint8_t address,
                                     const fathom_sim_scene_t *scene, uint32_t seed)
{
    const fathom_sim_a16_config_t config = {
        .unit = address,
        .mode = soak_is_asked(setting) ? FATHOM_SIM_A16_MODBUS : FATHOM_SIM_A16_UART,
        .seed = seed,
        .scene = *scene,
        .period_us = setting == SOAK_A16_TIGHT ? 1000 : 0}; /* less than a frame: one after the other */
    fathom_sim_a16_init(a16, &config);
    return &a16->device;
}

static fathom_sim_device_t *init_a05(fathom_sim_a05_t *a05, uint8_t setting, uint8_t address,
                                     const fathom_sim_scene_t *scene, uint32_t seed)
{
    const uint8_t proof = soak_facts[setting].proof;
    const fathom_sim_a05_config_t config = {.unit = address,
                                            .mode = proof == SOAK_SUM   ? FATHOM_SIM_A05_DYP
                                                    : proof == SOAK_CRC ? FATHOM_SIM_A05_MODBUS
                                                                        : FATHOM_SIM_A05_AUTO,
                                            .seed = seed,
                                            .scene = *scene,
                                            .period_us = setting == SOAK_A05_TIGHT ? 1000 : 0};
    fathom_sim_a05_init(a05, &config);
    return &a05->device;
}

fathom_sim_device_t *soak_device_init(soak_device_t *device, uint8_t setting, uint8_t address,
                                      const fathom_sim_scene_t *scene, uint32_t seed)
{
    if (soak_facts[setting].model == FATHOM_A16) return init_a16(&device->a16, setting, address, scene, seed);
    if (soak_facts[setting].model == FATHOM_A05) return init_a05(&device->a05, setting, address, scene, seed);
    const fathom_sim_hps167s_config_t config = {.unit = address, .seed = seed, .scene = *scene};
    fathom_sim_hps167s_init(&device->hps167s, &config);
    return &device->hps167s.device;
}

static fathom_sensor_t init_stream(soak_driver_t *driver, uint8_t setting, fathom_line_t *line,
                                   const soak_options_t *options)
{
    if (soak_facts[setting].model == FATHOM_A16) {
        const fathom_a16_auto_config_t config = {.line = line,
                                                 .stale_us = options->stale_us,
                                                 .gap_us = options->gap_us,
                                                 .window = {.max_mm = options->max_mm}};
        (void)fathom_a16_auto_init(&driver->a16_auto, &config);
        return fathom_a16_auto_sensor(&driver->a16_auto);
    }
    const fathom_a05_auto_config_t config = {.line = line,
                                             .stale_us = options->stale_us,
                                             .gap_us = options->gap_us,
                                             .window = {.max_mm = options->max_mm}};
    (void)fathom_a05_auto_init(&driver->a05_auto, &config);
    return fathom_a05_auto_sensor(&driver->a05_auto);
}

static fathom_sensor_t init_dyp(fathom_a05_dyp_t *driver, uint8_t setting, uint8_t address,
                                fathom_line_t *line, const soak_options_t *options)
{
    const fathom_a05_dyp_config_t config = {.line = line,
                                            .backoff_us = options->backoff_us,
                                            .window = {.max_mm = options->max_mm},
                                            .address = address,
                                            .retries = options->retries,
                                            .probes = setting == SOAK_A05_DYP_ONE ? 1 << 2 : 0};
    (void)fathom_a05_dyp_init(driver, &config);
    return fathom_a05_dyp_sensor(driver);
}

fathom_sensor_t soak_driver_init(soak_driver_t *driver, uint8_t setting, uint8_t address, fathom_line_t *line,
                                 const fathom_modbus_t *modbus, const fathom_clock_t *clock,
                                 const soak_options_t *options)
{
    memset(driver, 0, sizeof *driver);
    if (!soak_is_asked(setting)) return init_stream(driver, setting, line, options);
    if (soak_facts[setting].proof == SOAK_SUM)
        return init_dyp(&driver->a05_dyp, setting, address, line, options);
    if (setting == SOAK_HPS167S) {
        const fathom_hps167s_config_t config = {.modbus = modbus,
                                                .clock = clock,
                                                .backoff_us = options->backoff_us,
                                                .address = address,
                                                .retries = options->retries};
        (void)fathom_hps167s_init(&driver->hps167s, &config);
        return fathom_hps167s_sensor(&driver->hps167s);
    }
    if (setting == SOAK_A05_MODBUS) {
        const fathom_a05_modbus_config_t config = {.modbus = modbus,
                                                   .clock = clock,
                                                   .backoff_us = options->backoff_us,
                                                   .window = {.max_mm = options->max_mm},
                                                   .address = address,
                                                   .retries = options->retries};
        (void)fathom_a05_modbus_init(&driver->a05_modbus, &config);
        return fathom_a05_modbus_sensor(&driver->a05_modbus);
    }
    const fathom_a16_modbus_config_t config = {.modbus = modbus,
                                               .clock = clock,
                                               .backoff_us = options->backoff_us,
                                               .window = {.max_mm = options->max_mm},
                                               .address = address,
                                               .retries = options->retries,
                                               .value = setting == SOAK_A16_REAL_TIME ? FATHOM_A16_REAL_TIME
                                                                                      : FATHOM_A16_PROCESSED};
    (void)fathom_a16_modbus_init(&driver->a16_modbus, &config);
    return fathom_a16_modbus_sensor(&driver->a16_modbus);
}

static const fathom_dyp_modbus_t *ultrasonic(const soak_driver_t *driver, uint8_t setting)
{
    if (soak_facts[setting].proof == SOAK_SUM) return &driver->a05_dyp.base;
    return setting == SOAK_A05_MODBUS ? &driver->a05_modbus.base : &driver->a16_modbus.base;
}

const fathom_modbus_unit_t *soak_unit_of(const soak_driver_t *driver, uint8_t setting)
{
    if (!soak_is_asked(setting)) return NULL;
    return setting == SOAK_HPS167S ? &driver->hps167s.unit : &ultrasonic(driver, setting)->unit;
}

fathom_stream_t *soak_stream_of(soak_driver_t *driver, uint8_t setting)
{
    if (soak_is_asked(setting)) return NULL;
    return soak_facts[setting].model == FATHOM_A16 ? &driver->a16_auto.base.stream
                                                   : &driver->a05_auto.base.stream;
}

uint16_t soak_implausible(const soak_driver_t *driver, uint8_t setting)
{
    if (setting == SOAK_HPS167S) return driver->hps167s.implausible;
    if (soak_is_asked(setting)) return ultrasonic(driver, setting)->answer.implausible;
    return soak_facts[setting].model == FATHOM_A16 ? driver->a16_auto.base.answer.implausible
                                                   : driver->a05_auto.base.answer.implausible;
}
