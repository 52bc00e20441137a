/* SPDX-License-Identifier: MIT */
#include "sim_bench.h"

#define DEFAULTS ((hps_config_t){0})
#define MEASURE  "01 03 00 08 00 04 C5 CB" /* table 17 */

EACH_BEGINS(set_hps(2083, DEFAULTS))
static const suite_t suite = {BENCH_ROUNDS, .set_up = begins};

TEST(single_measurement_is_that_of_command_5)
{
    transact(MEASURE, 20, "01 03 08 08 23 DC B2 07 01 00 00 FD 41"); /* table 17 */
    COUNTED(.measurements = 1);
}

TEST(the_misprinted_crc_of_the_abnormal_response_is_no_request)
{
    transact("01 03 00 08 00 04 C5 C8", 50, "");
    COUNTED(.crc_errors = 1, .requests = NONE);
}

TEST(sensor_details_are_those_of_command_3)
{
    transact(
        "01 03 00 03 00 0B F4 0D", 30,
        "01 03 16 B0 00 39 00 25 42 34 57 14 20 34 38 35 01 06 07 05 13 09 17 03 09 1A DC"); /* table 13 */
}

TEST(version_configuration_and_temperature_are_those_of_tables_9_11_15)
{
    set_hps(2083, (hps_config_t){.temperature_f = -10});
    transact("01 03 00 01 00 03 54 0B", 30, "01 03 06 14 09 1B 02 01 00 58 D4");
    ask("01 03 00 02 00 04 E5 C9", 30);
    /* FF termination, FF automatic, warm-up 0 s, reconnect 180 ms, rate 1 */
    expect("01 03 08 FF FF 00 00 00 00 B4 01 63 1C");
    transact("01 03 00 04 00 01 C5 CB", 30, "01 03 02 FF F6 79 F2");
    bench.hps.temperature_f = 77;
    transact("01 03 00 04 00 01 C5 CB", 30, "01 03 02 00 4D 78 71");
    COUNTED(.measurements = NONE);
}

TEST(no_target_is_65530_with_little_light)
{
    set_hps(FATHOM_SIM_NO_TARGET, DEFAULTS);
    transact(MEASURE, 30, "01 03 08 FF FA 00 10 00 01 00 00 10 DF");
}

TEST(a_fault_is_the_abnormal_packet_of_command_5)
{
    set_hps(FATHOM_SIM_FAULT, DEFAULTS);
    transact(MEASURE, 30, "01 03 08 FF FF 00 00 00 FF FF FF E4 5C");
}

TEST(the_first_response_comes_at_once_and_the_next_a_period_later)
{
    ask(MEASURE, 12);
    assert_int_equal(bench.heard, 13);
    const uint32_t first_us = bench.end_us[0];
    ASSERT_ANSWERED_IN(2187 + 572, 2500 + 573); /* a character is 572.9 us */
    ASSERT_SPAN(bench.end_us[12], first_us, 6874, 6876);
    forget();
    ask(MEASURE, 30);
    assert_int_equal(bench.heard, 13);
    ASSERT_SPAN(bench.end_us[0], first_us, 18519, 18519);
}

static uint32_t responses_in_10_s(void)
{
    uint32_t responses = 0;
    for (uint32_t us = 0; us < 10000 * MS; us += 100) {
        /* the fastest host there is: t3.5 after the last bit of a response */
        if (us == 0 || (bench.heard == 13 && fathom_elapsed_us(bench.now_us, bench.end_us[12]) >= 2006)) {
            responses += us != 0;
            forget();
            say(MEASURE);
        }
        wait_us(100);
    }
    return responses;
}

TEST(it_measures_54_times_a_second_and_6_times_as_an_option)
{
    assert_in_range(responses_in_10_s(), 538, 540);
    set_hps(2083, (hps_config_t){.period_us = 166667});
    assert_in_range(responses_in_10_s(), 59, 60);
}

TEST(without_automatic_measuring_each_takes_a_period)
{
    set_hps(2083, (hps_config_t){.no_auto_output = true});
    ask(MEASURE, 50);
    assert_int_equal(bench.heard, 13);
    ASSERT_ANSWERED_IN(18519 + 572, 18519 + 573);
}

TEST(it_says_nothing_unless_asked)
{
    assert_int_equal(fathom_sim_due_us(&bench.line, bench.now_us), FATHOM_NO_DEADLINE);
    hear(600000, "");
}

TEST(a_command_with_another_length_is_exception_2)
{
    transact("01 03 00 08 00 03 84 09", 30, "01 83 02 C0 F1"); /* the datasheet's own example */
    transact("01 03 00 08 00 05 04 0B", 30, "01 83 02 C0 F1");
    transact("01 03 00 08 00 00 C4 08", 30, "01 83 02 C0 F1");
    transact("01 03 00 08 01 04 C4 5B", 30, "01 83 02 C0 F1"); /* 260, not 4 */
    COUNTED(.exceptions = 4, .measurements = NONE);
    set_hps(2083, (hps_config_t){.wrong_length = 3});
    transact("01 03 00 08 00 03 84 09", 30, "01 83 03 01 31");
}

TEST(every_length_but_the_right_one_is_refused_at_every_address)
{
    static const uint8_t right[16] = {0, 3, 4, 11, 1, 0, 0, 0, 4, 1, 0, 0, 0, 0, 0, 0};
    set_hps(2083, (hps_config_t){.wrong_length = 3});
    for (uint8_t address = 0; address < 16; address++) {
        for (uint8_t count = 0; count < 16; count++) {
            uint8_t bytes[8] = {0x01, 0x03, 0x00, address, 0x00, count};
            ask_sealed(bytes, 6, 50);
            if (right[address] == 0) {
                expect("01 83 02 C0 F1");
            } else if (right[address] != count) {
                expect("01 83 03 01 31");
            } else {
                assert_int_equal(bench.heard, 5 + 2 * count);
                assert_int_equal(bench.bytes[1], 0x03);
                forget();
            }
        }
    }
    COUNTED(.resets = 1, .resets_refused = 15);
}

TEST(an_unknown_function_is_exception_1_whatever_its_length)
{
    transact("01 04 00 08 00 04 70 0B", 30, "01 84 01 82 C0");
    transact("01 11 C0 2C", 30, "01 91 01 8C 50");
    transact("01 83 02 C0 F1", 30, ""); /* but a response is no request */
}

TEST(factory_reset_is_that_of_tables_19_and_20_and_is_counted)
{
    set_hps(2083, (hps_config_t){.address = 2, .no_termination = true});
    transact("02 03 00 09 00 01 54 3B", 30, "02 03 02 00 01 3D 84");
    COUNTED(.resets = 1);
    /* address 1 again, termination on, warm-up 5 s */
    transact("01 03 00 02 00 04 E5 C9", 30, "01 03 08 FF FF 05 00 00 00 B4 01 63 49");
    transact("01 03 00 09 00 01 54 08", 30, "01 03 02 00 01 79 84");
    COUNTED(.resets = 2);
}

TEST(it_works_at_the_rates_of_command_9_and_leaves_them_after_the_response_to_a_reset)
{
    static const uint32_t baud[] = {19200, 57600, 115200, 230400};
    for (uint8_t code = 1; code <= 4; code++) {
        set_hps(2083, (hps_config_t){.baud_code = code});
        at_rate(baud[code - 1], FATHOM_PARITY_EVEN);
        transact(MEASURE, 30, "01 03 08 08 23 DC B2 07 01 00 00 FD 41");
        ask("01 03 00 02 00 04 E5 C9", 30);
        assert_int_equal(bench.bytes[10], code);
        forget();
        transact("01 03 00 09 00 01 54 08", 30, "01 03 02 00 01 79 84");
        at_rate(19200, FATHOM_PARITY_EVEN);
        transact("01 03 00 04 00 01 C5 CB", 30, "01 03 02 00 4D 78 71");
    }
}

TEST(nothing_else_resets_it)
{
    transact("01 03 00 09 00 02 14 09", 30, "01 83 02 C0 F1");
    transact("01 03 00 09 00 00 95 C8", 30, "01 83 02 C0 F1");
    transact("01 03 00 09 01 01 55 98", 30, "01 83 02 C0 F1");
    transact("01 03 00 08 00 02 45 C9", 30, "01 83 02 C0 F1"); /* reads on past 0x0009 */
    transact("02 03 00 09 00 01 54 3B", 30, "");               /* another unit's */
    COUNTED(.resets = NONE, .resets_refused = 3);
    transact("00 03 00 09 00 01 55 D9", 30, ""); /* to all: done, not answered */
    COUNTED(.resets = 1);
}

TEST(a_broadcast_is_not_answered)
{
    transact("00 03 00 08 00 04 C4 1A", 30, "");
    COUNTED(.requests = 1);
    /* and does not make it busy */
    ask(MEASURE, 30);
    assert_int_equal(bench.heard, 13);
}

TEST(another_unit_is_not_meant)
{
    transact("02 03 00 08 00 04 C5 F8", 30, "");
    COUNTED(.others = 1);
    set_hps(2083, (hps_config_t){.address = 2});
    transact("02 03 00 08 00 04 C5 F8", 30, "02 03 08 08 23 DC B2 07 01 00 00 F2 05");
}

TEST(while_it_warms_up_it_measures_nothing_but_answers_the_rest)
{
    set_hps(2083, (hps_config_t){.warm_up_s = 5});
    wait_ms(4900);
    transact(MEASURE, 30, "");
    COUNTED(.unserved = 1);
    transact("01 03 00 02 00 04 E5 C9", 30, "01 03 08 FF FF 05 00 00 00 B4 01 63 49");
    wait_ms(70);
    ask(MEASURE, 30);
    assert_int_equal(bench.heard, 13);
}

/* ---- silence: HPS-167S 2.2.3 ---- */

TEST(a_gap_up_to_t15_is_none_and_a_longer_one_drops_the_request)
{
    for (size_t first = 1; first < 8; first++) {
        set_hps(2083, DEFAULTS);
        ask_in_two(MEASURE, first, 850); /* t1.5 is 859.4 us */
        wait_ms(30);
        assert_int_equal(bench.heard, 13);
        forget();
        ask_in_two(MEASURE, first, 870);
        hear(30, "");
        COUNTED(.truncated = 1);
        ask_in_two(MEASURE, first, 1990); /* t3.5 is 2005.2 us: still one frame, a bad one */
        hear(30, "");
        COUNTED(.truncated = 2, .crc_errors = NONE);
        ask_in_two(MEASURE, first, 2010); /* two */
        hear(30, "");
        COUNTED(.truncated = 2, .crc_errors = 2);
        /* none of which it remembers */
        ask_in_two(MEASURE, first, 0);
        wait_ms(30);
        assert_int_equal(bench.heard, 13);
    }
}

TEST(a_request_behind_another_one_without_a_silence_is_none)
{
    transact("01 03 00 04 00 01 C5 CB" /* and at once */ MEASURE, 50, "");
    COUNTED(.crc_errors = 1);
    transact("FF 01 03 00 08 00 04 C5 CB", 50, ""); /* noise before it */
    COUNTED(.crc_errors = 2);
}
