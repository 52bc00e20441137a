/* SPDX-License-Identifier: MIT */
#include "sim_bench.h"

bench_t bench;

const uint32_t bench_starts_us[BENCH_STARTS] = {0, UINT32_C(0xFFFF0000), UINT32_C(0xFFF0BDC0),
                                                UINT32_C(0xFFFFF448), UINT32_C(0x7FFFF000)};
uint32_t bench_start_us;

void bench_begin_round(unsigned round) { bench_start_us = bench_starts_us[round]; }

void bench_begin(const fathom_line_settings_t *settings, bool full_duplex)
{
    bench.now_us = bench.asked_us = bench_start_us;
    bench.heard = 0;
    fathom_sim_line_init(&bench.line, settings, bench.now_us);
    bench.line.full_duplex = full_duplex;
}

void attach(fathom_sim_device_t *device) { fathom_sim_attach(&bench.line, device, bench.line.now_us); }

void add_a16(uint8_t mode, a16_config_t config)
{
    config.mode = mode;
    if (config.scene.distance == NULL) config.scene = fathom_sim_fixed(&bench.fixed);
    fathom_sim_a16_init(&bench.a16, &config);
    attach(bench.device = &bench.a16.device);
}

void add_a05(uint8_t mode, a05_config_t config)
{
    config.mode = mode;
    if (config.scene.distance == NULL) config.scene = fathom_sim_fixed(&bench.fixed);
    fathom_sim_a05_init(&bench.a05, &config);
    attach(bench.device = &bench.a05.device);
}

void add_hps(hps_config_t config)
{
    if (config.scene.distance == NULL) config.scene = fathom_sim_fixed(&bench.fixed);
    fathom_sim_hps167s_init(&bench.hps, &config);
    attach(bench.device = &bench.hps.device);
}

void add_hps167(hps167_config_t config)
{
    if (config.scene.distance == NULL) config.scene = fathom_sim_fixed(&bench.fixed);
    fathom_sim_hps167_init(&bench.hps167, &config);
    attach(bench.device = &bench.hps167.device);
}

void set_a16(uint8_t mode, int32_t mm, a16_config_t config)
{
    bench_begin(&bench_9600, mode != FATHOM_SIM_A16_MODBUS);
    bench.fixed = FIXED(mm);
    add_a16(mode, config);
}

void set_a05(uint8_t mode, fathom_sim_fixed_t mm, a05_config_t config)
{
    bench_begin(&bench_9600, mode == FATHOM_SIM_A05_AUTO);
    bench.fixed = mm;
    add_a05(mode, config);
}

void set_hps(int32_t mm, hps_config_t config)
{
    bench_begin(&bench_19200, false);
    bench.fixed = FIXED(mm);
    add_hps(config);
}

void set_hps167(int32_t mm, hps167_config_t config)
{
    bench_begin(&bench_115200, true);
    bench.fixed = FIXED(mm);
    add_hps167(config);
}

void cycle_power(uint32_t off_ms, uint32_t wait_for_ms)
{
    fathom_sim_power_cycle(&bench.line, bench.device, off_ms * MS, bench.now_us);
    hear(wait_for_ms, "");
}

void at_rate(uint32_t baud, uint8_t parity)
{
    const fathom_line_settings_t settings = {baud, parity, 1};
    fathom_sim_set_line(&bench.line, &settings, bench.now_us);
}

void set_faults(uint32_t seed)
{
    fathom_sim_fault_init(&bench.fault, seed);
    fathom_sim_fault_attach(&bench.fault, &bench.line, bench.device);
}

/* ---- what is said and heard ---- */

void wait_us(uint32_t by_us)
{
    enum { MARKS = FATHOM_RX_PARITY | FATHOM_RX_FRAMING | FATHOM_RX_OVERRUN };
    bench.now_us += by_us;
    for (;;) {
        fathom_rx_t rx = {0, 0};
        uint8_t byte;
        if (fathom_sim_transmit_timed(&bench.line, bench.now_us, &byte, 1, FATHOM_RX_TIMED | MARKS, &rx) == 0)
            return;
        assert_true(bench.heard < BENCH_ROOM);
        bench.bytes[bench.heard] = byte;
        bench.flags[bench.heard] = rx.flags & MARKS;
        bench.end_us[bench.heard++] = rx.last_us;
    }
}

void say_bytes(const uint8_t *bytes, size_t count)
{
    assert_int_equal(fathom_sim_receive(&bench.line, bytes, count, bench.now_us), count);
    bench.asked_us = bench.now_us + fathom_sim_span_us(&bench.line.settings, (uint16_t)count);
}

void ask_bytes(const uint8_t *bytes, size_t count, uint32_t by_us)
{
    say_bytes(bytes, count);
    wait_us(fathom_elapsed_us(bench.asked_us, bench.now_us) + by_us);
}

size_t from_hex(const char *hex, uint8_t *bytes, size_t capacity)
{
    static const char digits[] = "0123456789ABCDEF";
    size_t count = 0;
    for (; *hex != '\0'; hex++) {
        if (*hex == ' ') continue;
        const char *const high = strchr(digits, hex[0]);
        const char *const low = hex[1] != '\0' ? strchr(digits, hex[1]) : NULL;
        assert_true(high != NULL && low != NULL && count < capacity);
        bytes[count++] = (uint8_t)((high - digits) * 16 + (low - digits));
        hex++;
    }
    return count;
}

bool is_hex(const uint8_t *bytes, const char *hex)
{
    uint8_t wanted[BENCH_ROOM];
    return memcmp(bytes, wanted, from_hex(hex, wanted, sizeof wanted)) == 0;
}

void say(const char *hex)
{
    uint8_t bytes[BENCH_ROOM];
    say_bytes(bytes, from_hex(hex, bytes, sizeof bytes));
}

void ask(const char *hex, uint32_t by_ms)
{
    uint8_t bytes[BENCH_ROOM];
    ask_bytes(bytes, from_hex(hex, bytes, sizeof bytes), by_ms * MS);
}

uint16_t crc_by_bits(const uint8_t *bytes, size_t length)
{
    uint16_t crc = 0xFFFF;
    for (size_t i = 0; i != 8 * length; i++) {
        const uint16_t bit = (uint16_t)((bytes[i / 8] >> (i % 8)) & 1);
        crc = ((crc ^ bit) & 1) != 0 ? (uint16_t)((crc >> 1) ^ 0xA001) : (uint16_t)(crc >> 1);
    }
    return crc;
}

void ask_sealed(uint8_t *bytes, size_t length, uint32_t by_ms)
{
    const uint16_t crc = crc_by_bits(bytes, length);
    bytes[length] = (uint8_t)crc;
    bytes[length + 1] = (uint8_t)(crc >> 8);
    ask_bytes(bytes, length + 2, by_ms * MS);
}

void ask_in_two(const char *hex, size_t first, uint32_t gap_us)
{
    uint8_t bytes[16];
    const size_t count = from_hex(hex, bytes, sizeof bytes);
    ask_bytes(bytes, first, gap_us);
    ask_bytes(bytes + first, count - first, 0);
}

void heard_bytes(const uint8_t *bytes, size_t count)
{
    assert_int_equal(bench.heard, count);
    assert_memory_equal(bench.bytes, bytes, count);
    forget();
}

void expect_as(const bench_t *before)
{
    assert_true(before->heard >= 7);
    assert_memory_equal(bench.end_us, before->end_us, before->heard * sizeof before->end_us[0]);
    heard_bytes(before->bytes, before->heard);
}

void bench_expect(const char *hex, const char *asked, const char *file, int line)
{
    uint8_t wanted[BENCH_ROOM];
    const size_t count = from_hex(hex, wanted, sizeof wanted);
    if (bench.heard != count || memcmp(bench.bytes, wanted, count) != 0) {
        print_error("%s%s: \"%s\" was expected, and heard was \"", asked, *asked != '\0' ? " asked" : "",
                    hex);
        for (size_t i = 0; i != bench.heard && i != 32; i++) print_error(" %02X", bench.bytes[i]);
        print_error("\", %u bytes\n", (unsigned)bench.heard);
        fail();
    }
    forget();
}

/* ---- counters ---- */

void bench_counted(const fathom_sim_counters_t *counters, const fathom_sim_counters_t *expected,
                   const char *file, int line)
{
    static const char *const names[] = {"requests",       "answered",   "exceptions",     "unserved",
                                        "others",         "crc_errors", "truncated",      "unheard",
                                        "wrong_settings", "automatic",  "writes",         "writes_refused",
                                        "flash_writes",   "resets",     "resets_refused", "measurements"};
    enum { COUNTERS = sizeof(fathom_sim_counters_t) / sizeof(uint32_t) };
    uint32_t is[COUNTERS], should[COUNTERS];
    assert_int_equal(COUNTERS, sizeof names / sizeof names[0]);
    memcpy(is, counters, sizeof is);
    memcpy(should, expected, sizeof should);
    for (size_t i = 0; i != COUNTERS; i++) {
        if (should[i] == 0 || is[i] == (should[i] == NONE ? 0 : should[i])) continue;
        fail_msg("%s:%d: %s is %u", file, line, names[i], (unsigned)is[i]);
    }
}
