/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

static bench_t *with_clock_at(uint32_t now_us)
{
    bench.fake.now_us = now_us;
    bench.fake.busy_until_us = now_us;
    assert_int_equal(fathom_line_init(&bench.line, &bench.config), FATHOM_READY);
    return &bench;
}

static const uint8_t set_address_5[] = {0x01, 0x06, 0x02, 0x00, 0x00, 0x05, 0x48, 0x71}; /* A16 6(4) ex 3 */

static const suite_t suite = {.set_up = set_up};

/* ---- setting up ---- */

TEST(a_config_without_uart_clock_or_frame_is_refused)
{
    fathom_line_config_t config = bench.config;
    config.uart = NULL;
    assert_int_equal(fathom_line_init(&bench.line, &config), FATHOM_ERR_ARGUMENT);
    config = bench.config;
    config.clock = NULL;
    assert_int_equal(fathom_line_init(&bench.line, &config), FATHOM_ERR_ARGUMENT);
    config = bench.config;
    config.frame = NULL;
    assert_int_equal(fathom_line_init(&bench.line, &config), FATHOM_ERR_ARGUMENT);
    config = bench.config;
    config.frame_size = 7;
    assert_int_equal(fathom_line_init(&bench.line, &config), FATHOM_ERR_ARGUMENT);
    config.frame_size = 8;
    assert_int_equal(fathom_line_init(&bench.line, &config), FATHOM_READY);
}

TEST(t3_5_is_three_and_a_half_characters_up_to_19200_baud_and_1750_us_above)
{
    assert_int_equal(FATHOM_T3_5_US(9600, 10), 3646);  /* 35 bits / 9600 = 3645.8 us */
    assert_int_equal(FATHOM_T3_5_US(19200, 11), 2006); /* 38.5 / 19200 = 2005.2 */
    assert_int_equal(FATHOM_T3_5_US(57600, 11), 1750);
    assert_int_equal(FATHOM_T3_5_US(230400, 11), 1750);
}

TEST(zero_in_the_config_means_the_default_silence_and_gap)
{
    bench.config.silence_us = 0;
    bench.config.gap_us = 0;
    ask(&bench.request, 1, &bench.value, 0);
    run_in_steps(4010, 10);
    assert_int_equal(bench.fake.written, 0);
    run_in_steps(10, 10);
    assert_int_equal(bench.fake.written, 1);
    run(8 * BYTE_US);
    receive(answer_1_754, 4);
    run_in_steps(4990, 10);
    assert_int_equal(bench.line.have, 4); /* the gap has not passed yet */
    run_in_steps(30, 10);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_CHECKSUM);
}

/* ---- asking ---- */

TEST(a_request_is_sent_after_the_silence_and_not_before)
{
    ask(&bench.request, 1, &bench.value, 0);
    run_in_steps(T3_5_US - 6, 10); /* 3640 */
    assert_int_equal(bench.fake.written, 0);
    run_in_steps(10, 10);
    assert_int_equal(bench.fake.written, 1);
    assert_int_equal(bench.fake.writes[0].length, sizeof ask_1_processed);
    assert_memory_equal(bench.fake.writes[0].bytes, ask_1_processed, sizeof ask_1_processed);
}

TEST(received_bytes_put_the_silence_off)
{
    ask(&bench.request, 1, &bench.value, 0);
    run_in_steps(3000, 10);
    receive(answer_1_754, 1);
    run_in_steps(T3_5_US - 6, 10);
    assert_int_equal(bench.fake.written, 0);
    run_in_steps(30, 10);
    assert_int_equal(bench.fake.written, 1);
}

TEST(the_answer_is_ready_in_the_poll_that_brings_its_last_byte)
{
    ask_1_and_send(0);
    receive(answer_1_754, sizeof answer_1_754);
    assert_int_equal(status_of(&bench.request), FATHOM_PENDING);
    fathom_line_poll(&bench.line);
    assert_int_equal(status_of(&bench.request), FATHOM_READY);
    assert_int_equal(bench.value, 754);
    assert_int_equal(counter(FATHOM_LINE_ANSWERS), 1);
}

TEST(an_answer_that_comes_a_byte_at_a_time_is_complete_with_the_last)
{
    ask_1_and_send(0);
    for (size_t i = 0; i != sizeof answer_1_754; i++) {
        assert_int_equal(status_of(&bench.request), FATHOM_PENDING);
        assert_int_equal(bench.value, 0xDEAD);
        receive(answer_1_754 + i, 1);
        run(BYTE_US);
    }
    assert_int_equal(status_of(&bench.request), FATHOM_READY);
    assert_int_equal(bench.value, 754);
}

TEST(every_cut_of_an_answer_into_two_reads_is_put_together)
{
    for (size_t cut = 1; cut != sizeof answer_1_754; cut++) {
        set_up(state);
        ask_1_and_send(0);
        receive(answer_1_754, cut);
        receive(answer_1_754 + cut, sizeof answer_1_754 - cut);
        fathom_line_poll(&bench.line);
        assert_int_equal(status_of(&bench.request), FATHOM_READY);
        assert_int_equal(bench.value, 754);
    }
}

TEST(a_loop_of_20_ms_reads_an_answer_that_is_spread_over_its_rounds)
{
    for (uint32_t start_us = 0; start_us < 40000; start_us += 700) {
        set_up(state);
        bench.config.gap_us = 5000; /* far less than the loop takes */
        ask(&bench.request, 1, &bench.value, 0);
        run_in_steps(60000, 20000);
        assert_int_equal(bench.fake.written, 1);
        fake_trickle(&bench.fake, start_us, BYTE_US, answer_1_754, sizeof answer_1_754);
        run_in_steps(80000, 20000);
        assert_int_equal(status_of(&bench.request), FATHOM_READY);
        assert_int_equal(bench.value, 754);
    }
}

TEST(a_write_is_acknowledged_by_its_own_words)
{
    fathom_modbus_write_single_register(&bench.request.message, 1, 0x0200, 5);
    bench.request.exchange.timeout_us = TIMEOUT_US;
    fathom_modbus_client_submit(&bench.line, &bench.request);
    run(20000);
    assert_memory_equal(bench.fake.writes[0].bytes, set_address_5, sizeof set_address_5);
    receive(set_address_5, sizeof set_address_5);
    run(100);
    assert_int_equal(status_of(&bench.request), FATHOM_READY);
}

TEST(an_exception_ends_the_exchange_and_keeps_its_number)
{
    ask_1_and_send(3);
    receive(exception_1_2, sizeof exception_1_2);
    run(100);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_EXCEPTION);
    assert_int_equal(bench.request.message.exception, 2);
    assert_int_equal(bench.value, 0xDEAD);
    assert_int_equal(counter(FATHOM_LINE_EXCEPTIONS), 1);
}

TEST(exchanges_are_served_first_come_first_served)
{
    ask(&bench.request, 1, &bench.value, 0);
    ask(&bench.other, 2, &bench.other_value, 0);
    run(T3_5_US + 9 * BYTE_US);
    assert_int_equal(bench.fake.writes[0].bytes[0], 1);
    receive_answer(1, 111);
    run(T3_5_US + 9 * BYTE_US);
    assert_int_equal(bench.fake.writes[1].bytes[0], 2);
    receive_answer(2, 222);
    run(100);
    assert_int_equal(bench.value, 111);
    assert_int_equal(bench.other_value, 222);
}

TEST(an_exchange_may_be_submitted_again_when_it_has_ended_and_not_before)
{
    ask_1_and_send(0);
    assert_int_equal(fathom_modbus_client_submit(&bench.line, &bench.request), FATHOM_ERR_BUSY);
    receive_answer(1, 111);
    run(100);
    assert_int_equal(bench.value, 111);
    ask(&bench.request, 1, &bench.value, 0);
    run(20000);
    assert_int_equal(bench.fake.written, 2);
    receive_answer(1, 112);
    run(100);
    assert_int_equal(bench.value, 112);
}

/* ---- time ---- */

TEST(no_answer_is_said_when_the_time_out_has_passed_since_the_request_left)
{
    ask_1_and_send(0);
    run(TIMEOUT_US - 500); /* up to 400 us have passed since the last bit */
    assert_int_equal(status_of(&bench.request), FATHOM_PENDING);
    run(700);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_NO_ANSWER);
    assert_int_equal(counter(FATHOM_LINE_NO_ANSWERS), 1);
    assert_int_equal(bench.value, 0xDEAD);
}

TEST(an_answer_that_began_in_time_may_end_after_the_time_out)
{
    ask_1_and_send(0);
    run(TIMEOUT_US - 2000);
    fake_trickle(&bench.fake, 0, BYTE_US, answer_1_754, sizeof answer_1_754);
    run(8 * BYTE_US);
    assert_int_equal(status_of(&bench.request), FATHOM_READY);
    assert_int_equal(bench.value, 754);
}

TEST(a_flood_of_noise_does_not_keep_an_exchange_for_ever)
{
    static const uint8_t noise[] = {0x01, 0x03, 0x02, 0x11, 0x22, 0x33, 0x44, 0x99};
    uint32_t waited_us = 0;
    ask_1_and_send(0);
    while (status_of(&bench.request) == FATHOM_PENDING && waited_us < 10 * TIMEOUT_US) {
        receive(noise + waited_us / BYTE_US % sizeof noise, 1);
        run_in_steps(BYTE_US, BYTE_US);
        waited_us += BYTE_US;
    }
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_CHECKSUM);
    assert_true(waited_us < TIMEOUT_US + 20 * BYTE_US);
}

TEST(a_request_goes_out_and_an_answer_comes_in_across_the_wrap_of_the_clock)
{
    for (uint32_t before_us = 0; before_us < 140000; before_us += 1700) {
        set_up(state);
        with_clock_at(0u - before_us);
        ask_1_and_send(0);
        run(20000);
        receive(answer_1_754, sizeof answer_1_754);
        run(100);
        assert_int_equal(status_of(&bench.request), FATHOM_READY);
        ask(&bench.other, 2, &bench.other_value, 0);
        run(T3_5_US + 8 * BYTE_US + TIMEOUT_US - 500);
        assert_int_equal(status_of(&bench.other), FATHOM_PENDING);
        run(1000);
        assert_int_equal(status_of(&bench.other), FATHOM_ERR_NO_ANSWER);
    }
}

TEST(a_single_poll_across_the_wrap_sees_all_the_time_that_passed)
{
    with_clock_at((uint32_t)0 - 20000);
    ask_1_and_send(0);
    assert_true(bench.fake.now_us > 0x80000000u);
    run_in_steps(TIMEOUT_US, TIMEOUT_US);
    assert_true(bench.fake.now_us < 0x80000000u);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_NO_ANSWER);
}

TEST(a_late_poll_finds_the_answer_before_it_looks_at_the_time)
{
    ask_1_and_send(0);
    receive(answer_1_754, sizeof answer_1_754);
    run_in_steps(3 * TIMEOUT_US, 3 * TIMEOUT_US);
    assert_int_equal(status_of(&bench.request), FATHOM_READY);
}

/* ---- cancel ---- */

TEST(cancelling_what_is_not_queued_does_nothing)
{
    bench.request.exchange.status = FATHOM_READY;
    fathom_modbus_client_cancel(&bench.line, &bench.request);
    assert_int_equal(status_of(&bench.request), FATHOM_READY);
    ask(&bench.request, 1, &bench.value, 0);
    fathom_modbus_client_cancel(&bench.line, &bench.request);
    fathom_modbus_client_cancel(&bench.line, &bench.request);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_CANCELLED);
}

TEST(an_exchange_cancelled_before_it_is_sent_is_never_sent)
{
    ask(&bench.request, 1, &bench.value, 0);
    ask(&bench.other, 2, &bench.other_value, 0);
    fathom_modbus_client_cancel(&bench.line, &bench.request);
    run(20000);
    assert_int_equal(bench.fake.written, 1);
    assert_int_equal(bench.fake.writes[0].bytes[0], 2);
}

TEST(an_exchange_cancelled_in_flight_leaves_an_answer_that_nobody_takes)
{
    ask_1_and_send(0);
    fathom_modbus_client_cancel(&bench.line, &bench.request);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_CANCELLED);
    memset(&bench.request, 0xA5, sizeof bench.request); /* the memory is the caller's again */
    ask(&bench.other, 1, &bench.other_value, 0);
    run(30000);
    assert_int_equal(bench.fake.written, 1);
    receive(answer_1_754, sizeof answer_1_754);
    run(20000);
    assert_int_equal(bench.fake.written, 2);
    assert_int_equal(bench.other_value, 0xDEAD);
    receive(answer_1_751, sizeof answer_1_751);
    run(100);
    assert_int_equal(bench.other_value, 751);
}

TEST(an_exchange_cancelled_while_it_leaves_owes_no_longer_than_any_other)
{
    bench.fake.never_sent = true;
    ask(&bench.request, 1, &bench.value, 0);
    run(T3_5_US + 200);
    fathom_modbus_client_cancel(&bench.line, &bench.request);
    bench.fake.never_sent = false;
    ask(&bench.other, 1, &bench.other_value, 0);
    run(2 * TIMEOUT_US - 1000);
    assert_int_equal(bench.fake.written, 1);
    run(2000);
    assert_int_equal(bench.fake.written, 2);
}

TEST(a_request_that_the_port_has_not_taken_owes_nothing_when_cancelled)
{
    bench.fake.write_busy = true;
    ask(&bench.request, 1, &bench.value, 0);
    run(10000);
    fathom_modbus_client_cancel(&bench.line, &bench.request);
    bench.fake.write_busy = false;
    ask(&bench.other, 1, &bench.other_value, 0);
    run(T3_5_US + 200);
    assert_int_equal(bench.fake.written, 1);
}

/* ---- broadcast ---- */

TEST(a_broadcast_is_ready_after_its_turn_round_and_expects_no_answer)
{
    fathom_modbus_write_single_register(&bench.request.message, FATHOM_MODBUS_BROADCAST, 0x0012, 0);
    bench.request.exchange.timeout_us = TIMEOUT_US;
    assert_int_equal(fathom_modbus_client_submit(&bench.line, &bench.request), FATHOM_PENDING);
    ask(&bench.other, 2, &bench.other_value, 0);
    run(T3_5_US + 200 + 8 * BYTE_US);
    assert_int_equal(bench.fake.written, 1);
    run(TIMEOUT_US - 1000);
    assert_int_equal(status_of(&bench.request), FATHOM_PENDING);
    assert_int_equal(bench.fake.written, 1);
    run(2000);
    assert_int_equal(status_of(&bench.request), FATHOM_READY);
    assert_int_equal(bench.fake.written, 2);
}

TEST(a_broadcast_may_be_cancelled_in_flight_and_nobody_owes)
{
    fathom_modbus_write_single_register(&bench.request.message, FATHOM_MODBUS_BROADCAST, 0x0012, 0);
    bench.request.exchange.timeout_us = TIMEOUT_US;
    fathom_modbus_client_submit(&bench.line, &bench.request);
    run(T3_5_US + 200 + 8 * BYTE_US);
    fathom_modbus_client_cancel(&bench.line, &bench.request);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_CANCELLED);
    assert_int_equal(bench.line.owing, 0);
}

/* ---- due ---- */

TEST(due_says_when_something_can_happen_without_new_bytes)
{
    fathom_line_poll(&bench.line);
    assert_int_equal(fathom_line_due_us(&bench.line), FATHOM_NO_DEADLINE);
    ask(&bench.request, 1, &bench.value, 0);
    assert_int_equal(fathom_line_due_us(&bench.line), T3_5_US);
    bench.fake.now_us += 646;
    assert_int_equal(fathom_line_due_us(&bench.line), 3000);
    run_in_steps(3000, 3000);
    assert_int_equal(bench.fake.written, 1);
    assert_int_equal(fathom_line_due_us(&bench.line), 1000); /* sending */
    run_in_steps(9000, 9000);
    assert_int_equal(fathom_line_due_us(&bench.line), TIMEOUT_US);
    receive(answer_1_754, 4);
    fathom_line_poll(&bench.line);
    assert_int_equal(fathom_line_due_us(&bench.line), GAP_US); /* the rest of the frame, or its end */
    run_in_steps(GAP_US, GAP_US);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_CHECKSUM);
    assert_int_equal(fathom_line_due_us(&bench.line), FATHOM_NO_DEADLINE);
    ask(&bench.request, 1, &bench.value, 0);
    assert_int_equal(fathom_line_due_us(&bench.line), 2 * TIMEOUT_US - GAP_US); /* owes */
    bench.fake.now_us += 2 * TIMEOUT_US;
    assert_int_equal(fathom_line_due_us(&bench.line), 0);
}

/* Sleeping as long as due says, and no longer, must never miss anything: every outcome comes at the same time
 * as with polling all the time. */
TEST(sleeping_for_due_us_ends_an_exchange_as_early_as_polling_without_pause)
{
    uint32_t ended_us[2];
    for (int sleeps = 0; sleeps != 2; sleeps++) {
        set_up(state);
        ask(&bench.request, 1, &bench.value, 2);
        const uint32_t began_us = bench.fake.now_us;
        unsigned polls = 0;
        while (status_of(&bench.request) == FATHOM_PENDING) {
            const uint32_t due_us = fathom_line_due_us(&bench.line);
            bench.fake.now_us += sleeps != 0 && due_us != 0 ? due_us : 1;
            fathom_line_poll(&bench.line);
            polls++;
        }
        ended_us[sleeps] = bench.fake.now_us - began_us;
        if (sleeps != 0) assert_in_range(polls, 3, 60);
    }
    assert_in_range(ended_us[1], ended_us[0], ended_us[0] + 3 * 1000);
}

TEST(counters_stop_at_their_end)
{
    bench.line.counters[FATHOM_LINE_ANSWERS] = 65534;
    bench.line.counters[FATHOM_LINE_DROPPED_BYTES] = 65530;
    for (int i = 0; i != 3; i++) {
        ask(&bench.request, 1, &bench.value, 0);
        run(20000);
        receive_answer(1, 111);
        run(100);
        receive_answer(9, 999);
        run(10000);
    }
    assert_int_equal(counter(FATHOM_LINE_ANSWERS), 65535);
    assert_int_equal(counter(FATHOM_LINE_DROPPED_BYTES), 65535);
}

TEST(a_poll_reads_the_port_a_bounded_number_of_times)
{
    for (int i = 0; i != 100; i++) receive(answer_1_754, 1);
    fathom_line_poll(&bench.line);
    assert_int_equal(bench.fake.reads, 16);
    assert_false(fake_drained(&bench.fake));
}
