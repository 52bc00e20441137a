/* SPDX-License-Identifier: MIT */
#include "settings.h"

#include <string.h>

/*
 * Periods, time-outs and response times: a16_modbus.h, a05_modbus.h, a05_dyp.h, hps167s.h, stream.h, and the
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

/* A period of 1 ms is less than a frame: one after the other. */
#define COMMON   .address = address, .seed = seed, .scene = *scene
#define TIGHT(s) .period_us = setting == (s) ? 1000 : 0

fathom_sim_device_t *soak_device_init(soak_device_t *device, uint8_t setting, uint8_t address,
                                      const fathom_sim_scene_t *scene, uint32_t seed)
{
    const uint8_t proof = soak_facts[setting].proof;
    if (soak_facts[setting].model == FATHOM_A16) {
        const uint8_t mode = soak_is_asked(setting) ? FATHOM_SIM_A16_MODBUS : FATHOM_SIM_A16_UART;
        const fathom_sim_a16_config_t config = {COMMON, .mode = mode, TIGHT(SOAK_A16_TIGHT)};
        fathom_sim_a16_init(&device->a16, &config);
        return &device->a16.device;
    }
    if (soak_facts[setting].model == FATHOM_A05) {
        const uint8_t mode = proof == SOAK_SUM   ? FATHOM_SIM_A05_DYP
                             : proof == SOAK_CRC ? FATHOM_SIM_A05_MODBUS
                                                 : FATHOM_SIM_A05_AUTO;
        const fathom_sim_a05_config_t config = {COMMON, .mode = mode, TIGHT(SOAK_A05_TIGHT)};
        fathom_sim_a05_init(&device->a05, &config);
        return &device->a05.device;
    }
    const fathom_sim_hps167s_config_t config = {COMMON};
    fathom_sim_hps167s_init(&device->hps167s, &config);
    return &device->hps167s.device;
}

#define WINDOW .window = {.max_mm = options->max_mm}
#define STREAM .stale_us = stale_us, .gap_us = options->gap_us, WINDOW
#define ASKED  .modbus = {.address = address, .backoff_us = options->backoff_us, .retries = options->retries}

/* The driver of that kind and member, on this line or transport, with its configuration. */
#define DRIVER(kind, on, ...)                                                                                \
    {                                                                                                        \
        const fathom_##kind##_config_t config = {__VA_ARGS__};                                               \
        (void)fathom_##kind##_init(&driver->kind, on, &config);                                              \
        return fathom_##kind##_sensor(&driver->kind);                                                        \
    }

fathom_sensor_t soak_driver_init(soak_driver_t *driver, uint8_t setting, uint8_t address, fathom_line_t *line,
                                 const fathom_modbus_t *modbus, const soak_options_t *options)
{
    const bool is_a16 = soak_facts[setting].model == FATHOM_A16;
    const uint8_t probes = setting == SOAK_A05_DYP_ONE ? 1 << 2 : 0;
    const uint8_t value = setting == SOAK_A16_REAL_TIME ? FATHOM_REAL_TIME : FATHOM_PROCESSED;
    /* the bounds of recovery are of streams that are stale after the time that the setting tells */
    const uint32_t stale_us = options->stale_us != 0 ? options->stale_us : soak_facts[setting].timeout_us;
    memset(driver, 0, sizeof *driver);
    if (!soak_is_asked(setting) && is_a16) DRIVER(a16_auto, line, STREAM)
    if (!soak_is_asked(setting)) DRIVER(a05_auto, line, STREAM)
    if (soak_facts[setting].proof == SOAK_SUM) DRIVER(a05_dyp, line, ASKED, WINDOW, .probes = probes)
    if (setting == SOAK_HPS167S) DRIVER(hps167s, modbus, ASKED)
    if (setting == SOAK_A05_MODBUS) DRIVER(a05_modbus, modbus, ASKED, WINDOW)
    DRIVER(a16_modbus, modbus, ASKED, WINDOW, .value = value)
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
    if (soak_is_asked(setting)) return ultrasonic(driver, setting)->measurement.implausible;
    return soak_facts[setting].model == FATHOM_A16 ? driver->a16_auto.base.measurement.implausible
                                                   : driver->a05_auto.base.measurement.implausible;
}
