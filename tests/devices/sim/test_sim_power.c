/* SPDX-License-Identifier: MIT */
/* A power cycle at any moment: what it interrupts, and that a line works on. What is kept stands with each
 * sensor's tests. */
#include "sim_bench.h"

/* An A16 at 1 that needs `start_us`, an A05 at 5, on one pair. */
static void set(uint32_t start_us)
{
    bench_begin(&bench_9600, false);
    bench.fixed = FIXED(751);
    add_a05(FATHOM_SIM_A05_MODBUS, (a05_config_t){.address = 5});
    add_a16(FATHOM_SIM_A16_MODBUS, (a16_config_t){.start_us = start_us});
}

static void cycle(uint32_t off_us)
{
    fathom_sim_power_cycle(&bench.line, bench.device, off_us, bench.now_us);
}

#define OTHER  "05 03 02 00 00 01 84 36"
#define OTHERS "05 03 02 00 05 89 87"

static void expect_both_work(void)
{
    forget();
    transact(OTHER, 200, OTHERS);
    transact(A16_ASKED, 200, A16_RESPONSE);
    assert_int_equal(bench.a16.device.others_on_wire, 0);
    assert_int_equal(bench.a05.device.others_on_wire, 0);
}

EACH_BEGINS(set(0))
static const suite_t suite = {BENCH_ROUNDS, .set_up = begins};

TEST(without_power_it_hears_and_says_nothing)
{
    cycle(1000 * MS);
    for (int i = 0; i < 4; i++) transact(A16_ASKED, 200, ""); /* 833 ms */
    COUNTED(.unheard = 32, .requests = NONE);
    wait_ms(168);
    expect_both_work();
}

TEST(it_starts_anew_when_power_is_back)
{
    set(900 * MS);
    wait_ms(1000);
    cycle(100 * MS);
    wait_ms(985);
    ask(A16_ASKED, 5); /* ends at 993 ms, it is up at 1000 */
    hear(200, "");
    expect_both_work();
}

TEST(power_that_is_back_at_once_still_ends_what_it_was_doing)
{
    ask(A16_ASKED, 50); /* 105..120 ms */
    cycle(0);
    hear(200, "");
    COUNTED(.requests = 1, .answered = NONE);
    expect_both_work();
}

TEST(it_is_cut_off_at_any_moment_of_a_response)
{
    uint8_t response[7];
    from_hex(A16_RESPONSE, response, sizeof response);
    for (uint32_t into_us = 0; into_us < 7300; into_us += 130) { /* seven characters */
        set(0);
        say(A16_ASKED);
        while (!bench.a16.device.sender.on_wire) wait_us(10);
        wait_us(into_us);
        const size_t heard = bench.heard;
        cycle(20 * MS);
        wait_ms(300);
        assert_int_equal(bench.heard, heard); /* nothing of the byte that it was saying */
        assert_memory_equal(bench.bytes, response, heard);
        assert_in_range(heard, into_us / 1042, (into_us + 10) / 1041);
        expect_both_work();
    }
}

TEST(it_hears_nothing_of_a_request_that_it_woke_up_in)
{
    for (uint32_t into_us = 1050; into_us < 8300; into_us += 130) { /* the second character to the eighth */
        set(0);
        say(A16_ASKED);
        wait_us(into_us);
        cycle(into_us % 3 * 100);
        hear(300, "");
        COUNTED_BY(&bench.a05.device, .others = 1); /* who had power heard it */
        expect_both_work();
    }
}

TEST(a_wire_each_way_is_cut_off_as_well)
{
    set_a16(FATHOM_SIM_A16_AUTO, FATHOM_SIM_NO_TARGET, (a16_config_t){0});
    hear(102, "FF"); /* within its second byte */
    cycle(50 * MS);
    hear(145, ""); /* 97 ms with power */
    hear(10, "FF FF FD FB");
    assert_int_equal(bench.a16.device.others_on_wire, 0);
}

TEST(a_neighbour_with_wires_of_its_own_never_heard_it)
{
    fathom_sim_a16_t other;
    set_a16(FATHOM_SIM_A16_AUTO, FATHOM_SIM_NO_TARGET, (a16_config_t){0});
    fathom_sim_a16_init(&other, &(a16_config_t){.mode = FATHOM_SIM_A16_MODBUS, .address = 5});
    attach(&other.device);
    wait_ms(102);
    cycle(1000 * MS);
    forget();
    transact(OTHER, 200, OTHERS);
}

TEST(half_an_hour_is_the_longest)
{
    cycle(UINT32_C(1800000000));
    wait_us(UINT32_C(1799900000));
    transact(A16_ASKED, 50, "");
    wait_ms(100);
    expect_both_work();
}

TEST(an_accident_in_an_acknowledgement_keeps_what_was_set)
{
    set_hps(FATHOM_SIM_NO_TARGET, (hps_config_t){0});
    set_faults(1);
    FAULT(POWER_CYCLE, ALWAYS, 1);
    ask("01 06 00 11 00 03 99 CE", 2100); /* it is off for 2 s */
    assert_true(bench.heard < 8);
    assert_int_equal(bench.fault.counters[FATHOM_SIM_FAULT_POWER_CYCLE], 1);
    forget();
    at_rate(115200, FATHOM_PARITY_EVEN);
    transact("01 03 00 02 00 04 E5 C9", 50, "01 03 08 FF FF 00 00 00 00 B4 03 E2 DD");
}

static void in_steps(uint32_t us, uint32_t step_us)
{
    for (; us > step_us; us -= step_us) wait_us(step_us);
    wait_us(us);
}

/* Asked, set, cut off in its third unasked frame, asked again. */
static void play(uint32_t step_us)
{
    set_hps(FATHOM_SIM_NO_TARGET, (hps_config_t){.unasked_us = 50 * MS});
    say("01 03 00 02 00 04 E5 C9");
    in_steps(60 * MS, step_us);
    say("01 06 00 10 00 05 48 0C");
    in_steps(93100, step_us);
    cycle(30 * MS);
    in_steps(40 * MS, step_us);
    say("05 03 00 08 00 04 C4 4F");
    in_steps(100 * MS, step_us);
    COUNTED(.answered = 3, .automatic = 5);
}

TEST(how_often_it_is_looked_at_changes_nothing)
{
    static bench_t once;
    static const uint32_t steps_us[] = {1, 7, 333, 20 * MS};
    play(200 * MS);
    once = bench;
    for (size_t i = 0; i < sizeof steps_us / sizeof steps_us[0]; i++) {
        play(steps_us[i]);
        expect_as(&once);
    }
}
