/* SPDX-License-Identifier: MIT */
#include "sim_bench.h"

static void set(uint8_t mode)
{
    bench_begin(&bench_9600, false);
    bench.fixed = FIXED(751);
    add_a16(mode, (a16_config_t){.linger_us = 1});
}

EACH_BEGINS(set(FATHOM_SIM_A16_MODBUS))
static const suite_t suite = {BENCH_ROUNDS, .set_up = begins};

TEST(every_flipped_bit_is_met_with_silence)
{
    for (size_t bit = 0; bit < 64; bit++) {
        uint8_t bytes[8];
        from_hex(A16_ASKED, bytes, 8);
        bytes[bit / 8] = (uint8_t)(bytes[bit / 8] ^ (1u << (bit % 8)));
        ask_bytes(bytes, 8, 200 * MS);
    }
    expect("");
    COUNTED(.crc_errors = 64);
    transact(A16_ASKED, 200, A16_RESPONSE);
}

TEST(every_truncated_request_is_met_with_silence)
{
    uint8_t bytes[8];
    from_hex(A16_ASKED, bytes, 8);
    for (size_t length = 1; length < 8; length++) ask_bytes(bytes, length, 200 * MS);
    expect("");
    COUNTED(.crc_errors = 7, .requests = NONE);
}

TEST(garbage_of_any_length_is_met_with_silence)
{
    uint8_t garbage[256];
    uint32_t random = 1;
    for (size_t length = 1; length <= 256; length++) {
        for (size_t i = 0; i < length; i++) {
            random = (uint32_t)(random * UINT32_C(1103515245) + 12345u);
            garbage[i] = (uint8_t)(random >> 16);
        }
        ask_bytes(garbage, length, 5 * MS);
    }
    expect("");
    COUNTED(.crc_errors = 255, .truncated = 1); /* 256 bytes are longer than any frame */
    transact(A16_ASKED, 200, A16_RESPONSE);
}

TEST(a_right_crc_does_not_make_a_request_of_another_length)
{
    ask("01 03 01 01 00 01 00 36 5F", 200); /* 9 bytes */
    ask(A16_RESPONSE, 200);                 /* a response, 7 bytes */
    transact("01 83 02 C0 F1", 200, "");    /* an exception */
    COUNTED(.unserved = 3, .measurements = NONE);
}

TEST(the_crc_of_nothing_is_no_broadcast)
{
    set(FATHOM_SIM_A16_AUTO);
    ask("FF FF", 10);    /* the CRC of no bytes is FF FF */
    ask("01 7E 80", 10); /* an address and its CRC */
    COUNTED(.crc_errors = 2, .requests = NONE);
    wait_ms(1000);
    assert_true(bench.a16.device.counters.automatic >= 10);
}

TEST(frames_are_divided_by_t35_and_an_a16_minds_no_shorter_gap)
{
    for (size_t first = 1; first < 8; first++) {
        ask_in_two(A16_ASKED, first, 3600); /* t3.5 is 3645.8 us */
        hear(200, A16_RESPONSE);
        ask_in_two(A16_ASKED, first, 3700);
        hear(200, "");
    }
    COUNTED(.crc_errors = 14);
}

TEST(a_device_hears_nothing_while_it_serves_a_request)
{
    ask(A16_ASKED, 20);
    ask(A16_ASKED, 20); /* it is measuring */
    COUNTED(.unheard = 8);
    hear(500, A16_RESPONSE); /* one */
    COUNTED(.requests = 1);
}

TEST(a_frame_that_ends_before_the_response_does_not_let_it_listen)
{
    set(FATHOM_SIM_A16_AUTO);
    bench.line.full_duplex = true;
    wait_ms(89); /* the request is known at 101 ms, in the frame of 100..104.2 */
    ask(A16_ASKED, 20);
    assert_int_equal(bench.heard, 4);
    COUNTED(.requests = 1);
    ask(A16_ASKED, 20); /* before the response */
    COUNTED(.unheard = 8);
    hear(500, A16_FRAME A16_RESPONSE);
    COUNTED(.requests = 1);
}

TEST(a_request_that_begins_during_a_response_is_lost_with_it)
{
    ask(A16_ASKED, 5);
    while (bench.heard < 3) wait_us(100);
    ask(A16_ASKED, 500);
    assert_int_equal(bench.heard, 7);
    COUNTED(.requests = 1);
    assert_true(bench.a16.device.counters.unheard >= 3);
    assert_true(bench.a16.device.counters.unheard < 8); /* the rest was heard, and is no frame */
    assert_int_equal(bench.a16.device.counters.crc_errors + bench.a16.device.counters.truncated, 1);
    assert_true(bench.line.counters.collisions >= 4);
    assert_false(is_hex(bench.bytes, A16_RESPONSE)); /* the host hears a mess */
}

TEST(an_automatic_frame_deafens_a_device_on_two_wires)
{
    set(FATHOM_SIM_A16_AUTO); /* full_duplex stays false */
    wait_ms(95);
    ask(A16_ASKED, 20); /* the frame begins in the middle of it */
    COUNTED(.requests = NONE);
    assert_true(bench.a16.device.counters.unheard >= 3);
    COUNTED(.truncated = 1, .crc_errors = NONE);
    ask(A16_ASKED, 20); /* between two frames it hears */
    COUNTED(.requests = 1);
}

TEST(the_host_hears_itself_only_with_echo)
{
    bench.line.echo = true;
    transact(A16_ASKED, 200, A16_ASKED A16_RESPONSE);
}

TEST(sent_turns_true_with_the_last_stop_bit)
{
    assert_true(fathom_sim_sent(&bench.line, bench.now_us));
    say(A16_ASKED);
    assert_false(fathom_sim_sent(&bench.line, bench.asked_us - 1));
    assert_true(fathom_sim_sent(&bench.line, bench.asked_us));
    assert_int_equal(bench.line.counters.from_host, 8);
}

TEST(due_leads_from_event_to_event_and_ends)
{
    assert_int_equal(fathom_sim_due_us(&bench.line, bench.now_us), FATHOM_NO_DEADLINE);
    say(A16_ASKED);
    size_t steps = 0;
    for (;; steps++) {
        const uint32_t due_us = fathom_sim_due_us(&bench.line, bench.now_us);
        if (due_us == FATHOM_NO_DEADLINE) break;
        assert_true(due_us > 0); /* never "now" without progress */
        const size_t before = bench.heard;
        wait_us(due_us);
        assert_true(bench.heard - before <= 1);
        assert_true(steps < 100);
    }
    expect(A16_RESPONSE);
    assert_int_equal(steps, 8 + 1 + 1 + 7); /* bytes, t3.5, the response, its bytes */
}

TEST(one_jump_and_many_steps_tell_the_same)
{
    static bench_t jump;
    for (int steps = 0; steps != 2; steps++) {
        bench_begin(&bench_9600, true);
        add_a16(FATHOM_SIM_A16_AUTO, (a16_config_t){.linger_us = 1});
        say(A16_ASKED);
        for (int i = 0; i != 5000 && steps != 0; i++) wait_us(100);
        if (steps != 0) break;
        wait_ms(500);
        jump = bench;
    }
    expect_as(&jump);
}

TEST(a_time_that_goes_back_changes_nothing)
{
    set(FATHOM_SIM_A16_AUTO);
    wait_ms(150);
    assert_int_equal(bench.heard, 4);
    fathom_sim_run(&bench.line, bench.now_us - 100 * MS);
    fathom_sim_run(&bench.line, bench.now_us - UINT32_C(1800000000));
    COUNTED(.automatic = 1);
    wait_ms(100);
    assert_int_equal(bench.heard, 8);
}

TEST(it_works_for_hours_across_every_wrap)
{
    for (int i = 0; i < 30; i++) { /* 12.5 hours, 10 wraps */
        wait_us(UINT32_C(1500000000));
        transact(A16_ASKED, 200, A16_RESPONSE);
    }
}

static uint8_t bytes_read[512];
static fathom_rx_t rx; /* of them */

/* A read so long from now, by a UART that knows so much: how many bytes, and what is told of them. */
static void expect_read(uint32_t in_us, size_t capacity, uint8_t knows, size_t count, uint8_t flags)
{
    rx = (fathom_rx_t){0, 0};
    assert_int_equal(
        fathom_sim_transmit_timed(&bench.line, bench.now_us + in_us, bytes_read, capacity, knows, &rx),
        count);
    assert_int_equal(rx.flags, flags);
}

TEST(a_read_tells_the_silence_before_and_the_time_of_the_last_byte)
{
    enum { BOTH = FATHOM_RX_TIMED | FATHOM_RX_SILENCE };
    set(FATHOM_SIM_A16_AUTO);
    /* two frames wait; one read does not span the silence between them */
    expect_read(250 * MS, 64, BOTH, 4, BOTH);
    assert_int_equal(fathom_elapsed_us(rx.last_us, bench.now_us), 100 * MS + 4167);
    expect_read(250 * MS, 2, BOTH, 2, BOTH);
    expect_read(250 * MS, 64, BOTH, 2, FATHOM_RX_TIMED); /* the rest of the same frame */
    assert_int_equal(fathom_elapsed_us(rx.last_us, bench.now_us), 200 * MS + 4167);
    expect_read(250 * MS, 64, BOTH, 0, 0);
}

TEST(what_it_does_not_know_it_neither_tells_nor_minds)
{
    set(FATHOM_SIM_A16_AUTO);
    expect_read(250 * MS, 64, 0, 8, 0);
}

TEST(unread_bytes_are_lost_and_reported)
{
    set(FATHOM_SIM_A16_AUTO);
    expect_read(6550 * MS, 512, FATHOM_RX_OVERRUN, 256, 0); /* 65 frames, 260 bytes */
    assert_int_equal(bench.line.counters.overruns, 4);
    assert_int_equal(bench.line.counters.to_host, 256);
    expect_read(6650 * MS, 512, FATHOM_RX_OVERRUN, 4, FATHOM_RX_OVERRUN);
}

TEST(at_another_rate_or_parity_no_device_understands)
{
    at_rate(19200, FATHOM_PARITY_EVEN);
    ask(A16_ASKED, 200);
    at_rate(9600, FATHOM_PARITY_EVEN);
    transact(A16_ASKED, 200, "");
    COUNTED(.wrong_settings = 16, .truncated = 2);
    at_rate(9700, FATHOM_PARITY_NONE);
    transact(A16_ASKED, 200, A16_RESPONSE);
}

TEST(a_stream_at_another_rate_is_garbage_with_framing_errors)
{
    set(FATHOM_SIM_A16_AUTO);
    at_rate(19200, FATHOM_PARITY_EVEN);
    for (int i = 0; i < 4; i++) expect_read(150 * MS, 8, FATHOM_RX_FRAMING, 1, FATHOM_RX_FRAMING);
    expect_read(150 * MS, 8, FATHOM_RX_FRAMING, 0, 0);
}

TEST(a_read_ends_with_a_byte_that_was_heard_wrong)
{
    set(FATHOM_SIM_A16_AUTO);
    at_rate(19200, FATHOM_PARITY_EVEN);
    /* two characters of the frame are over when the host finds the rate */
    bench.now_us += 100 * MS + 2200;
    at_rate(9600, FATHOM_PARITY_NONE);
    expect_read(10 * MS, 8, FATHOM_RX_FRAMING, 1, FATHOM_RX_FRAMING);
    expect_read(10 * MS, 8, FATHOM_RX_FRAMING, 1, FATHOM_RX_FRAMING);
    expect_read(10 * MS, 8, FATHOM_RX_FRAMING, 2, 0);
    assert_true(is_hex(bytes_read, "EF F0"));
}

TEST(three_devices_share_a_line_each_at_its_address_and_rate)
{
    fathom_sim_fixed_t second = FIXED(2083);
    add_a05(FATHOM_SIM_A05_MODBUS, (a05_config_t){.address = 5});
    add_hps(
        (hps_config_t){.address = 1, .scene = fathom_sim_fixed(&second)}); /* the A16's, at another rate */
    for (int round = 0; round < 3; round++) {
        transact(A16_ASKED, 200, A16_RESPONSE);
        transact("05 03 02 00 00 01 84 36", 50, "05 03 02 00 05 89 87");
        at_rate(19200, FATHOM_PARITY_EVEN);
        transact("01 03 00 08 00 04 C5 CB", 30, "01 03 08 08 23 DC B2 07 01 00 00 FD 41");
        at_rate(9600, FATHOM_PARITY_NONE);
    }
    assert_int_equal(bench.line.counters.collisions, 0);
    /* on two wires each hears the others' responses too: three from the A05 are frames for another, and
     * so are three of its requests */
    COUNTED_BY(&bench.a16.device, .others = 6, .requests = 3);
    COUNTED(.others = NONE); /* those were at another rate */
}

TEST(a_device_that_comes_in_the_middle_of_a_byte_hears_the_next_request)
{
    say(A16_ASKED);
    wait_us(3600);
    add_a05(FATHOM_SIM_A05_MODBUS, (a05_config_t){.address = 5});
    hear(200, A16_RESPONSE);
    transact("05 03 02 00 00 01 84 36", 50, "05 03 02 00 05 89 87");
    say(A16_ASKED);
    while (bench.heard < 3) wait_us(100); /* and once more, in a response */
    wait_us(300);
    fathom_sim_detach(&bench.line, &bench.a05.device, bench.now_us);
    attach(&bench.a05.device);
    hear(50, A16_RESPONSE);
    transact("05 03 02 00 00 01 84 36", 50, "05 03 02 00 05 89 87");
}

TEST(a_device_that_is_taken_off_in_mid_response_leaves_the_others_hearing)
{
    add_a05(FATHOM_SIM_A05_MODBUS, (a05_config_t){.address = 5});
    ask("05 03 02 00 00 01 84 36", 5);
    while (bench.heard < 3) wait_us(100);
    wait_us(300);
    fathom_sim_detach(&bench.line, &bench.a05.device, bench.now_us);
    wait_ms(50);
    assert_int_equal(bench.heard, 3);
    forget();
    transact(A16_ASKED, 200, A16_RESPONSE);
    /* and it comes back as from power-on */
    attach(&bench.a05.device);
    transact("05 03 02 00 00 01 84 36", 50, "05 03 02 00 05 89 87");
}
