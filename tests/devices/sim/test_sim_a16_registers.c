/* SPDX-License-Identifier: MIT */
/* The registers of the A16 that are written: A16 6(3), 6(4). */
#include "sim_bench.h"

/* 751 mm, or processed 754 mm: examples 1 and 2. */
static void set(uint8_t mode, a16_config_t config)
{
    bench.processed = FIXED(754);
    config.processed = PROCESSED;
    config.linger_us = 1;
    set_a16(mode, 751, config);
}

#define DEFAULTS       ((a16_config_t){0})
#define AUTO_REAL_TIME A16_FRAME     /* 751 mm */
#define AUTO_PROCESSED "FF 02 F2 F3" /* 754 mm */

EACH_BEGINS(set(FATHOM_SIM_A16_MODBUS, DEFAULTS))
static const suite_t suite = {BENCH_ROUNDS, .set_up = begins};

/* What is written is echoed, read back and kept without power, and so is another value. */
static void is_kept(const char *read, const char *write, const char *value, const char *write_other,
                    const char *other)
{
    set(FATHOM_SIM_A16_MODBUS, DEFAULTS);
    echoed(write, 50);
    transact(read, 50, value);
    cycle_power(100, 101);
    transact(read, 50, value);
    echoed(write_other, 50);
    transact(read, 50, other);
}

TEST(polarity_of_example_6_is_echoed_read_back_and_kept)
{
    is_kept("01 03 02 05 00 01 95 B3",                          /* the register */
            "01 06 02 05 00 00 98 73", "01 03 02 00 00 B8 44",  /* negative */
            "01 06 02 05 00 01 59 B3", "01 03 02 00 01 79 84"); /* positive */
}

TEST(threshold_of_the_last_example_is_echoed_read_back_and_kept)
{
    is_kept("01 03 02 06 00 01 65 B3",                          /* the register */
            "01 06 02 06 07 D0 6B DF", "01 03 02 07 D0 BB E8",  /* 2000 mm */
            "01 06 02 06 FF FF 69 C3", "01 03 02 FF FF B9 F4"); /* no range is printed */
}

TEST(data_type_of_example_5_is_echoed_read_back_and_kept)
{
    is_kept("01 03 02 07 00 01 34 73",                          /* the register */
            "01 06 02 07 00 01 F8 73", "01 03 02 00 01 79 84",  /* real-time */
            "01 06 02 07 00 00 39 B3", "01 03 02 00 00 B8 44"); /* processed */
}

TEST(processed_and_real_time_values_are_two)
{
    transact("01 03 01 00 00 01 85 F6", 600, "01 03 02 02 F2 38 A1"); /* example 1 */
    transact(A16_ASKED, 200, A16_RESPONSE);                           /* example 2 */
    bench.a16.device.processed.distance = NULL;                       /* then they are one */
    transact("01 03 01 00 00 01 85 F6", 600, A16_RESPONSE);
}

TEST(automatic_frames_say_the_value_of_the_data_type)
{
    set(FATHOM_SIM_A16_AUTO, DEFAULTS);
    hear(105, AUTO_PROCESSED);
    ask("01 06 02 07 00 01 F8 73", 50);
    forget();
    ask("01 06 02 02 00 01 E8 72", 50);
    forget();
    hear(60, AUTO_REAL_TIME);
    cycle_power(100, 101);
    hear(105, AUTO_REAL_TIME);
    set(FATHOM_SIM_A16_AUTO, (a16_config_t){.real_time = true});
    hear(105, AUTO_REAL_TIME);
}

TEST(a_uart_module_says_what_the_level_of_rx_selects_2_2)
{
    set(FATHOM_SIM_A16_UART, DEFAULTS);
    hear(105, AUTO_PROCESSED);
    set(FATHOM_SIM_A16_UART, (a16_config_t){.real_time = true});
    hear(105, AUTO_REAL_TIME);
}

/* ---- 0x0202 ---- */

TEST(automatic_output_returns_with_the_command_of_example_4)
{
    set(FATHOM_SIM_A16_AUTO, DEFAULTS);
    transact("01 03 02 00 00 01 85 B2", 2000, "01 03 02 00 01 79 84");
    echoed("01 06 02 02 00 01 E8 72", 98);
    wait_ms(210);
    ASSERT_ANSWERED_IN(100 * MS + 1041, 100 * MS + 1043);
    expect(AUTO_PROCESSED AUTO_PROCESSED AUTO_PROCESSED);
    transact("01 03 02 00 00 01 85 B2", 1000, "01 03 02 00 01 79 84"); /* and ends again */
    COUNTED(.writes = 1, .flash_writes = NONE);
}

TEST(a_module_that_still_is_automatic_stays_so)
{
    set(FATHOM_SIM_A16_AUTO, DEFAULTS);
    echoed("01 06 02 02 00 01 E8 72", 50);
    wait_ms(1000);
    assert_in_range(bench.heard, 9 * 4, 10 * 4);
}

TEST(the_controlled_mode_stays_and_no_mode_is_kept)
{
    set(FATHOM_SIM_A16_AUTO, DEFAULTS);
    echoed("01 06 02 02 00 00 29 B2", 1000);
    cycle_power(100, 101);
    hear(105, AUTO_PROCESSED);
    transact("01 03 02 02 00 01 24 72", 1000, ""); /* write-only: no response, and it ends the output */
}

TEST(rs485_has_no_automatic_mode_to_return_to)
{
    echoed("01 06 02 02 00 01 E8 72", 2000);
    assert_int_equal(fathom_sim_due_us(&bench.line, bench.now_us), FATHOM_NO_DEADLINE);
}

#define REFUSED "01 86 03 02 61"
static void refuse_all(void)
{
    ask("01 06 02 00 00 FF C8 32", 50);
    ask("01 06 02 00 01 05 49 E1", 50);
    ask("01 06 02 02 00 02 A8 73", 50);
    ask("01 06 02 02 01 01 E9 E2", 50);
    ask("01 06 02 05 00 02 19 B2", 50);
    ask("01 06 02 05 FF 00 D9 83", 50);
    ask("01 06 02 07 00 02 B8 72", 50);
    ask("01 06 02 07 01 00 38 23", 50);
    COUNTED(.writes = NONE, .flash_writes = NONE, .writes_refused = 8);
}

TEST(a_value_that_a_register_does_not_have_is_silence_or_exception_3)
{
    refuse_all();
    expect("");
    set(FATHOM_SIM_A16_MODBUS, (a16_config_t){.exceptions = true});
    refuse_all();
    expect(REFUSED REFUSED REFUSED REFUSED REFUSED REFUSED REFUSED REFUSED);
    ask("01 06 01 00 00 01 49 F6", 50); /* a distance, and between the registers */
    transact("01 06 02 03 00 01 B9 B2", 50, "01 86 02 C3 A1 01 86 02 C3 A1");
    transact("01 10 02 06 00 01 02 07 D0 86 5A", 50, "01 90 01 8D C0"); /* no function 16 */
    ask("01 03 02 05 00 01 95 B3", 50);
    ask("01 03 02 06 00 01 65 B3", 50);
    transact("01 03 02 07 00 01 34 73", 50, "01 03 02 00 01 79 84 01 03 02 03 E8 B8 FA 01 03 02 00 00 B8 44");
}

TEST(flash_wears_with_each_setting_that_is_kept)
{
    ask("01 06 02 05 00 01 59 B3", 50); /* as it is */
    ask("01 06 02 06 03 E8 68 CD", 50);
    ask("01 06 02 07 00 00 39 B3", 50);
    COUNTED(.flash_writes = 3);
    ask("01 06 02 00 00 05 48 71", 50);
    COUNTED(.flash_writes = 4, .writes = 4);
    forget();
    cycle_power(100, 101);
    transact("05 03 02 00 00 01 84 36", 50, "05 03 02 00 05 89 87");
}

TEST(a_broadcast_is_obeyed_without_a_response)
{
    transact("FF 06 02 06 07 D0 7E 01", 50, "");
    transact("01 03 02 06 00 01 65 B3", 50, "01 03 02 07 D0 BB E8");
}

TEST(a_new_address_is_acknowledged_from_itself_as_an_option)
{
    set(FATHOM_SIM_A16_MODBUS, (a16_config_t){.answers_from_new = true});
    transact("01 06 02 00 00 05 48 71", 50, "05 06 02 00 00 05 49 F5");
    echoed("05 06 02 06 07 D0 6A 5B", 50);
    set(FATHOM_SIM_A16_MODBUS, (a16_config_t){.answers_from_new = true, .answers_broadcast = true});
    transact("FF 06 02 00 00 06 1D AE", 50, "06 06 02 00 00 06 09 C7");
    set(FATHOM_SIM_A16_MODBUS, (a16_config_t){.answers_broadcast = true});
    transact("FF 06 02 00 00 06 1D AE", 50, "01 06 02 00 00 06 08 70");
}
