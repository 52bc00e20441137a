/* SPDX-License-Identifier: MIT */
#include "sim_bench.h"

#define DEFAULTS ((a16_config_t){0})

EACH_BEGINS(set_a16(FATHOM_SIM_A16_MODBUS, 751, DEFAULTS))
static const suite_t suite = {BENCH_ROUNDS, .set_up = begins};

/* ---- automatic: A16 2, 5 ---- */

TEST(automatic_frame_is_that_of_a16_2_4)
{
    set_a16(FATHOM_SIM_A16_UART, 1953, DEFAULTS);
    hear(110, "FF 07 A1 A7");
    set_a16(FATHOM_SIM_A16_AUTO, 1953, DEFAULTS); /* A16 5(4) */
    hear(110, "FF 07 A1 A7");
}

TEST(automatic_frames_come_every_100_ms_byte_by_byte)
{
    set_a16(FATHOM_SIM_A16_AUTO, 1953, DEFAULTS);
    const uint32_t start_us = bench.now_us;
    for (int i = 0; i < 50; i++) wait_ms(20); /* a loop that comes round every 20 ms */
    wait_ms(5);
    assert_int_equal(bench.heard, 40);
    COUNTED(.automatic = 10);
    for (size_t i = 0; i < 40; i++) {
        /* the first bit at n * 100 ms, then characters of 10 / 9600 s, each rounded up */
        const uint32_t byte_us[] = {1042, 2084, 3125, 4167};
        const uint32_t at_us = (uint32_t)(i / 4 + 1) * 100 * MS + byte_us[i % 4];
        assert_int_equal(fathom_elapsed_us(bench.end_us[i], start_us), at_us);
    }
}

TEST(a_byte_is_not_there_before_its_last_bit)
{
    set_a16(FATHOM_SIM_A16_AUTO, 1953, DEFAULTS);
    wait_us(100 * MS + 1041);
    expect("");
    wait_us(1);
    expect("FF");
    assert_int_equal(fathom_sim_due_us(&bench.line, bench.now_us), 1042);
    wait_us(1041);
    expect("");
    wait_us(1);
    expect("07");
}

TEST(the_period_and_the_start_are_options)
{
    set_a16(FATHOM_SIM_A16_AUTO, 511, (a16_config_t){.period_us = 40 * MS, .start_us = 900 * MS});
    hear(940, "");
    wait_us(80 * MS + 5 * MS);
    expect("FF 01 FF FF FF 01 FF FF FF 01 FF FF");
}

TEST(no_target_and_interference_are_fffd_and_fffe)
{
    set_a16(FATHOM_SIM_A16_AUTO, FATHOM_SIM_NO_TARGET, DEFAULTS);
    hear(110, "FF FF FD FB");
    bench.fixed.value[0] = FATHOM_SIM_INTERFERENCE;
    hear(100, "FF FF FE FC");
    bench.fixed.value[0] = 0; /* any number can be said */
    hear(100, "FF 00 00 FF");
    bench.a16.device.scene.distance = NULL;
    hear(100, "FF FF FD FB");
}

/* ---- automatic, then Modbus: A16 5 ---- */

TEST(the_first_command_ends_automatic_output_with_frames_around_the_response)
{
    set_a16(FATHOM_SIM_A16_AUTO, 751, DEFAULTS);
    wait_ms(50);
    transact(A16_ASKED, 300,
             A16_FRAME           /* at 100 ms, not stopped yet */
                 A16_RESPONSE    /* the response, A16 6(4) example 2, about 175 ms */
                     A16_FRAME); /* at 200 ms, within the 150 ms */
    hear(60000, "");
    assert_int_equal(fathom_sim_due_us(&bench.line, bench.now_us), FATHOM_NO_DEADLINE);
}

TEST(without_lingering_the_command_is_the_end)
{
    set_a16(FATHOM_SIM_A16_AUTO, 751, (a16_config_t){.linger_us = 1});
    hear(105, A16_FRAME);
    transact(A16_ASKED, 1000, A16_RESPONSE);
}

TEST(a_command_is_heard_while_a_frame_leaves_on_two_wires_each_way)
{
    set_a16(FATHOM_SIM_A16_AUTO, 751, (a16_config_t){.linger_us = 1});
    wait_ms(95); /* the request lasts from 95 to 103.3 ms, the frame from 100 to 104.2 */
    transact(A16_ASKED, 1000, A16_FRAME A16_RESPONSE);
}

TEST(only_a_command_for_it_ends_automatic_output)
{
    set_a16(FATHOM_SIM_A16_AUTO, 751, (a16_config_t){.linger_us = 1});
    ask("02 03 01 01 00 01 D4 05", 10); /* another unit's */
    ask("01 03 01 01 00 01 D4 37", 10); /* wrong CRC */
    wait_ms(1000);
    assert_true(bench.heard >= 40);
    forget();
    ask("01 03 02 02 00 01 24 72", 10); /* not even a register */
    forget();
    hear(1000, "");
    COUNTED(.others = 1, .crc_errors = 1, .unserved = 1);
}

TEST(a_uart_module_takes_no_command)
{
    set_a16(FATHOM_SIM_A16_UART, 751, DEFAULTS);
    ask(A16_ASKED, 10);
    hear(400, A16_FRAME A16_FRAME A16_FRAME A16_FRAME);
    COUNTED(.unheard = 8, .requests = NONE);
}

TEST(power_makes_it_automatic_again)
{
    set_a16(FATHOM_SIM_A16_AUTO, 751, (a16_config_t){.linger_us = 1});
    transact(A16_ASKED, 500, A16_RESPONSE);
    fathom_sim_detach(&bench.line, &bench.a16.device, bench.now_us);
    fathom_sim_detach(&bench.line, &bench.a16.device, bench.now_us); /* twice is no error */
    hear(500, "");
    attach(&bench.a16.device);
    hear(110, A16_FRAME);
}

/* ---- Modbus: A16 6 ---- */

TEST(reads_are_those_of_a16_6_4)
{
    set_a16(FATHOM_SIM_A16_MODBUS, 754, DEFAULTS);
    hear(10000, "");
    transact("01 03 01 00 00 01 85 F6", 600, "01 03 02 02 F2 38 A1"); /* example 1, 0x0100 */
    bench.fixed.value[0] = 751;
    transact(A16_ASKED, 600, A16_RESPONSE); /* example 2, 0x0101 */
    bench.fixed.value[0] = FATHOM_SIM_NO_TARGET;
    transact(A16_ASKED, 600, "01 03 02 FF FD 38 35");
    bench.fixed.value[0] = FATHOM_SIM_INTERFERENCE;
    transact(A16_ASKED, 600, "01 03 02 FF FE 78 34");
    COUNTED(.requests = 4, .answered = 4, .measurements = 4);
}

TEST(settings_read_as_from_the_factory)
{
    set_a16(FATHOM_SIM_A16_MODBUS, 754, DEFAULTS);
    transact("01 03 02 00 00 01 85 B2", 30, "01 03 02 00 01 79 84");
    transact("01 03 02 05 00 01 95 B3", 30, "01 03 02 00 01 79 84");
    transact("01 03 02 06 00 01 65 B3", 30, "01 03 02 03 E8 B8 FA");
    transact("01 03 02 07 00 01 34 73", 30, "01 03 02 00 00 B8 44");
    COUNTED(.measurements = NONE);
}

TEST(responses_take_their_time_and_the_seed_decides_which)
{
    uint32_t first_us[3][8];
    for (size_t run = 0; run < 3; run++) {
        set_a16(FATHOM_SIM_A16_MODBUS, 754, (a16_config_t){.seed = run == 2 ? 99 : 7});
        for (size_t i = 0; i < 8; i++) {
            ask(i % 2 == 0 ? "01 03 01 00 00 01 85 F6" : A16_ASKED, 600);
            assert_int_equal(bench.heard, 7);
            /* from the last bit of the request to the last bit of the first byte */
            first_us[run][i] = fathom_elapsed_us(bench.end_us[0], bench.asked_us) - 1042;
            if (i % 2 == 0) assert_in_range(first_us[run][i], 455 * MS, 520 * MS);
            if (i % 2 == 1) assert_in_range(first_us[run][i], 105 * MS, 120 * MS);
            ASSERT_SPAN(bench.end_us[6], bench.end_us[0], 6249, 6251);
            forget();
        }
    }
    assert_memory_equal(first_us[0], first_us[1], sizeof first_us[0]);
    assert_memory_not_equal(first_us[0], first_us[2], sizeof first_us[0]);
}

TEST(the_response_times_are_options)
{
    set_a16(FATHOM_SIM_A16_MODBUS, 754,
            (a16_config_t){.realtime_us = 40 * MS, .processed_us = 1, .settings_us = 200 * MS});
    ask(A16_ASKED, 60);
    ASSERT_ANSWERED_IN(35 * MS + 1042, 40 * MS + 1042);
    forget();
    /* never before it can know that the request has ended: t3.5 */
    ask("01 03 01 00 00 01 85 F6", 60);
    ASSERT_ANSWERED_IN(3646 + 1041, 3646 + 1042);
    forget();
    ask("01 03 02 00 00 01 85 B2", 300);
    ASSERT_ANSWERED_IN(175 * MS + 1042, 200 * MS + 1042);
}

TEST(set_address_is_echoed_and_obeyed_a16_6_4_example_3)
{
    echoed("01 06 02 00 00 05 48 71", 50);
    COUNTED(.writes = 1);
    transact(A16_ASKED, 300, "");
    transact("05 03 01 01 00 01 D5 B2", 300, "05 03 02 02 EF 09 68");
    transact("05 03 02 00 00 01 84 36", 50, "05 03 02 00 05 89 87");
}

TEST(address_ff_is_for_the_broadcast_and_cannot_be_set)
{
    transact("01 06 02 00 00 FF C8 32", 300, "");
    assert_int_equal(bench.a16.device.address, 1);
    COUNTED(.writes = NONE);
}

TEST(a_broadcast_is_obeyed_without_a_response)
{
    transact("FF 06 02 00 00 05 5D AF", 300, "");
    assert_int_equal(bench.a16.device.address, 5);
    COUNTED(.writes = 1);
    transact("FF 03 01 01 00 01 C1 E8", 300, "");
    COUNTED(.requests = 2, .answered = NONE);
}

TEST(a_broadcast_is_answered_from_its_own_address_as_an_option)
{
    set_a16(FATHOM_SIM_A16_MODBUS, 751, (a16_config_t){.address = 5, .answers_broadcast = true});
    transact("FF 03 01 01 00 01 C1 E8", 300, "05 03 02 02 EF 09 68");
}

TEST(what_it_does_not_know_is_silence)
{
    ask("01 03 01 02 00 01 24 36", 600);          /* unknown register */
    ask("01 03 01 00 00 02 C5 F7", 600);          /* two at once */
    ask("01 03 02 02 00 01 24 72", 600);          /* write-only */
    transact("01 04 01 00 00 01 30 36", 600, ""); /* unknown function */
    COUNTED(.requests = 4, .unserved = 4);
}

TEST(exceptions_are_an_option)
{
    set_a16(FATHOM_SIM_A16_MODBUS, 751, (a16_config_t){.exceptions = true});
    transact("01 03 01 02 00 01 24 36", 100, "01 83 02 C0 F1");
    transact("01 03 01 00 00 02 C5 F7", 100, "01 83 03 01 31");
    transact("01 04 01 00 00 01 30 36", 100, "01 84 01 82 C0");
    COUNTED(.exceptions = 3);
}
