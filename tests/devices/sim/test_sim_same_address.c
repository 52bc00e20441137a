/* SPDX-License-Identifier: MIT */
/* Several sensors at one address of one pair: all answer, and what they send together is not understood. */
#include "fathom/codec/crc16.h"
#include "sim_bench.h"

static fathom_sim_hps167s_t twin;

static void set(uint32_t seed)
{
    static fathom_sim_fixed_t second = {{1500, 0, 0, 0}};
    set_hps(2083, (hps_config_t){.seed = seed});
    fathom_sim_hps167s_init(
        &twin, &(hps_config_t){.seed = seed != 0 ? seed + 1 : 0, .scene = fathom_sim_fixed(&second)});
    attach(&twin.device);
}

#define MEASURE "01 03 00 08 00 04 C5 CB"
#define FIRST   "01 03 08 08 23 DC B2 07 01 00 00 FD 41"
#define SECOND  "01 03 08 05 DC DC B2 07 01 00 00 33 D7"

/* No run of bytes among those that were heard is a response. */
static bool is_understood(const char *response)
{
    uint8_t bytes[16];
    const size_t length = from_hex(response, bytes, sizeof bytes);
    for (size_t at = 0; at + length <= bench.heard; at++)
        if (is_hex(bench.bytes + at, response)) return true;
    return false;
}

EACH_BEGINS(set(3))
static const suite_t suite = {BENCH_ROUNDS, .set_up = begins};

TEST(two_that_answer_within_each_others_response_are_not_understood)
{
    for (uint32_t seed = 0; seed < 50; seed++) { /* together, or up to 0.3 ms apart, of 7.4 */
        set(seed);
        ask(MEASURE, 50);
        COUNTED(.answered = 1);
        COUNTED_BY(&twin.device, .answered = 1);
        assert_int_equal(bench.heard, 26);
        assert_true(bench.line.counters.collisions >= 13);
        assert_false(is_understood(FIRST));
        assert_false(is_understood(SECOND));
        for (uint8_t from = 0; from < 26; from++)
            for (uint8_t length = 5; from + length <= 26; length++)
                if (length == 5 || length == 8 || length == 13)
                    assert_int_not_equal(fathom_crc16(bench.bytes + from, length), 0);
    }
}

TEST(one_that_loses_power_leaves_the_other_understood)
{
    fathom_sim_power_cycle(&bench.line, &twin.device, 1000 * MS, bench.now_us);
    transact(MEASURE, 50, FIRST);
    fathom_sim_detach(&bench.line, &bench.hps.device, bench.now_us);
    wait_ms(1000);
    transact(MEASURE, 50, SECOND);
}

TEST(a_new_address_for_one_is_one_for_both)
{
    ask("01 06 00 10 00 05 48 0C", 50);
    assert_false(is_understood("01 06 00 10 00 05 48 0C"));
    assert_int_equal(bench.heard, 16);
    assert_int_equal(bench.hps.device.address, 5);
    assert_int_equal(twin.device.address, 5);
}

TEST(one_at_another_rate_is_no_twin)
{
    twin.device.settings.baud = 115200;
    transact(MEASURE, 50, FIRST);
    assert_int_equal(twin.device.counters.requests, 0);
    assert_true(twin.device.counters.wrong_settings != 0);
}

TEST(two_models_collide_as_well)
{
    bench_begin(&bench_9600, false);
    bench.fixed = FIXED(FATHOM_SIM_NO_TARGET);
    add_a16(FATHOM_SIM_A16_MODBUS, (a16_config_t){.seed = 1});
    add_a05(FATHOM_SIM_A05_MODBUS, (a05_config_t){.seed = 2});
    ask("01 03 02 00 00 01 85 B2", 50);
    assert_int_equal(bench.heard, 14);
    assert_true(bench.line.counters.collisions != 0);
    assert_false(is_understood("01 03 02 00 01 79 84"));
    forget();
    transact("01 03 01 06 00 01 65 F7", 200,
             "01 03 02 FF FD 38 35"); /* a register that only one of them has */
}

TEST(the_address_command_of_55_aa_makes_two_of_one_address_that_garble_each_other)
{
    fathom_sim_a05_t second;
    set_a05(FATHOM_SIM_A05_DYP, FIXED(0), (a05_config_t){0});
    fathom_sim_a05_init(&second, &(a05_config_t){.mode = FATHOM_SIM_A05_DYP, .address = 2, .seed = 1});
    attach(&second.device);
    ask("55 AA 05 03 07", 50); /* A05 2(3)5 */
    assert_int_equal(bench.heard, 10);
    assert_false(is_understood("55 AA 05 03 07"));
    assert_int_equal(bench.a05.device.address, 5);
    assert_int_equal(second.device.address, 5);
}
