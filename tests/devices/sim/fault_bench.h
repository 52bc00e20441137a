/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_SIM_FAULT_BENCH_H
#define FATHOM_TESTS_SIM_FAULT_BENCH_H

/* What the tests of the faults share: the bench with one sensor of any mode, and faults, and that sensor's frame. */

#include "sim_bench.h"

typedef enum { A16_AUTO, A16_MODBUS, A05_AUTO, A05_DYP, HPS167S, SETTINGS, A05_MODBUS = SETTINGS } setting_t;

/* The frame of each setting but A05_MODBUS, undamaged: A16 5(3), 6; A05 1(2), 2(3)3; HPS-167S #5. */
static const struct {
    const char *request; /* NULL: it sends by itself */
    const char *frame;
    uint8_t length;
    uint32_t wait_ms; /* holds one frame, also a delayed one */
} golden[SETTINGS] = {
    [A16_AUTO] = {NULL, A16_FRAME, 4, 100},
    [A16_MODBUS] = {A16_ASKED, A16_RESPONSE, 7, 200},
    [A05_AUTO] = {NULL, "FF 03 E8 07 D0 07 A1 0D EA 60", 10, 300},
    [A05_DYP] = {"55 AA 01 01 01", "55 AA 01 01 03 E8 07 D0 07 A1 0D EA 62", 13, 300},
    [HPS167S] = {"01 03 00 08 00 04 C5 CB", "01 03 08 08 23 DC B2 07 01 00 00 FD 41", 13, 100},
};

/* 751 mm, the probes of A05 1(2), or 2083 mm. */
static inline void set_faulty(setting_t setting, uint32_t seed)
{
    static const uint8_t modes[] = {[A16_AUTO] = FATHOM_SIM_A16_AUTO,
                                    [A16_MODBUS] = FATHOM_SIM_A16_MODBUS,
                                    [A05_AUTO] = FATHOM_SIM_A05_AUTO,
                                    [A05_DYP] = FATHOM_SIM_A05_DYP,
                                    [A05_MODBUS] = FATHOM_SIM_A05_MODBUS};
    if (setting == HPS167S)
        set_hps(2083, (hps_config_t){0});
    else if (setting == A16_AUTO || setting == A16_MODBUS)
        set_a16(modes[setting], 751, (a16_config_t){0});
    else
        set_a05(modes[setting], FIXED(1000, 2000, 1953, 3562), (a05_config_t){0});
    set_faults(seed);
}

/* The next frame of the setting, or what a fault has made of it, and nothing from before. */
static inline void next(setting_t setting)
{
    forget();
    if (golden[setting].request != NULL)
        ask(golden[setting].request, golden[setting].wait_ms);
    else /* in the middle of a period: a frame and its neighbourhood */
        wait_ms(golden[setting].wait_ms + (bench.fault.frames == 0 ? 50 : 0));
}

static inline void next_is_golden(setting_t setting)
{
    next(setting);
    expect(golden[setting].frame);
}

static inline bool crc_is_right(void)
{
    return bench.heard > 2 && crc_by_bits(bench.bytes, bench.heard) == 0;
}

static inline bool sum_is_right(void)
{
    uint8_t sum = 0;
    for (size_t i = 0; i + 1 < bench.heard; i++) sum = (uint8_t)(sum + bench.bytes[i]);
    return bench.heard > 1 && bench.bytes[bench.heard - 1] == sum;
}

#define HITS(kind) (bench.fault.counters[FATHOM_SIM_FAULT_##kind])
#define BIT(kind)  FATHOM_SIM_FAULT_BIT(FATHOM_SIM_FAULT_##kind)

#endif
