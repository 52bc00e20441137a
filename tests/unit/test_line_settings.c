/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

/* Line settings of an exchange: an A16 with 9600 8N1 and an HPS-167S with 19200 8E1 on one pair of wires. */

static const fathom_line_settings_t n9600 = {9600, FATHOM_PARITY_NONE, 1};
static const fathom_line_settings_t e19200 = {19200, FATHOM_PARITY_EVEN, 1};

static void ask_with(fathom_modbus_request_t *request, uint8_t unit, uint16_t *value,
                     const fathom_line_settings_t *settings)
{
    request->exchange.settings = settings;
    ask(request, unit, value, 0);
}

static void assert_set_to(const fathom_line_settings_t *settings)
{
    assert_int_equal(bench.fake.settings.baud, settings->baud);
    assert_int_equal(bench.fake.settings.parity, settings->parity);
    assert_int_equal(bench.fake.settings.stop_bits, settings->stop_bits);
}

static const suite_t suite = {.set_up = set_up};

TEST(an_exchange_without_settings_leaves_the_line_as_it_is)
{
    ask_1_and_send(0);
    receive_answer(1, 111);
    run(100);
    assert_int_equal(status_of(&bench.request), FATHOM_READY);
    assert_int_equal(bench.fake.set_lines, 0);
}

TEST(settings_hold_before_the_request_is_written)
{
    ask_with(&bench.request, 1, &bench.value, &e19200);
    run(T3_5_US - 200);
    assert_int_equal(bench.fake.set_lines, 0); /* what still comes is at the settings before */
    run(400);
    assert_int_equal(bench.fake.written, 1);
    assert_int_equal(bench.fake.writes[0].baud, 19200);
    assert_set_to(&e19200);
    receive_answer(1, 111);
    run(100);
    assert_int_equal(bench.value, 111);
}

TEST(two_sensors_with_their_own_settings_share_a_line)
{
    for (unsigned round = 0; round != 5; round++) {
        ask_with(&bench.request, 1, &bench.value, &n9600);
        ask_with(&bench.other, 2, &bench.other_value, &e19200);
        run(T3_5_US + 8 * BYTE_US + 400);
        assert_int_equal(bench.fake.written, 2 * round + 1);
        assert_int_equal(bench.fake.writes[2 * round].bytes[0], 1);
        assert_int_equal(bench.fake.writes[2 * round].baud, 9600);
        assert_set_to(&n9600);
        receive_answer(1, (uint16_t)(100 + round));
        run(T3_5_US - 300); /* the silence is kept before the other settings too */
        assert_int_equal(bench.value, 100 + round);
        assert_set_to(&n9600);
        run(8 * BYTE_US + 800);
        assert_int_equal(bench.fake.written, 2 * round + 2);
        assert_int_equal(bench.fake.writes[2 * round + 1].bytes[0], 2);
        assert_int_equal(bench.fake.writes[2 * round + 1].baud, 19200);
        assert_set_to(&e19200);
        receive_answer(2, (uint16_t)(200 + round));
        run(100);
        assert_int_equal(bench.other_value, 200 + round);
    }
}

TEST(each_attempt_sets_its_settings_again)
{
    bench.request.exchange.settings = &e19200;
    ask(&bench.request, 1, &bench.value, 2);
    ask_with(&bench.other, 2, &bench.other_value, &n9600);
    run(8 * TIMEOUT_US);
    assert_int_equal(bench.request.exchange.attempts, 3);
    assert_int_equal(bench.fake.written, 4);
    for (size_t i = 0; i != 4; i++)
        assert_int_equal(bench.fake.writes[i].baud, bench.fake.writes[i].bytes[0] == 1 ? 19200 : 9600);
}

/* hal.h: 0 means that bytes are still leaving. */
TEST(a_port_that_cannot_change_yet_is_asked_again)
{
    bench.fake.never_sent = true;
    ask_with(&bench.request, 1, &bench.value, &e19200);
    run(50000);
    assert_true(bench.fake.set_lines > 1);
    assert_int_equal(bench.fake.written, 0);
    assert_int_equal(status_of(&bench.request), FATHOM_PENDING);
    assert_true(fathom_line_due_us(&bench.line) <= 1000);
    bench.fake.never_sent = false;
    run(8 * BYTE_US + 400);
    assert_int_equal(bench.fake.written, 1);
    assert_int_equal(bench.fake.writes[0].baud, 19200);
    receive_answer(1, 111);
    run(100);
    assert_int_equal(bench.value, 111);
}

TEST(a_port_that_never_changes_is_broken_after_a_second)
{
    bench.fake.never_sent = true;
    ask_with(&bench.request, 1, &bench.value, &e19200);
    run(FATHOM_LINE_SEND_US);
    assert_int_equal(status_of(&bench.request), FATHOM_PENDING);
    run(T3_5_US + 1000);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_PORT);
    assert_int_equal(counter(FATHOM_LINE_PORT_ERRORS), 1);
    assert_int_equal(bench.fake.written, 0);
}

TEST(settings_that_the_port_cannot_do_end_that_exchange_alone)
{
    bench.fake.unsupported_baud = 19200;
    ask_with(&bench.request, 1, &bench.value, &e19200);
    ask_with(&bench.other, 2, &bench.other_value, &n9600);
    run(T3_5_US + 8 * BYTE_US + 600);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_UNSUPPORTED);
    assert_int_equal(bench.request.exchange.attempts, 0);
    assert_int_equal(bench.fake.written, 1);
    assert_int_equal(bench.fake.writes[0].bytes[0], 2);
    assert_int_equal(counter(FATHOM_LINE_PORT_ERRORS), 0);
    receive_answer(2, 222);
    run(100);
    assert_int_equal(bench.other_value, 222);
    assert_int_equal(bench.value, 0xDEAD);
}

TEST(retries_do_not_help_against_settings_that_the_port_cannot_do)
{
    bench.fake.unsupported_baud = 19200;
    bench.request.exchange.settings = &e19200;
    ask(&bench.request, 1, &bench.value, 5);
    run(T3_5_US + 400);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_UNSUPPORTED);
    assert_int_equal(bench.fake.set_lines, 1);
    ask_with(&bench.request, 1, &bench.value, &n9600); /* nothing was sent, so nothing is owed */
    run(1000);
    assert_int_equal(bench.fake.written, 1);
}

TEST(settings_on_a_port_whose_settings_are_fixed_are_unsupported)
{
    bench.fake.uart.set_line = NULL;
    ask_with(&bench.request, 1, &bench.value, &n9600);
    ask_with(&bench.other, 2, &bench.other_value, NULL);
    run(T3_5_US + 8 * BYTE_US + 600);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_UNSUPPORTED);
    assert_int_equal(bench.fake.written, 1);
    receive_answer(2, 222);
    run(100);
    assert_int_equal(bench.other_value, 222);
}

TEST(settings_that_turn_out_unsupported_after_a_busy_port_end_the_exchange)
{
    bench.fake.never_sent = true;
    ask_with(&bench.request, 1, &bench.value, &e19200);
    run(20000);
    bench.fake.never_sent = false;
    bench.fake.unsupported_baud = 19200;
    run(100);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_UNSUPPORTED);
    assert_true(fathom_line_due_us(&bench.line) == FATHOM_NO_DEADLINE);
}

/* The port took the settings and is then too busy for the request. */
TEST(a_port_that_is_busy_with_the_settings_set_gets_the_request_when_it_is_free)
{
    bench.fake.write_busy = true;
    ask_with(&bench.request, 1, &bench.value, &e19200);
    run(20000);
    assert_int_equal(bench.fake.written, 0);
    bench.fake.write_busy = false;
    run(100);
    assert_int_equal(bench.fake.written, 1);
    assert_int_equal(bench.fake.writes[0].baud, 19200);
}

TEST(an_exchange_that_waits_for_its_settings_can_be_cancelled_and_owes_nothing)
{
    bench.fake.never_sent = true;
    ask_with(&bench.request, 1, &bench.value, &e19200);
    run(20000);
    fathom_line_cancel(&bench.line, &bench.request.exchange);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_CANCELLED);
    bench.fake.never_sent = false;
    ask_with(&bench.request, 1, &bench.value, &n9600);
    run(100);
    assert_int_equal(bench.fake.written, 1);
    assert_int_equal(bench.fake.writes[0].baud, 9600);
}
