/* SPDX-License-Identifier: MIT */
#include "sim_bench.h"

/* The 55 AA protocol of the A05 (A05 2(3)). 55 + AA is FF, so a sum is that of the rest less 1. */

#define DEFAULTS ((a05_config_t){0})
#define ALL      FIXED(1000, 2000, 1953, 3562) /* of the example in A05 2(3)3 */

EACH_BEGINS(set_a05(FATHOM_SIM_A05_DYP, ALL, DEFAULTS))
static const suite_t suite = {BENCH_ROUNDS, .set_up = begins};

TEST(all_probes_are_those_of_a05_2_3_3_whose_sum_is_62_not_60)
{
    transact("55 AA 01 01 01", 300, "55 AA 01 01 03 E8 07 D0 07 A1 0D EA 62");
    COUNTED(.measurements = 4, .requests = 1, .answered = 1);
}

TEST(one_probe_is_that_of_a05_2_3_4_and_the_others_follow)
{
    set_a05(FATHOM_SIM_A05_DYP, FIXED(1953, 2000, 1000, 3562), DEFAULTS);
    transact("55 AA 01 10 10", 150, "55 AA 01 10 07 A1 B8");
    transact("55 AA 01 11 11", 150, "55 AA 01 11 07 D0 E8"); /* 01 + 11 + 07 + D0 - 1 */
    transact("55 AA 01 12 12", 150, "55 AA 01 12 03 E8 FD"); /* 01 + 12 + 03 + E8 - 1 */
    transact("55 AA 01 13 13", 150, "55 AA 01 13 0D EA 0A"); /* 01 + 13 + 0D + EA - 1 = 10A */
    COUNTED(.measurements = 4);
}

TEST(no_target_and_interference_are_sent_as_in_the_other_modes)
{
    set_a05(FATHOM_SIM_A05_DYP, FIXED(FATHOM_SIM_NO_TARGET, FATHOM_SIM_INTERFERENCE, 1, 2), DEFAULTS);
    transact("55 AA 01 10 10", 150, "55 AA 01 10 FF FD 0C"); /* 01 + 10 + FF + FD - 1 = 20C */
    transact("55 AA 01 11 11", 150, "55 AA 01 11 FF FE 0E"); /* 01 + 11 + FF + FE - 1 = 20E */
}

/* The spread of the first byte's end less its own 1042 us, over many seeds. */
static void times(const char *request, uint32_t least_ms, uint32_t most_ms)
{
    uint32_t least_us = UINT32_MAX, most_us = 0;
    for (uint32_t seed = 0; seed < 200; seed++) {
        set_a05(FATHOM_SIM_A05_DYP, ALL, (a05_config_t){.seed = seed * 7919});
        ask(request, 300);
        const uint32_t after_us = fathom_elapsed_us(bench.end_us[0], bench.asked_us) - 1042;
        ASSERT_SPAN(after_us, 0, least_ms * MS, most_ms * MS);
        if (after_us < least_us) least_us = after_us;
        if (after_us > most_us) most_us = after_us;
    }
    assert_true(least_us < (least_ms + 1) * MS);
    assert_true(most_us > (most_ms - 1) * MS);
}

TEST(all_probes_take_200_to_210_ms_and_one_65_to_75_ms)
{
    times("55 AA 01 01 01", 200, 210);
    times("55 AA 01 10 10", 65, 75);
    times("55 AA 01 13 13", 65, 75);
}

TEST(other_times_may_be_set)
{
    set_a05(FATHOM_SIM_A05_DYP, ALL, (a05_config_t){.all_us = 400 * MS, .one_us = 30 * MS});
    ask("55 AA 01 01 01", 500);
    ASSERT_ANSWERED_IN(390 * MS + 1042, 400 * MS + 1042);
    forget();
    ask("55 AA 01 10 10", 100);
    ASSERT_ANSWERED_IN(20 * MS + 1042, 30 * MS + 1042);
}

TEST(it_measures_when_it_answers_and_is_deaf_until_then)
{
    ask("55 AA 01 10 10", 30);
    bench.fixed.value[0] = 1953;
    transact("55 AA 01 11 11", 200, "55 AA 01 10 07 A1 B8");
    COUNTED(.unheard = 5);
}

TEST(set_address_is_answered_with_its_own_bytes_a05_2_3_5)
{
    echoed("55 AA 05 03 07", 50);
    COUNTED(.writes = 1);
    transact("55 AA 01 10 10", 300, ""); /* the old one */
    COUNTED(.others = 1);
    transact("55 AA 05 11 15", 300, "55 AA 05 11 07 D0 EC");         /* 05 + 11 + 07 + D0 - 1 */
    transact("05 03 02 00 00 01 84 36", 50, "05 03 02 00 05 89 87"); /* and in Modbus */
    echoed("55 AA FE 03 00", 50);                                    /* the highest: FE + 03 - 1 = 100 */
    assert_int_equal(bench.a05.device.address, 0xFE);
}

TEST(every_unit_that_hears_set_address_obeys_it)
{
    fathom_sim_a05_t other;
    set_a05(FATHOM_SIM_A05_DYP, ALL, (a05_config_t){.settings_us = 20 * MS});
    fathom_sim_a05_init(&other,
                        &(a05_config_t){.address = 2, .mode = FATHOM_SIM_A05_DYP, .settings_us = 60 * MS});
    attach(&other.device);
    ask("55 AA 05 03 07", 70);
    assert_int_equal(bench.a05.device.address, 5);
    assert_int_equal(other.device.address, 5);
    expect("55 AA 05 03 07 55 AA 05 03 07");
    /* the second response is a request again to the first unit, which was no longer deaf */
    hear(25, "55 AA 05 03 07");
    COUNTED(.writes = 2);
}

TEST(addresses_00_and_ff_are_refused_in_silence)
{
    ask("55 AA 00 03 02", 300);
    transact("55 AA FF 03 01", 300, "");
    assert_int_equal(bench.a05.device.address, 1);
    COUNTED(.writes = NONE, .unserved = 2);
}

TEST(ff_is_obeyed_and_answered_from_its_own_address_unless_told_not_to)
{
    set_a05(FATHOM_SIM_A05_DYP, ALL, (a05_config_t){.address = 7});
    transact("55 AA FF 11 0F", 300, "55 AA 07 11 07 D0 EE"); /* 07 + 11 + 07 + D0 - 1 */
    transact("FF 03 01 06 00 01 70 29", 300, "");            /* Modbus has its own option */
    set_a05(FATHOM_SIM_A05_DYP, ALL, (a05_config_t){.address = 7, .dyp_silent_broadcast = true});
    transact("55 AA FF 11 0F", 300, "");
    COUNTED(.requests = 1, .unserved = NONE);
    transact("55 AA 07 11 17", 300, "55 AA 07 11 07 D0 EE");
}

TEST(what_it_does_not_know_is_silence_and_counted)
{
    ask("55 AA 01 01 02", 300); /* the sum is 01 */
    ask("55 AA 01 00", 300);    /* the sum of three, but too short */
    ask("55 AA FF", 300);
    COUNTED(.crc_errors = 3);
    ask("55 AA 01 00 00", 300); /* no such command */
    ask("55 AA 01 02 02", 300);
    ask("55 AA 01 0F 0F", 300);
    ask("55 AA 01 14 14", 300);
    ask("55 AA 01 01 00 01", 300);    /* a byte too long */
    ask("55 AA 05 03 00 07", 300);    /* also to set the address */
    ask("55 AA 01 10 07 A1 B8", 300); /* a response */
    COUNTED(.unserved = 7);
    ask("55 AA 02 01 02", 300); /* another unit */
    COUNTED(.others = 1);
    expect("");
    assert_int_equal(bench.a05.device.address, 1);
    COUNTED(.measurements = NONE);
    transact("55 AA 01 10 10", 300, "55 AA 01 10 03 E8 FB"); /* 01 + 10 + 03 + E8 - 1 */
}

TEST(it_speaks_modbus_at_the_same_time)
{
    set_a05(FATHOM_SIM_A05_DYP, FIXED(316, 250, 659, 2426), DEFAULTS);
    transact("01 03 01 07 00 03 B5 F6", 450, "01 03 06 00 FA 02 93 09 7A 8F 47");
    transact("55 AA 01 11 11", 300, "55 AA 01 11 00 FA 0B"); /* 01 + 11 + FA - 1 = 10B */
    echoed("01 06 02 00 00 05 48 71", 50);
    transact("55 AA 05 11 15", 300, "55 AA 05 11 00 FA 0F");
}

TEST(the_other_modes_do_not_speak_it_and_this_one_sends_nothing_by_itself)
{
    hear(5000, "");
    set_a05(FATHOM_SIM_A05_MODBUS, ALL, DEFAULTS);
    ask("55 AA 01 01 01", 300);
    transact("55 AA 05 03 07", 300, "");
    COUNTED(.crc_errors = 2);
    assert_int_equal(bench.a05.device.address, 1);
}
