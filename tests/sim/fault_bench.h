/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_SIM_FAULT_BENCH_H
#define FATHOM_TESTS_SIM_FAULT_BENCH_H

/* What the tests of the faults share: one sensor of any mode with faults, and a host that notes what its
 * UART says of each byte. CRC and sum are reckoned here, bit by bit, not by the library. */

#include "bench.h"

#include <string.h>

#include "sim/a05.h"
#include "sim/a16.h"
#include "sim/fault.h"
#include "sim/hps167s.h"
#include "sim/scene.h"

enum { MS = 1000, ALWAYS = 1000000, ROOM = 512 };

typedef enum { A16_AUTO, A16_MODBUS, A05_AUTO, A05_MODBUS, A05_DYP, HPS167S } setting_t;

typedef struct {
    bench_t bench;
    fathom_sim_fault_t fault;
    fathom_sim_fixed_t fixed;
    union {
        fathom_sim_a16_t a16;
        fathom_sim_a05_t a05;
        fathom_sim_hps167s_t hps;
    } model;
    fathom_sim_device_t *device;
    /* of the frames since the last look */
    size_t count;
    uint8_t bytes[ROOM];
    uint8_t flags[ROOM];
    uint32_t end_us[ROOM];
} stage_t;

/* 751 mm and, for an A05, the probes of A05 1(2). */
static inline void stage_set(stage_t *s, setting_t setting, uint32_t seed)
{
    memset(s, 0, sizeof *s);
    bench_init(&s->bench, setting == HPS167S ? &bench_19200 : &bench_9600);
    s->bench.line.full_duplex = setting == A16_AUTO || setting == A05_AUTO;
    s->fixed = (fathom_sim_fixed_t){{1000, 2000, 1953, 3562}};
    const fathom_sim_scene_t scene = fathom_sim_fixed(&s->fixed);
    if (setting == A16_AUTO || setting == A16_MODBUS) {
        const fathom_sim_a16_config_t config = {
            .mode = setting == A16_AUTO ? FATHOM_SIM_A16_AUTO : FATHOM_SIM_A16_MODBUS, .scene = scene};
        s->fixed.value[0] = 751;
        fathom_sim_a16_init(&s->model.a16, &config);
        s->device = &s->model.a16.device;
    } else if (setting == HPS167S) {
        const fathom_sim_hps167s_config_t config = {.scene = scene};
        s->fixed.value[0] = 2083;
        fathom_sim_hps167s_init(&s->model.hps, &config);
        s->device = &s->model.hps.device;
    } else {
        static const uint8_t modes[] = {[A05_AUTO] = FATHOM_SIM_A05_AUTO,
                                        [A05_MODBUS] = FATHOM_SIM_A05_MODBUS,
                                        [A05_DYP] = FATHOM_SIM_A05_DYP};
        const fathom_sim_a05_config_t config = {.mode = modes[setting], .scene = scene};
        fathom_sim_a05_init(&s->model.a05, &config);
        s->device = &s->model.a05.device;
    }
    fathom_sim_fault_init(&s->fault, seed);
    fathom_sim_fault_attach(&s->fault, &s->bench.line, s->device);
    bench_attach(&s->bench, s->device);
}

/* Lets time pass and notes what came in it, from the beginning of the notes. */
static inline void stage_wait(stage_t *s, uint32_t by_us)
{
    const uint8_t all =
        FATHOM_RX_TIMED | FATHOM_RX_SILENCE | FATHOM_RX_PARITY | FATHOM_RX_FRAMING | FATHOM_RX_OVERRUN;
    s->bench.now_us += by_us;
    s->count = 0;
    for (;;) {
        fathom_rx_t rx = {0, 0};
        uint8_t byte;
        if (fathom_sim_transmit_timed(&s->bench.line, s->bench.now_us, &byte, 1, all, &rx) == 0) return;
        assert_true(s->count < ROOM);
        s->bytes[s->count] = byte;
        s->flags[s->count] = rx.flags & (FATHOM_RX_PARITY | FATHOM_RX_FRAMING | FATHOM_RX_OVERRUN);
        s->end_us[s->count++] = rx.last_us;
    }
}

static inline void stage_ask(stage_t *s, const uint8_t *request, size_t count, uint32_t by_us)
{
    const uint32_t end_us = bench_say(&s->bench, request, count);
    stage_wait(s, fathom_elapsed_us(end_us, s->bench.now_us) + by_us);
}

static inline void stage_expect(const stage_t *s, const uint8_t *bytes, size_t count)
{
    assert_int_equal(s->count, count);
    assert_memory_equal(s->bytes, bytes, count);
}

/* The frame of each setting but A05_MODBUS, undamaged: A16 5(3), 6; A05 1(2), 2(3)3, 3(4); HPS-167S #5. */
static const struct {
    uint8_t request[8];
    uint8_t asked; /* bytes of it; 0: it sends by itself */
    uint8_t frame[13];
    uint8_t length;
    uint32_t wait_us; /* holds one frame, also a delayed one */
} golden[] = {
    /* FF + 02 + EF = 1F0 */
    [A16_AUTO] = {{0}, 0, {0xFF, 0x02, 0xEF, 0xF0}, 4, 100 * MS},
    [A16_MODBUS] = {{0x01, 0x03, 0x01, 0x01, 0x00, 0x01, 0xD4, 0x36},
                    8,
                    {0x01, 0x03, 0x02, 0x02, 0xEF, 0xF8, 0xA8},
                    7,
                    200 * MS},
    [A05_AUTO] = {{0}, 0, {0xFF, 0x03, 0xE8, 0x07, 0xD0, 0x07, 0xA1, 0x0D, 0xEA, 0x60}, 10, 300 * MS},
    [A05_DYP] = {{0x55, 0xAA, 0x01, 0x01, 0x01},
                 5,
                 {0x55, 0xAA, 0x01, 0x01, 0x03, 0xE8, 0x07, 0xD0, 0x07, 0xA1, 0x0D, 0xEA, 0x62},
                 13,
                 300 * MS},
    [HPS167S] = {{0x01, 0x03, 0x00, 0x08, 0x00, 0x04, 0xC5, 0xCB},
                 8,
                 {0x01, 0x03, 0x08, 0x08, 0x23, 0xDC, 0xB2, 0x07, 0x01, 0x00, 0x00, 0xFD, 0x41},
                 13,
                 100 * MS},
};

/* The next frame of the setting, or what a fault has made of it. */
static inline void stage_next(stage_t *s, setting_t setting)
{
    if (golden[setting].asked != 0)
        stage_ask(s, golden[setting].request, golden[setting].asked, golden[setting].wait_us);
    else /* in the middle of a period: a frame and its neighbourhood */
        stage_wait(s, s->fault.frames == 0 ? golden[setting].wait_us + 50 * MS : golden[setting].wait_us);
}

static inline void expect_golden(const stage_t *s, setting_t setting)
{
    stage_expect(s, golden[setting].frame, golden[setting].length);
}

/* ---- checksums ---- */

static inline bool crc_is_right(const uint8_t *bytes, size_t count)
{
    uint32_t crc = 0xFFFF; /* MODBUS over Serial Line 6.2.2, bit by bit */
    for (size_t i = 0; i + 2 < count; i++) {
        crc ^= bytes[i];
        for (int bit = 0; bit < 8; bit++) crc = (crc & 1) != 0 ? (crc >> 1) ^ 0xA001 : crc >> 1;
    }
    return count > 2 && bytes[count - 2] == (crc & 0xFF) && bytes[count - 1] == crc >> 8;
}

static inline bool sum_is_right(const uint8_t *bytes, size_t count)
{
    uint32_t sum = 0;
    for (size_t i = 0; i + 1 < count; i++) sum += bytes[i];
    return count > 1 && bytes[count - 1] == (sum & 0xFF);
}

#define EXPECT_BYTES(s, ...) stage_expect((s), LITERAL(__VA_ARGS__))
#define HITS(s, kind)        ((s)->fault.counters[FATHOM_SIM_FAULT_##kind])
#define BIT(kind)            FATHOM_SIM_FAULT_BIT(FATHOM_SIM_FAULT_##kind)
#define ADD(s, kind, ...)    fathom_sim_fault_add(&(s)->fault, FATHOM_SIM_FAULT_##kind, __VA_ARGS__)

#endif
