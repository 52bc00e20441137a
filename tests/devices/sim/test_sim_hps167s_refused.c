/* SPDX-License-Identifier: MIT */
/* What the HPS-167S does not take of #6 to #15, what all of them do, and what it counts. */
#include "sim_bench.h"

#define DEFAULTS ((hps_config_t){0})

/* #2 says that all is as it was; its response has 13 bytes at the address that was. */
static void expect_factory(void)
{
    transact("01 03 00 02 00 04 E5 C9", 30, "01 03 08 FF FF 00 00 00 00 B4 01 63 1C");
    assert_int_equal(bench.hps.sensor.offset_mm, 0);
    assert_int_equal(bench.hps.sensor.filter, 0);
    COUNTED(.writes = NONE, .flash_writes = NONE, .resets = NONE);
}

EACH_BEGINS(set_hps(2083, DEFAULTS))
static const suite_t suite = {BENCH_ROUNDS, .set_up = begins};

TEST(a_value_that_a_command_does_not_have_is_exception_3)
{
    static const struct {
        uint8_t address;
        uint16_t value;
    } wrong[] = {{0x0A, 256},   {0x0A, 65535}, {0x10, 0},      {0x10, 33},     {0x10, 257}, {0x10, 65535},
                 {0x12, 1},     {0x12, 0xFE},  {0x12, 0xFF00}, {0x12, 0x01FF}, {0x13, 1},   {0x13, 0xFFFF},
                 {0x13, 0x100}, {0x15, 1},     {0x15, 0xFFFF}, {0x15, 0xFF00}};
    enum { WRONG = sizeof wrong / sizeof wrong[0] };
    set_hps(2083, DEFAULTS);
    for (size_t i = 0; i < WRONG; i++) {
        uint8_t bytes[8] = {
            0x01, 0x06, 0x00, wrong[i].address, (uint8_t)(wrong[i].value >> 8), (uint8_t)wrong[i].value};
        ask_sealed(bytes, 6, 50);
        expect("01 86 03 02 61");
    }
    assert_int_equal(bench.hps.device.counters.exceptions, WRONG);
    assert_int_equal(bench.hps.device.counters.writes_refused, WRONG);
    expect_factory();
}

TEST(which_exception_a_wrong_value_is_is_an_option)
{
    set_hps(2083, (hps_config_t){.wrong_value = 4});
    transact("01 06 00 10 00 21 48 17", 30, "01 86 04 43 A3");
    transact("01 10 00 20 00 02 04 00 00 00 11 31 BB", 30, "01 90 04 4D C3");
    transact("01 06 00 17 00 00 39 CE", 30, "01 86 02 C3 A1"); /* no such address: as ever */
    expect_factory();
}

TEST(a_reconnect_time_is_a_multiple_of_18_in_two_registers)
{
    transact("01 10 00 20 00 02 04 00 00 01 69 30 09", 30, "01 90 03 0C 01"); /* 361 */
    transact("01 10 00 20 00 02 04 00 00 01 71 30 03", 30, "01 90 03 0C 01"); /* 369, of 9 */
    transact("01 10 00 20 00 02 04 FF FF FF FF F0 23", 30,
             "01 90 03 0C 01"); /* 2^32 - 1 is 3 more than a multiple */
    transact("01 10 00 20 00 01 02 01 68 A1 4E", 30, "01 90 02 CD C1"); /* another length */
    transact("01 10 00 20 00 03 06 00 00 01 68 00 00 67 CA", 30, "01 90 02 CD C1");
    transact("01 10 00 20 00 03 04 00 00 01 68 F0 18", 30,
             "01 90 02 CD C1"); /* its count and its bytes disagree */
    transact("01 10 00 20 00 02 06 00 00 01 68 00 00 A6 06", 30, "01 90 02 CD C1");
    transact("01 10 00 20 01 02 04 00 00 01 68 E1 09", 30, "01 90 02 CD C1"); /* 258 registers, not 2 */
    COUNTED(.writes_refused = 8);
    expect_factory();
    set_hps(2083, (hps_config_t){.wrong_length = 3});
    transact("01 10 00 20 00 01 02 01 68 A1 4E", 30, "01 90 03 0C 01");
    transact("01 10 00 21 00 02 04 00 00 01 68 30 05", 30,
             "01 90 02 CD C1"); /* another address is no wrong length */
    expect_factory();
}

/* Every address 0..0x3F, with a value that all take; the commands of each function stand in `mine`. */
TEST(function_6_has_the_addresses_of_7_to_14_and_no_other)
{
    uint32_t obeyed = 0;
    for (uint8_t address = 0; address < 0x40; address++) {
        const bool mine = address == 0x0A || (address >= 0x11 && address <= 0x16);
        uint8_t bytes[8] = {0x01, 0x06, 0x00, address, 0x00, 0x00};
        if (address == 0x10) continue; /* 0 is no address: above */
        set_hps(2083, DEFAULTS);
        ask_sealed(bytes, 6, 50);
        if (mine) {
            heard_bytes(bytes, 8);
            obeyed++;
        } else {
            expect("01 86 02 C3 A1");
            expect_factory();
        }
        assert_int_equal(bench.hps.device.counters.writes_refused, mine ? 0 : 1);
        assert_int_equal(bench.hps.device.counters.resets_refused, address == 0x09 ? 1 : 0);
    }
    assert_int_equal(obeyed, 7);
}

TEST(function_16_has_the_address_of_15_and_no_other)
{
    for (uint8_t address = 0; address < 0x40; address++) {
        uint8_t bytes[13] = {0x01, 0x10, 0x00, address, 0x00, 0x01, 0x02, 0x00, 0x00};
        if (address == 0x20) continue;
        ask_sealed(bytes, 9, 50);
        expect("01 90 02 CD C1");
    }
    transact("01 10 01 20 00 02 04 00 00 01 68 FC 59", 30, "01 90 02 CD C1");
    COUNTED(.resets_refused = 1, .writes_refused = 64);
    expect_factory();
}

TEST(what_is_written_is_not_to_be_read)
{
    for (uint8_t address = 0x0A; address <= 0x20; address++) {
        uint8_t bytes[8] = {0x01, 0x03, 0x00, address, 0x00, 0x01};
        ask_sealed(bytes, 6, 50);
        expect("01 83 02 C0 F1");
    }
    COUNTED(.writes_refused = NONE);
    expect_factory();
}

TEST(the_longest_write_of_many_is_refused_and_does_no_harm)
{
    uint8_t bytes[255] = {0x01, 0x10, 0x00, 0x20, 0x00, 0x7B, 246}; /* 123 registers */
    ask_sealed(bytes, 253, 50);
    expect("01 90 02 CD C1");
    expect_factory();
}

TEST(a_broadcast_is_obeyed_by_all_and_answered_by_none)
{
    fathom_sim_hps167s_t other;
    fathom_sim_hps167s_init(&other, &(hps_config_t){.address = 2, .seed = 9});
    attach(&other.device);
    ask("00 06 00 0A 00 07 E9 DB", 30);
    ask("00 06 00 14 FF F1 48 6B", 30);
    ask("00 10 00 20 00 02 04 00 00 01 68 F5 35", 30);
    transact("00 06 00 12 00 01 E9 DE", 30, ""); /* refused in silence */
    assert_int_equal(bench.hps.warm_up_s, 7);
    assert_int_equal(other.warm_up_s, 7);
    assert_int_equal(bench.hps.sensor.offset_mm, -15);
    assert_int_equal(other.sensor.offset_mm, -15);
    assert_int_equal(bench.hps.reconnect_ms, 360);
    assert_int_equal(other.reconnect_ms, 360);
    assert_true(other.auto_output);
    COUNTED_BY(&other.device, .writes = 3, .writes_refused = 1);
    ask("00 06 00 11 00 03 98 1F", 30); /* and the rate, at once */
    transact("02 03 00 04 00 01 C5 F8", 30, "");
    at_rate(115200, FATHOM_PARITY_EVEN);
    transact("02 03 00 04 00 01 C5 F8", 30, "02 03 02 00 4D 3C 71");
    transact("01 03 00 04 00 01 C5 CB", 30, "01 03 02 00 4D 78 71");
    assert_int_equal(other.device.counters.answered, 1);
}

TEST(flash_wears_with_every_write_that_is_obeyed_also_of_what_is_there)
{
    for (uint32_t i = 1; i <= 3; i++) {
        ask("01 06 00 0A 00 05 69 CB", 30);
        assert_int_equal(bench.hps.device.counters.flash_writes, i);
    }
    ask("01 10 00 20 00 02 04 00 00 00 B4 F1 C0", 30); /* 180, which it was */
    COUNTED(.flash_writes = 4, .writes = 4);
    ask("01 03 00 09 00 01 54 08", 30); /* #6 is a read */
    COUNTED(.flash_writes = 5, .writes = 4);
}

TEST(the_reset_of_the_interface_brings_back_all_but_12_and_14)
{
    ask("01 06 00 0A 00 07 E8 0A", 30);
    ask("01 06 00 12 00 00 29 CF", 30);
    ask("01 06 00 13 00 00 78 0F", 30);
    ask("01 06 00 14 FF F1 49 BA", 30);
    ask("01 06 00 16 00 32 E9 DB", 30);
    ask("01 10 00 20 00 02 04 00 00 01 68 F1 C9", 30);
    ask("01 06 00 10 00 09 48 09", 30);
    forget();
    transact("09 03 00 02 00 04 E4 81", 30, "09 03 08 00 00 07 00 00 01 68 01 01 C0");
    transact("09 03 00 09 00 01 55 40", 30, "09 03 02 00 01 98 45");
    transact("01 03 00 02 00 04 E5 C9", 30, "01 03 08 FF FF 05 00 00 00 B4 01 63 49");
    assert_int_equal(bench.hps.sensor.offset_mm, -15);
    assert_int_equal(bench.hps.sensor.filter, 50);
    COUNTED(.resets = 1);
    cycle_power(0, 0); /* and it is kept */
    transact("01 03 00 02 00 04 E5 C9", 30, "01 03 08 FF FF 05 00 00 00 B4 01 63 49");
}
