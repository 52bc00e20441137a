/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

/* A break of the line: TX as the trigger or the mode select of a module. */

static const suite_t suite = {.set_up = set_up};

TEST(a_break_holds_tx_low_until_it_is_ended)
{
    assert_int_equal(fathom_line_break(&bench.line, true), FATHOM_READY);
    assert_true(bench.fake.in_break);
    assert_int_equal(fathom_line_break(&bench.line, true), FATHOM_READY);
    run(100000);
    assert_true(bench.fake.in_break);
    assert_int_equal(fathom_line_break(&bench.line, false), FATHOM_READY);
    assert_false(bench.fake.in_break);
}

TEST(nothing_is_sent_in_a_break_and_the_silence_is_kept_after_it)
{
    run(100000);
    assert_int_equal(fathom_line_break(&bench.line, true), FATHOM_READY);
    ask(&bench.request, 1, &bench.value, 0);
    run(2000000); /* longer than a port may refuse */
    assert_int_equal(bench.fake.written, 0);
    assert_int_equal(status_of(&bench.request), FATHOM_PENDING);
    assert_int_equal(fathom_line_due_us(&bench.line), FATHOM_NO_DEADLINE);
    assert_int_equal(fathom_line_break(&bench.line, false), FATHOM_READY);
    assert_int_equal(fathom_line_due_us(&bench.line), T3_5_US);
    run(T3_5_US - 100);
    assert_int_equal(bench.fake.written, 0);
    run(200);
    assert_int_equal(bench.fake.written, 1);
    run(8 * BYTE_US);
    receive_answer(1, 111);
    run(100);
    assert_int_equal(bench.value, 111);
}

TEST(with_an_exchange_on_the_wire_it_is_busy_and_nothing_changes)
{
    ask(&bench.request, 1, &bench.value, 0);
    run(T3_5_US + 100);
    assert_int_equal(bench.fake.written, 1);
    assert_int_equal(fathom_line_break(&bench.line, true), FATHOM_ERR_BUSY); /* it is leaving */
    run(8 * BYTE_US);
    assert_int_equal(fathom_line_break(&bench.line, true), FATHOM_ERR_BUSY); /* the answer may come */
    assert_int_equal(bench.fake.breaks, 0);
    receive_answer(1, 111);
    run(100);
    assert_int_equal(status_of(&bench.request), FATHOM_READY);
    assert_int_equal(fathom_line_break(&bench.line, true), FATHOM_READY);
    assert_int_equal(bench.fake.breaks, 1);
}

TEST(while_bytes_of_the_port_leave_it_is_pending)
{
    bench.fake.never_sent = true;
    assert_int_equal(fathom_line_break(&bench.line, true), FATHOM_PENDING);
    assert_false(bench.fake.in_break);
    ask(&bench.request, 1, &bench.value, 0);
    run(T3_5_US + 100);
    assert_int_equal(bench.fake.written, 1); /* so there was no break */
}

/* The port was busy with a request; after the break it gets its time anew. */
TEST(a_request_that_the_port_refused_waits_for_the_end_of_the_break)
{
    bench.fake.write_busy = true;
    ask(&bench.request, 1, &bench.value, 0);
    run(T3_5_US + 900000);
    assert_int_equal(fathom_line_break(&bench.line, true), FATHOM_READY);
    run(500000);
    assert_int_equal(fathom_line_break(&bench.line, false), FATHOM_READY);
    run(T3_5_US + 500000);
    assert_int_equal(status_of(&bench.request), FATHOM_PENDING);
    bench.fake.write_busy = false;
    run(1000);
    assert_int_equal(bench.fake.written, 1);
}

static unsigned heard;
static unsigned gaps;

static void hear(fathom_listener_t *listener, const uint8_t *bytes, uint8_t count, bool after_gap,
                 uint32_t time_us)
{
    (void)listener;
    (void)bytes;
    (void)time_us;
    heard += count;
    gaps += after_gap;
}

/* A module that is triggered by the break answers in frames that begin after a silence. */
TEST(the_end_of_a_break_does_not_hide_a_silence_from_the_listener)
{
    fathom_listener_t listener = {hear, 5000};
    for (unsigned silent_us = 4900; silent_us <= 5000; silent_us += 100) {
        set_up(state);
        fathom_line_listen(&bench.line, &listener);
        assert_int_equal(fathom_line_break(&bench.line, true), FATHOM_READY);
        run(silent_us);
        assert_int_equal(fathom_line_break(&bench.line, false), FATHOM_READY);
        heard = gaps = 0;
        receive(answer_1_754, 7);
        run(100);
        assert_int_equal(heard, 7);
        assert_int_equal(gaps, silent_us == 5000);
    }
}

/* Unit 1 still owes; of its late answer a part has come, right behind a byte of noise. */
TEST(the_end_of_a_break_is_no_gap_within_what_has_come)
{
    static const uint8_t noise_and_part[] = {0x55, 0x01, 0x03, 0x02};
    fathom_listener_t listener = {hear, 500};
    fathom_line_listen(&bench.line, &listener);
    ask_1_and_send(0);
    run(TIMEOUT_US + 1000);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_NO_ANSWER);
    heard = gaps = 0;
    receive(noise_and_part, 4);
    run(1000);
    assert_int_equal(bench.line.have, 3);
    assert_int_equal(heard, 1);
    assert_int_equal(gaps, 1);
    assert_int_equal(fathom_line_break(&bench.line, true), FATHOM_READY);
    assert_int_equal(fathom_line_break(&bench.line, false), FATHOM_READY);
    run(GAP_US + 1000);
    assert_int_equal(heard, 4);
    assert_int_equal(gaps, 1);
}

static int broken(void *ctx, bool on)
{
    (void)ctx;
    (void)on;
    return -1;
}

TEST(a_port_that_cannot_or_is_broken_says_so)
{
    bench.fake.uart.set_break = broken;
    assert_int_equal(fathom_line_break(&bench.line, true), FATHOM_ERR_PORT);
    bench.fake.uart.set_break = NULL;
    assert_int_equal(fathom_line_break(&bench.line, true), FATHOM_ERR_UNSUPPORTED);
    ask(&bench.request, 1, &bench.value, 0);
    run(T3_5_US + 100);
    assert_int_equal(bench.fake.written, 1);
}

TEST(a_port_that_breaks_in_a_break_comes_back_without_it)
{
    assert_int_equal(fathom_line_break(&bench.line, true), FATHOM_READY);
    bench.fake.read_fails = true;
    bench.fake.now_us += 100;
    assert_int_equal(fathom_line_poll(&bench.line), FATHOM_ERR_PORT);
    bench.fake.read_fails = false;
    ask(&bench.request, 1, &bench.value, 0);
    run(T3_5_US + 200);
    assert_int_equal(bench.fake.written, 1);
}
