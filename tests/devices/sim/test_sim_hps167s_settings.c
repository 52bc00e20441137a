/* SPDX-License-Identifier: MIT */
/* Commands #7 to #15 of the HPS-167S: what each takes, responses, changes and keeps. */
#include "sim_bench.h"

#define DEFAULTS ((hps_config_t){0})

/* #2 of the device at `unit`: its eight bytes, of which these are the places. */
enum { TERMINATION, AUTO_OUTPUT, WARM_UP, RECONNECT, BAUD = 7 };
static const uint8_t *configuration(void)
{
    ask("01 03 00 02 00 04 E5 C9", 30);
    assert_true(bench.heard == 13 && is_hex(bench.bytes, "01 03 08"));
    forget();
    return bench.bytes + 3;
}

/* The distance that #5 says. */
static uint32_t distance(void)
{
    ask("01 03 00 08 00 04 C5 CB", 30);
    assert_int_equal(bench.heard, 13);
    forget();
    return bench.bytes[3] * 256u + bench.bytes[4];
}

EACH_BEGINS(set_hps(2083, DEFAULTS))
static const suite_t suite = {BENCH_ROUNDS, .set_up = begins};

/* ---- #7 ---- */

/* After the next power-on it measures no sooner. */
static void acts_from_the_next_power_on(const char *write, uint32_t warm_up_s)
{
    echoed(write, 30);
    assert_int_equal(configuration()[WARM_UP], warm_up_s);
    assert_int_equal(distance(), 2083);
    cycle_power(100, 150); /* 50 ms ago it came */
    assert_int_equal(configuration()[WARM_UP], warm_up_s);
    wait_ms(warm_up_s * 1000 - 150);
    transact("01 03 00 08 00 04 C5 CB", 10, "");
    wait_ms(100);
    assert_int_equal(distance(), 2083);
}

TEST(warm_up_of_tables_21_and_22_acts_from_the_next_power_on)
{
    acts_from_the_next_power_on("01 06 00 0A 00 05 69 CB", 5);
}

TEST(the_longest_warm_up_is_255_s) { acts_from_the_next_power_on("01 06 00 0A 00 FF E9 88", 255); }

/* ---- #8 ---- */

TEST(a_new_address_counts_at_once_and_is_acknowledged_from_the_old_one)
{
    echoed("01 06 00 10 00 05 48 0C", 30);
    transact("01 03 00 04 00 01 C5 CB", 30, "");
    transact("05 03 00 04 00 01 C4 4F", 30, "05 03 02 00 4D 89 B1");
    cycle_power(100, 150);
    transact("05 03 00 04 00 01 C4 4F", 30, "05 03 02 00 4D 89 B1");
}

TEST(a_new_address_is_acknowledged_from_itself_as_an_option)
{
    set_hps(2083, (hps_config_t){.answers_from_new = true});
    transact("01 06 00 10 00 20 89 D7", 30, "20 06 00 10 00 20 8F 66"); /* 32, the highest */
    echoed("20 06 00 0A 00 05 6F 7A", 30);                              /* other responses are as ever */
    transact("20 03 00 09 00 01 52 B9", 30, "01 03 02 00 01 79 84");    /* #6 makes it 1 */
}

/* ---- #9 ---- */

TEST(rate_of_tables_25_and_26_is_echoed)
{
    echoed("01 06 00 11 00 01 18 0F", 30);
    assert_int_equal(configuration()[BAUD], 1);
}

TEST(a_new_rate_counts_from_behind_its_acknowledgement)
{
    static const uint32_t baud[] = {19200, 57600, 115200, 230400};
    static const char *const write[] = {"01 06 00 11 00 01 18 0F", "01 06 00 11 00 02 58 0E",
                                        "01 06 00 11 00 03 99 CE", "01 06 00 11 00 04 D8 0C"};
    for (uint8_t i = 0; i < 16; i++) {
        const uint8_t from = i / 4, to = i % 4;
        set_hps(2083, (hps_config_t){.baud_code = (uint8_t)(from + 1)});
        at_rate(baud[from], FATHOM_PARITY_EVEN);
        echoed(write[to], 30); /* at the old rate */
        if (from != to) {
            transact("01 03 00 04 00 01 C5 CB", 30, "");
            assert_true(bench.hps.device.counters.wrong_settings != 0);
        }
        at_rate(baud[to], FATHOM_PARITY_EVEN);
        assert_int_equal(configuration()[BAUD], to + 1);
        cycle_power(100, 150);
        assert_int_equal(configuration()[BAUD], to + 1);
    }
}

TEST(a_new_rate_counts_from_the_next_power_on_as_an_option)
{
    set_hps(2083, (hps_config_t){.baud_at_power_on = true});
    echoed("01 06 00 11 00 03 99 CE", 30);
    assert_int_equal(configuration()[BAUD], 3); /* said at the old rate */
    cycle_power(100, 150);
    at_rate(115200, FATHOM_PARITY_EVEN);
    assert_int_equal(configuration()[BAUD], 3);
}

TEST(every_other_code_is_19200)
{
    set_hps(2083, (hps_config_t){.baud_code = 4});
    at_rate(230400, FATHOM_PARITY_EVEN);
    echoed("01 06 00 11 00 05 19 CC", 30);
    at_rate(19200, FATHOM_PARITY_EVEN);
    assert_int_equal(configuration()[BAUD], 1);
    set_hps(2083, (hps_config_t){.baud_code = 4});
    at_rate(230400, FATHOM_PARITY_EVEN);
    echoed("01 06 00 11 01 02 59 9E", 30); /* 258, not 2 */
    at_rate(19200, FATHOM_PARITY_EVEN);
    assert_int_equal(configuration()[BAUD], 1);
    echoed("01 06 00 11 00 00 D9 CF", 30);
    assert_int_equal(configuration()[BAUD], 1);
}

TEST(a_lost_acknowledgement_leaves_it_at_the_new_rate)
{
    set_faults(1);
    FAULT(SILENCE, ALWAYS, 2);
    assert_int_equal(configuration()[BAUD], 1); /* frame 1 */
    transact("01 06 00 11 00 03 99 CE", 30, "");
    assert_int_equal(bench.fault.counters[FATHOM_SIM_FAULT_SILENCE], 1);
    transact("01 03 00 02 00 04 E5 C9", 30, "");
    at_rate(115200, FATHOM_PARITY_EVEN);
    assert_int_equal(configuration()[BAUD], 3);
    COUNTED(.answered = 3); /* as it believes */
    assert_int_equal(bench.fault.frames, 3);
}

/* ---- #10, #11 ---- */

static uint32_t measurement_us(void)
{
    ask("01 03 00 08 00 04 C5 CB", 50);
    assert_int_equal(bench.heard, 13);
    forget();
    return fathom_elapsed_us(bench.end_us[0], bench.asked_us) - 573; /* a character is 572.9 us */
}

TEST(measuring_by_itself_ends_with_the_power_on_after_table_27)
{
    echoed("01 06 00 12 00 00 29 CF", 50);
    assert_int_equal(configuration()[AUTO_OUTPUT], 0x00);
    assert_in_range(measurement_us(), 2186, 2500); /* one was ready */
    cycle_power(100, 150);
    assert_int_equal(configuration()[AUTO_OUTPUT], 0x00);
    assert_in_range(measurement_us(), 18518, 18519);
    echoed("01 06 00 12 00 FF 69 8F", 50);
    assert_int_equal(configuration()[AUTO_OUTPUT], 0xFF);
    assert_in_range(measurement_us(), 18518, 18519);
    cycle_power(100, 150);
    assert_int_equal(configuration()[AUTO_OUTPUT], 0xFF);
    assert_in_range(measurement_us(), 2186, 2500);
}

TEST(termination_of_tables_29_and_30_is_switched_at_the_next_power_on)
{
    set_hps(2083, (hps_config_t){.no_termination = true});
    assert_false(bench.hps.terminated);
    echoed("01 06 00 13 00 FF 38 4F", 30);
    assert_int_equal(configuration()[TERMINATION], 0xFF);
    assert_false(bench.hps.terminated);
    cycle_power(100, 150);
    assert_int_equal(configuration()[TERMINATION], 0xFF);
    assert_true(bench.hps.terminated);
    echoed("01 06 00 13 00 00 78 0F", 30);
    assert_int_equal(configuration()[TERMINATION], 0x00);
    assert_true(bench.hps.terminated);
    cycle_power(100, 150);
    assert_false(bench.hps.terminated);
}

/* ---- #12, #13, #14 ---- */

TEST(the_offset_of_the_example_makes_215_mm_200_mm)
{
    set_hps(215, DEFAULTS);
    assert_int_equal(distance(), 215);
    echoed("01 06 00 14 FF F1 49 BA", 30);
    assert_int_equal(distance(), 200);
    cycle_power(100, 150);
    assert_int_equal(distance(), 200);
    echoed("01 06 00 14 FF F1 49 BA", 30); /* the same again */
    assert_int_equal(distance(), 200);
    echoed("01 06 00 14 00 0A 49 C9", 30);
    assert_int_equal(distance(), 225);
}

TEST(offsets_add_up_as_an_option)
{
    set_hps(40000, (hps_config_t){.offset_adds = true});
    ask("01 06 00 14 FF F1 49 BA", 30);
    ask("01 06 00 14 FF F1 49 BA", 30);
    forget();
    assert_int_equal(distance(), 40000 - 30);
    cycle_power(100, 150);
    ask("01 06 00 14 00 06 49 CC", 30);
    forget();
    assert_int_equal(distance(), 40000 - 24);
    ask("01 06 00 14 80 00 A8 0E", 30); /* to the end, and no further */
    ask("01 06 00 14 80 00 A8 0E", 30);
    forget();
    assert_int_equal(distance(), 40000 - 32768);
    for (int i = 0; i < 3; i++) ask("01 06 00 14 7F FF A9 BE", 30);
    forget();
    bench.fixed.value[0] = 1;
    assert_int_equal(distance(), 1 + 32767);
}

TEST(an_offset_moves_distances_and_nothing_else)
{
    set_hps(14, DEFAULTS);
    ask("01 06 00 14 FF F1 49 BA", 30);
    forget();
    assert_int_equal(distance(), 0); /* not 65535 */
    bench.fixed.value[0] = FATHOM_SIM_NO_TARGET;
    assert_int_equal(distance(), 65530);
    for (int32_t mark = 65530; mark <= 65535; mark++) {
        bench.fixed.value[0] = mark;
        assert_int_equal(distance(), mark);
    }
    bench.fixed.value[0] = FATHOM_SIM_FAULT;
    transact("01 03 00 08 00 04 C5 CB", 30, "01 03 08 FF FF 00 00 00 FF FF FF E4 5C");
    ask("01 06 00 14 00 0F 89 CA", 30);
    forget();
    bench.fixed.value[0] = 65529;
    assert_int_equal(distance(), 65529); /* no distance becomes a mark */
}

TEST(a_filter_is_kept)
{
    assert_int_equal(bench.hps.sensor.filter, 0);
    echoed("01 06 00 16 FF 9C 29 97", 30);
    assert_int_equal(bench.hps.sensor.filter, -100);
    cycle_power(100, 150);
    assert_int_equal(bench.hps.sensor.filter, -100);
    echoed("01 06 00 16 7F FF 08 7E", 30); /* "recommended within +-100": no more than that */
    assert_int_equal(bench.hps.sensor.filter, 32767);
    assert_int_equal(distance(), 2083);
}

TEST(settings_are_loaded_from_the_user_or_from_the_factory)
{
    set_hps(215, DEFAULTS);
    ask("01 06 00 14 FF F1 49 BA", 30);
    ask("01 06 00 16 00 32 E9 DB", 30);
    forget();
    echoed("01 06 00 15 00 FF D8 4E", 30);
    COUNTED(.resets = 1);
    assert_int_equal(distance(), 215);
    assert_int_equal(bench.hps.sensor.filter, 0);
    cycle_power(100, 150); /* "they will not be lost when the power is turned off" */
    assert_int_equal(distance(), 215);
    echoed("01 06 00 15 00 00 98 0E", 30);
    COUNTED(.resets = 1);
    assert_int_equal(distance(), 200);
    assert_int_equal(bench.hps.sensor.filter, 50);
    cycle_power(100, 150);
    assert_int_equal(distance(), 200);
    assert_int_equal(configuration()[AUTO_OUTPUT], 0xFF); /* the interface's are another matter */
}

/* ---- #15 ---- */

TEST(reconnect_time_is_acknowledged_as_in_table_38_with_its_high_word_first)
{
    transact("01 10 00 20 00 02 04 00 00 01 68 F1 C9", 30, "01 10 00 20 00 02 40 02"); /* 360 ms */
    assert_true(is_hex(configuration() + RECONNECT, "00 00 01 68"));
    transact("01 10 00 20 00 02 04 00 01 00 02 21 B6", 30, "01 10 00 20 00 02 40 02"); /* 65538 = 3641 * 18 */
    assert_true(is_hex(configuration() + RECONNECT, "00 01 00 02"));
    cycle_power(100, 150);
    assert_true(is_hex(configuration() + RECONNECT, "00 01 00 02"));
    transact("01 10 00 20 00 02 04 00 00 00 00 F1 B7", 30, "01 10 00 20 00 02 40 02");
    assert_true(is_hex(configuration() + RECONNECT, "00 00 00 00"));
}
