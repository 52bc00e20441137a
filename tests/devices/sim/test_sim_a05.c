/* SPDX-License-Identifier: MIT */
#include "sim_bench.h"

#define DEFAULTS ((a05_config_t){0})
/* the probes of the examples in A05 3(4)1 */
#define EXAMPLE FIXED(316, 250, 659, 2426)

EACH_BEGINS(set_a05(FATHOM_SIM_A05_MODBUS, EXAMPLE, DEFAULTS))
static const suite_t suite = {BENCH_ROUNDS, .set_up = begins};

TEST(automatic_frame_is_that_of_a05_1_3)
{
    set_a05(FATHOM_SIM_A05_AUTO, FIXED(1000, 2000, 1953, 3562), DEFAULTS);
    hear(320, "FF 03 E8 07 D0 07 A1 0D EA 60");
    COUNTED(.measurements = 4);
}

TEST(automatic_frames_come_every_300_ms_byte_by_byte)
{
    set_a05(FATHOM_SIM_A05_AUTO, FIXED(1000, 2000, 1953, 3562), DEFAULTS);
    const uint32_t start_us = bench.now_us;
    wait_ms(930);
    assert_int_equal(bench.heard, 30);
    for (size_t i = 0; i < 3; i++) {
        ASSERT_SPAN(bench.end_us[10 * i], start_us, (uint32_t)(i + 1) * 300 * MS + 1042,
                    (uint32_t)(i + 1) * 300 * MS + 1042);
        ASSERT_SPAN(bench.end_us[10 * i + 9], start_us, (uint32_t)(i + 1) * 300 * MS + 10417,
                    (uint32_t)(i + 1) * 300 * MS + 10417);
    }
    set_a05(FATHOM_SIM_A05_AUTO, FIXED(1000), (a05_config_t){.period_us = 100 * MS});
    wait_ms(1020);
    COUNTED(.automatic = 10);
}

TEST(a_probe_without_a_target_does_not_touch_the_others)
{
    set_a05(FATHOM_SIM_A05_AUTO, FIXED(1000, FATHOM_SIM_NO_TARGET, FATHOM_SIM_INTERFERENCE, 3562), DEFAULTS);
    hear(320, "FF 03 E8 FF FD FF FE 0D EA DA");
}

TEST(the_first_command_ends_automatic_output_until_power_off)
{
    set_a05(FATHOM_SIM_A05_AUTO, EXAMPLE, DEFAULTS);
    wait_ms(250);
    transact("01 03 01 06 00 01 65 F7", 300,
             "FF 01 3C 00 FA 02 93 09 7A 4E" /* at 300 ms, lingering */
             "01 03 02 01 3C B9 C5");        /* 3(4)1 example 1 */
    hear(5000, "");
    fathom_sim_detach(&bench.line, &bench.a05.device, bench.now_us);
    attach(&bench.a05.device);
    hear(320, "FF 01 3C 00 FA 02 93 09 7A 4E");
}

TEST(a_response_and_a_frame_that_are_due_together_follow_each_other)
{
    int frame_first = 0, response_first = 0;
    /* the request ends at 208.3 ms, the frame is due at 300, the response somewhere between 278 and 338 */
    for (uint32_t probe_us = 80 * MS; probe_us < 130 * MS; probe_us += 500) {
        set_a05(FATHOM_SIM_A05_AUTO, EXAMPLE, (a05_config_t){.probe_us = probe_us});
        wait_ms(200);
        ask("01 03 01 06 00 01 65 F7", 300);
        assert_int_equal(bench.heard, 17);
        if (bench.bytes[0] == 0xFF) {
            frame_first++;
            expect("FF 01 3C 00 FA 02 93 09 7A 4E 01 03 02 01 3C B9 C5");
        } else {
            response_first++;
            expect("01 03 02 01 3C B9 C5 FF 01 3C 00 FA 02 93 09 7A 4E");
        }
        for (size_t i = 1; i < 17; i++) /* one transmitter: characters never overlap */
            assert_true(fathom_elapsed_us(bench.end_us[i], bench.end_us[i - 1]) >= 1041);
    }
    assert_true(frame_first > 10);
    assert_true(response_first > 10);
}

TEST(reads_are_those_of_a05_3_4_1)
{
    set_a05(FATHOM_SIM_A05_MODBUS, FIXED(316, 2331, 0, 0), DEFAULTS);
    transact("01 03 01 06 00 01 65 F7", 150, "01 03 02 01 3C B9 C5"); /* example 1 */
    transact("01 03 01 07 00 01 34 37", 150, "01 03 02 09 1B FE 1F"); /* example 2 */
    bench.fixed = EXAMPLE;
    transact("01 03 01 07 00 03 B5 F6", 350, "01 03 06 00 FA 02 93 09 7A 8F 47"); /* example 3 */
    COUNTED(.measurements = 5);
}

TEST(the_fourth_probe_is_at_0109_though_the_table_calls_it_the_third)
{
    transact("01 03 01 09 00 01 55 F4", 150, "01 03 02 09 7A 3F F7");
    transact("01 03 00 13 00 01 75 CF", 150, "01 03 02 09 7A 3F F7"); /* and at its other address */
}

TEST(all_four_come_in_one_read_at_either_address)
{
    transact("01 03 01 06 00 04 A5 F4", 450, "01 03 08 01 3C 00 FA 02 93 09 7A 06 2A");
    transact("01 03 00 10 00 04 45 CC", 450, "01 03 08 01 3C 00 FA 02 93 09 7A 06 2A");
}

TEST(a_read_takes_about_100_ms_a_probe)
{
    ask("01 03 01 06 00 01 65 F7", 450);
    ASSERT_ANSWERED_IN(87500 + 1042, 100 * MS + 1042);
    forget();
    ask("01 03 01 06 00 04 A5 F4", 450);
    ASSERT_ANSWERED_IN(350 * MS + 1042, 400 * MS + 1042);
}

TEST(what_it_does_not_know_is_silence)
{
    ask("01 03 01 09 00 02 15 F5", 450); /* past the last */
    ask("01 03 00 13 00 02 35 CE", 450);
    ask("01 03 01 06 00 05 64 34", 450);
    ask("01 03 01 06 00 00 A4 37", 450); /* none at all */
    ask("01 03 01 05 00 01 95 F7", 450); /* before the first */
    transact("01 04 01 00 00 01 30 36", 450, "");
    COUNTED(.unserved = 6, .measurements = NONE);
    set_a05(FATHOM_SIM_A05_MODBUS, EXAMPLE, (a05_config_t){.exceptions = true});
    transact("01 03 01 05 00 01 95 F7", 450, "01 83 02 C0 F1");
    transact("01 03 01 09 00 02 15 F5", 450, "01 83 03 01 31");
}

TEST(set_address_is_echoed_and_obeyed_a05_3_4_2)
{
    echoed("01 06 02 00 00 05 48 71", 50);
    transact("05 03 02 00 00 01 84 36", 50, "05 03 02 00 05 89 87");
    transact("01 03 02 00 00 01 85 B2", 50, "");
}

TEST(a_broadcast_is_obeyed_without_a_response)
{
    ask("FF 06 02 00 00 05 5D AF", 300);
    transact("FF 03 01 06 00 01 70 29", 300, "");
    assert_int_equal(bench.a05.device.address, 5);
    COUNTED(.requests = 2);
}

TEST(it_is_deaf_and_silent_until_it_is_up)
{
    set_a05(FATHOM_SIM_A05_MODBUS, EXAMPLE, (a05_config_t){.start_us = 900 * MS});
    transact("01 03 01 06 00 01 65 F7", 880, "");
    COUNTED(.unheard = 8);
    wait_ms(20);
    transact("01 03 01 06 00 01 65 F7", 150, "01 03 02 01 3C B9 C5");
}
