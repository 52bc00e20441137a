/* SPDX-License-Identifier: MIT */
/* What the HPS-167S does not take of #6 to #15, what all of them do, and what it counts. */
#include "bench.h"
#include "sim/hps167s.h"
#include "sim/scene.h"

enum { MS = 1000 };

typedef struct {
    bench_t bench;
    fathom_sim_fixed_t fixed;
    fathom_sim_hps167s_t hps;
} stage_t;

static void set(stage_t *stage, fathom_sim_hps167s_config_t config)
{
    bench_init(&stage->bench, &bench_19200);
    stage->fixed.value[0] = 2083;
    config.scene = fathom_sim_fixed(&stage->fixed);
    fathom_sim_hps167s_init(&stage->hps, &config);
    bench_attach(&stage->bench, &stage->hps.device);
}

#define DEFAULTS ((fathom_sim_hps167s_config_t){0})

/* Appends the CRC, by bits (MODBUS over Serial Line 6.2.2), to the `length` bytes of a request and says it. */
static void ask_sealed(stage_t *s, uint8_t *bytes, size_t length)
{
    uint16_t crc = 0xFFFF;
    for (size_t i = 0; i < 8 * length; i++) {
        const uint16_t bit = (uint16_t)((bytes[i / 8] >> (i % 8)) & 1);
        crc = ((crc ^ bit) & 1) != 0 ? (uint16_t)((crc >> 1) ^ 0xA001) : (uint16_t)(crc >> 1);
    }
    bytes[length] = (uint8_t)crc;
    bytes[length + 1] = (uint8_t)(crc >> 8);
    bench_ask(&s->bench, bytes, length + 2, 50 * MS);
}

/* #2 says that all is as it was; its answer has 13 bytes at the address that was. */
static void expect_factory(stage_t *s)
{
    ASK(&s->bench, 30 * MS, 0x01, 0x03, 0x00, 0x02, 0x00, 0x04, 0xE5, 0xC9);
    EXPECT(&s->bench, 0x01, 0x03, 0x08, 0xFF, 0xFF, 0x00, 0x00, 0x00, 0x00, 0xB4, 0x01, 0x63, 0x1C);
    assert_int_equal(s->hps.sensor.offset_mm, 0);
    assert_int_equal(s->hps.sensor.filter, 0);
    assert_int_equal(s->hps.device.counters.writes, 0);
    assert_int_equal(s->hps.device.counters.flash_writes, 0);
    assert_int_equal(s->hps.device.counters.resets, 0);
}

static const suite_t suite = {BENCH_ROUNDS};

TEST(a_value_that_a_command_does_not_have_is_exception_3)
{
    static const struct {
        uint8_t address;
        uint16_t value;
    } wrong[] = {{0x0A, 256},   {0x0A, 65535}, {0x10, 0},      {0x10, 33},     {0x10, 257}, {0x10, 65535},
                 {0x12, 1},     {0x12, 0xFE},  {0x12, 0xFF00}, {0x12, 0x01FF}, {0x13, 1},   {0x13, 0xFFFF},
                 {0x13, 0x100}, {0x15, 1},     {0x15, 0xFFFF}, {0x15, 0xFF00}};
    enum { WRONG = sizeof wrong / sizeof wrong[0] };
    stage_t s;
    set(&s, DEFAULTS);
    for (size_t i = 0; i < WRONG; i++) {
        uint8_t bytes[8] = {
            0x01, 0x06, 0x00, wrong[i].address, (uint8_t)(wrong[i].value >> 8), (uint8_t)wrong[i].value};
        ask_sealed(&s, bytes, 6);
        EXPECT(&s.bench, 0x01, 0x86, 0x03, 0x02, 0x61);
    }
    assert_int_equal(s.hps.device.counters.exceptions, WRONG);
    assert_int_equal(s.hps.device.counters.writes_refused, WRONG);
    expect_factory(&s);
}

TEST(which_exception_a_wrong_value_is_is_an_option)
{
    stage_t s;
    set(&s, (fathom_sim_hps167s_config_t){.wrong_value = 4});
    ASK(&s.bench, 30 * MS, 0x01, 0x06, 0x00, 0x10, 0x00, 0x21, 0x48, 0x17);
    EXPECT(&s.bench, 0x01, 0x86, 0x04, 0x43, 0xA3);
    ASK(&s.bench, 30 * MS, 0x01, 0x10, 0x00, 0x20, 0x00, 0x02, 0x04, 0x00, 0x00, 0x00, 0x11, 0x31, 0xBB);
    EXPECT(&s.bench, 0x01, 0x90, 0x04, 0x4D, 0xC3);
    ASK(&s.bench, 30 * MS, 0x01, 0x06, 0x00, 0x17, 0x00, 0x00, 0x39, 0xCE); /* no such address: as ever */
    EXPECT(&s.bench, 0x01, 0x86, 0x02, 0xC3, 0xA1);
    expect_factory(&s);
}

TEST(a_reconnect_time_is_a_multiple_of_18_in_two_registers)
{
    stage_t s;
    set(&s, DEFAULTS);
    ASK(&s.bench, 30 * MS, 0x01, 0x10, 0x00, 0x20, 0x00, 0x02, 0x04, 0x00, 0x00, 0x01, 0x69, 0x30,
        0x09); /* 361 */
    EXPECT(&s.bench, 0x01, 0x90, 0x03, 0x0C, 0x01);
    ASK(&s.bench, 30 * MS, 0x01, 0x10, 0x00, 0x20, 0x00, 0x02, 0x04, 0x00, 0x00, 0x01, 0x71, 0x30,
        0x03); /* 369, of 9 */
    EXPECT(&s.bench, 0x01, 0x90, 0x03, 0x0C, 0x01);
    ASK(&s.bench, 30 * MS, 0x01, 0x10, 0x00, 0x20, 0x00, 0x02, 0x04, 0xFF, 0xFF, 0xFF, 0xFF, 0xF0,
        0x23); /* 2^32 - 1 is 3 more than a multiple */
    EXPECT(&s.bench, 0x01, 0x90, 0x03, 0x0C, 0x01);
    ASK(&s.bench, 30 * MS, 0x01, 0x10, 0x00, 0x20, 0x00, 0x01, 0x02, 0x01, 0x68, 0xA1,
        0x4E); /* another length */
    EXPECT(&s.bench, 0x01, 0x90, 0x02, 0xCD, 0xC1);
    ASK(&s.bench, 30 * MS, 0x01, 0x10, 0x00, 0x20, 0x00, 0x03, 0x06, 0x00, 0x00, 0x01, 0x68, 0x00, 0x00, 0x67,
        0xCA);
    EXPECT(&s.bench, 0x01, 0x90, 0x02, 0xCD, 0xC1);
    ASK(&s.bench, 30 * MS, 0x01, 0x10, 0x00, 0x20, 0x00, 0x03, 0x04, 0x00, 0x00, 0x01, 0x68, 0xF0,
        0x18); /* its count and its bytes disagree */
    EXPECT(&s.bench, 0x01, 0x90, 0x02, 0xCD, 0xC1);
    ASK(&s.bench, 30 * MS, 0x01, 0x10, 0x00, 0x20, 0x00, 0x02, 0x06, 0x00, 0x00, 0x01, 0x68, 0x00, 0x00, 0xA6,
        0x06);
    EXPECT(&s.bench, 0x01, 0x90, 0x02, 0xCD, 0xC1);
    ASK(&s.bench, 30 * MS, 0x01, 0x10, 0x00, 0x20, 0x01, 0x02, 0x04, 0x00, 0x00, 0x01, 0x68, 0xE1,
        0x09); /* 258 registers, not 2 */
    EXPECT(&s.bench, 0x01, 0x90, 0x02, 0xCD, 0xC1);
    assert_int_equal(s.hps.device.counters.writes_refused, 8);
    expect_factory(&s);
    set(&s, (fathom_sim_hps167s_config_t){.wrong_length = 3});
    ASK(&s.bench, 30 * MS, 0x01, 0x10, 0x00, 0x20, 0x00, 0x01, 0x02, 0x01, 0x68, 0xA1, 0x4E);
    EXPECT(&s.bench, 0x01, 0x90, 0x03, 0x0C, 0x01);
    ASK(&s.bench, 30 * MS, 0x01, 0x10, 0x00, 0x21, 0x00, 0x02, 0x04, 0x00, 0x00, 0x01, 0x68, 0x30,
        0x05); /* another address is no wrong length */
    EXPECT(&s.bench, 0x01, 0x90, 0x02, 0xCD, 0xC1);
    expect_factory(&s);
}

/* Every address 0..0x3F, with a value that all take; the commands of each function stand in `mine`. */
TEST(function_6_has_the_addresses_of_7_to_14_and_no_other)
{
    stage_t s;
    uint32_t obeyed = 0;
    for (uint8_t address = 0; address < 0x40; address++) {
        const bool mine = address == 0x0A || (address >= 0x11 && address <= 0x16);
        uint8_t bytes[8] = {0x01, 0x06, 0x00, address, 0x00, 0x00};
        if (address == 0x10) continue; /* 0 is no address: above */
        set(&s, DEFAULTS);
        ask_sealed(&s, bytes, 6);
        if (mine) {
            bench_expect(&s.bench, bytes, 8);
            obeyed++;
        } else {
            EXPECT(&s.bench, 0x01, 0x86, 0x02, 0xC3, 0xA1);
            expect_factory(&s);
        }
        assert_int_equal(s.hps.device.counters.writes_refused, mine ? 0 : 1);
        assert_int_equal(s.hps.device.counters.resets_refused, address == 0x09 ? 1 : 0);
    }
    assert_int_equal(obeyed, 7);
}

TEST(function_16_has_the_address_of_15_and_no_other)
{
    stage_t s;
    set(&s, DEFAULTS);
    for (uint8_t address = 0; address < 0x40; address++) {
        uint8_t bytes[13] = {0x01, 0x10, 0x00, address, 0x00, 0x01, 0x02, 0x00, 0x00};
        if (address == 0x20) continue;
        ask_sealed(&s, bytes, 9);
        EXPECT(&s.bench, 0x01, 0x90, 0x02, 0xCD, 0xC1);
    }
    ASK(&s.bench, 30 * MS, 0x01, 0x10, 0x01, 0x20, 0x00, 0x02, 0x04, 0x00, 0x00, 0x01, 0x68, 0xFC, 0x59);
    EXPECT(&s.bench, 0x01, 0x90, 0x02, 0xCD, 0xC1);
    assert_int_equal(s.hps.device.counters.resets_refused, 1);
    assert_int_equal(s.hps.device.counters.writes_refused, 64);
    expect_factory(&s);
}

TEST(what_is_written_is_not_to_be_read)
{
    stage_t s;
    set(&s, DEFAULTS);
    for (uint8_t address = 0x0A; address <= 0x20; address++) {
        uint8_t bytes[8] = {0x01, 0x03, 0x00, address, 0x00, 0x01};
        ask_sealed(&s, bytes, 6);
        EXPECT(&s.bench, 0x01, 0x83, 0x02, 0xC0, 0xF1);
    }
    assert_int_equal(s.hps.device.counters.writes_refused, 0);
    expect_factory(&s);
}

TEST(the_longest_write_of_many_is_refused_and_does_no_harm)
{
    uint8_t bytes[255] = {0x01, 0x10, 0x00, 0x20, 0x00, 0x7B, 246}; /* 123 registers */
    stage_t s;
    set(&s, DEFAULTS);
    ask_sealed(&s, bytes, 253);
    EXPECT(&s.bench, 0x01, 0x90, 0x02, 0xCD, 0xC1);
    expect_factory(&s);
}

TEST(a_broadcast_is_obeyed_by_all_and_answered_by_none)
{
    fathom_sim_hps167s_t other;
    stage_t s;
    set(&s, DEFAULTS);
    fathom_sim_hps167s_init(&other, &(fathom_sim_hps167s_config_t){.unit = 2, .seed = 9});
    bench_attach(&s.bench, &other.device);
    ASK(&s.bench, 30 * MS, 0x00, 0x06, 0x00, 0x0A, 0x00, 0x07, 0xE9, 0xDB);
    ASK(&s.bench, 30 * MS, 0x00, 0x06, 0x00, 0x14, 0xFF, 0xF1, 0x48, 0x6B);
    ASK(&s.bench, 30 * MS, 0x00, 0x10, 0x00, 0x20, 0x00, 0x02, 0x04, 0x00, 0x00, 0x01, 0x68, 0xF5, 0x35);
    ASK(&s.bench, 30 * MS, 0x00, 0x06, 0x00, 0x12, 0x00, 0x01, 0xE9, 0xDE); /* refused in silence */
    EXPECT_SILENCE(&s.bench);
    assert_int_equal(s.hps.warm_up_s, 7);
    assert_int_equal(other.warm_up_s, 7);
    assert_int_equal(s.hps.sensor.offset_mm, -15);
    assert_int_equal(other.sensor.offset_mm, -15);
    assert_int_equal(s.hps.reconnect_ms, 360);
    assert_int_equal(other.reconnect_ms, 360);
    assert_true(other.auto_output);
    assert_int_equal(other.device.counters.writes, 3);
    assert_int_equal(other.device.counters.writes_refused, 1);
    ASK(&s.bench, 30 * MS, 0x00, 0x06, 0x00, 0x11, 0x00, 0x03, 0x98, 0x1F); /* and the rate, at once */
    ASK(&s.bench, 30 * MS, 0x02, 0x03, 0x00, 0x04, 0x00, 0x01, 0xC5, 0xF8);
    EXPECT_SILENCE(&s.bench);
    fathom_sim_set_line(&s.bench.line, &(fathom_line_settings_t){115200, FATHOM_PARITY_EVEN, 1},
                        s.bench.now_us);
    ASK(&s.bench, 30 * MS, 0x02, 0x03, 0x00, 0x04, 0x00, 0x01, 0xC5, 0xF8);
    EXPECT(&s.bench, 0x02, 0x03, 0x02, 0x00, 0x4D, 0x3C, 0x71);
    ASK(&s.bench, 30 * MS, 0x01, 0x03, 0x00, 0x04, 0x00, 0x01, 0xC5, 0xCB);
    EXPECT(&s.bench, 0x01, 0x03, 0x02, 0x00, 0x4D, 0x78, 0x71);
    assert_int_equal(other.device.counters.answered, 1);
}

TEST(flash_wears_with_every_write_that_is_obeyed_also_of_what_is_there)
{
    stage_t s;
    set(&s, DEFAULTS);
    for (uint32_t i = 1; i <= 3; i++) {
        ASK(&s.bench, 30 * MS, 0x01, 0x06, 0x00, 0x0A, 0x00, 0x05, 0x69, 0xCB);
        assert_int_equal(s.hps.device.counters.flash_writes, i);
    }
    ASK(&s.bench, 30 * MS, 0x01, 0x10, 0x00, 0x20, 0x00, 0x02, 0x04, 0x00, 0x00, 0x00, 0xB4, 0xF1,
        0xC0); /* 180, which it was */
    assert_int_equal(s.hps.device.counters.flash_writes, 4);
    assert_int_equal(s.hps.device.counters.writes, 4);
    ASK(&s.bench, 30 * MS, 0x01, 0x03, 0x00, 0x09, 0x00, 0x01, 0x54, 0x08); /* #6 is a read */
    assert_int_equal(s.hps.device.counters.flash_writes, 5);
    assert_int_equal(s.hps.device.counters.writes, 4);
}

TEST(the_reset_of_the_interface_brings_back_all_but_12_and_14)
{
    stage_t s;
    set(&s, DEFAULTS);
    ASK(&s.bench, 30 * MS, 0x01, 0x06, 0x00, 0x0A, 0x00, 0x07, 0xE8, 0x0A);
    ASK(&s.bench, 30 * MS, 0x01, 0x06, 0x00, 0x12, 0x00, 0x00, 0x29, 0xCF);
    ASK(&s.bench, 30 * MS, 0x01, 0x06, 0x00, 0x13, 0x00, 0x00, 0x78, 0x0F);
    ASK(&s.bench, 30 * MS, 0x01, 0x06, 0x00, 0x14, 0xFF, 0xF1, 0x49, 0xBA);
    ASK(&s.bench, 30 * MS, 0x01, 0x06, 0x00, 0x16, 0x00, 0x32, 0xE9, 0xDB);
    ASK(&s.bench, 30 * MS, 0x01, 0x10, 0x00, 0x20, 0x00, 0x02, 0x04, 0x00, 0x00, 0x01, 0x68, 0xF1, 0xC9);
    ASK(&s.bench, 30 * MS, 0x01, 0x06, 0x00, 0x10, 0x00, 0x09, 0x48, 0x09);
    bench_forget(&s.bench);
    ASK(&s.bench, 30 * MS, 0x09, 0x03, 0x00, 0x02, 0x00, 0x04, 0xE4, 0x81);
    EXPECT(&s.bench, 0x09, 0x03, 0x08, 0x00, 0x00, 0x07, 0x00, 0x00, 0x01, 0x68, 0x01, 0x01, 0xC0);
    ASK(&s.bench, 30 * MS, 0x09, 0x03, 0x00, 0x09, 0x00, 0x01, 0x55, 0x40);
    EXPECT(&s.bench, 0x09, 0x03, 0x02, 0x00, 0x01, 0x98, 0x45);
    ASK(&s.bench, 30 * MS, 0x01, 0x03, 0x00, 0x02, 0x00, 0x04, 0xE5, 0xC9);
    EXPECT(&s.bench, 0x01, 0x03, 0x08, 0xFF, 0xFF, 0x05, 0x00, 0x00, 0x00, 0xB4, 0x01, 0x63, 0x49);
    assert_int_equal(s.hps.sensor.offset_mm, -15);
    assert_int_equal(s.hps.sensor.filter, 50);
    assert_int_equal(s.hps.device.counters.resets, 1);
    fathom_sim_power_cycle(&s.bench.line, &s.hps.device, 0, s.bench.now_us); /* and it is kept */
    ASK(&s.bench, 30 * MS, 0x01, 0x03, 0x00, 0x02, 0x00, 0x04, 0xE5, 0xC9);
    EXPECT(&s.bench, 0x01, 0x03, 0x08, 0xFF, 0xFF, 0x05, 0x00, 0x00, 0x00, 0xB4, 0x01, 0x63, 0x49);
}
