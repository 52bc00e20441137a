/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

/* Line settings of a transaction: an A16 with 9600 8N1 and an HPS-167S with 19200 8E1 on one pair of wires. */

static const fathom_line_settings_t n9600 = {9600, FATHOM_PARITY_NONE, 1};
static const fathom_line_settings_t e19200 = {19200, FATHOM_PARITY_EVEN, 1};

static void assert_set_to(const fathom_line_settings_t *settings)
{
    assert_int_equal(bench.fake.settings.baud, settings->baud);
    assert_int_equal(bench.fake.settings.parity, settings->parity);
    assert_int_equal(bench.fake.settings.stop_bits, settings->stop_bits);
}

static void ask_1_with(uint8_t retries, const fathom_line_settings_t *settings)
{
    bench.request.transaction.line_settings = settings;
    ask_1(retries);
}

static void ask_2_with(const fathom_line_settings_t *settings)
{
    bench.other.transaction.line_settings = settings;
    ask_other(2);
}

/* Write number `which` was for this unit, at these settings, which the port still has. */
static void expect_written_with(size_t which, uint8_t unit, const fathom_line_settings_t *settings)
{
    expect_written(which + 1);
    expect_unit(which, unit);
    assert_int_equal(bench.fake.writes[which].baud, settings->baud);
    assert_set_to(settings);
}

static const suite_t suite = {.set_up = set_up};

TEST(settings_hold_before_the_request_is_written)
{
    ask_1_with(0, &e19200);
    run(T3_5_US - 200);
    assert_int_equal(bench.fake.set_lines, 0); /* what still comes is at the settings before */
    run(400);
    expect_written_with(0, 1, &e19200);
    response_1(111);
}

TEST(two_sensors_with_their_own_settings_share_a_line)
{
    for (unsigned round = 0; round != 5; round++) {
        ask_1_with(0, &n9600);
        ask_2_with(&e19200);
        run(REQUEST_US);
        expect_written_with(2 * round, 1, &n9600);
        receive_response(1, (uint16_t)(100 + round));
        run(T3_5_US - 300); /* the silence is kept before the other settings too */
        expect_mm((uint16_t)(100 + round));
        assert_set_to(&n9600);
        run(8 * BYTE_US + 800);
        expect_written_with(2 * round + 1, 2, &e19200);
        response_other(2, (uint16_t)(200 + round));
    }
}

/* hal.h: 0 means that bytes are still leaving. */
TEST(a_port_that_cannot_change_yet_is_asked_again)
{
    bench.fake.never_sent = true;
    ask_1_with(0, &e19200);
    run(50000);
    assert_true(bench.fake.set_lines > 1);
    expect_written(0);
    expect(FATHOM_PENDING);
    assert_true(due() <= 1000);
    bench.fake.never_sent = false;
    run(8 * BYTE_US + 400);
    expect_written_with(0, 1, &e19200);
    response_1(111);
}

TEST(a_port_that_never_changes_is_broken_after_a_second)
{
    bench.fake.never_sent = true;
    ask_1_with(0, &e19200);
    expect_after(FATHOM_LINE_SEND_US, FATHOM_PENDING);
    expect_after(T3_5_US + 1000, FATHOM_ERR_PORT);
    expect_count(FATHOM_LINE_PORT_ERRORS, 1);
    expect_written(0);
}

TEST(settings_that_the_port_cannot_do_end_that_transaction_alone)
{
    bench.fake.unsupported_baud = 19200;
    ask_1_with(0, &e19200);
    ask_2_with(&n9600);
    expect_after(REQUEST_US + 200, FATHOM_ERR_UNSUPPORTED);
    assert_int_equal(bench.request.transaction.attempts, 0);
    expect_written(1);
    expect_unit(0, 2);
    expect_count(FATHOM_LINE_PORT_ERRORS, 0);
    response_other(2, 222);
    assert_int_equal(bench.value, 0xDEAD);
}

TEST(settings_on_a_port_whose_settings_are_fixed_are_unsupported)
{
    bench.fake.uart.set_line = NULL;
    ask_1_with(0, &n9600);
    ask_2_with(NULL);
    expect_after(REQUEST_US + 200, FATHOM_ERR_UNSUPPORTED);
    expect_written(1);
    response_other(2, 222);
}

TEST(settings_that_turn_out_unsupported_after_a_busy_port_end_the_transaction)
{
    bench.fake.never_sent = true;
    ask_1_with(0, &e19200);
    run(20000);
    bench.fake.never_sent = false;
    bench.fake.unsupported_baud = 19200;
    expect_after(100, FATHOM_ERR_UNSUPPORTED);
    expect_due(FATHOM_NO_DEADLINE);
}

TEST(a_transaction_that_waits_for_its_settings_can_be_cancelled_and_quarantines_none)
{
    bench.fake.never_sent = true;
    ask_1_with(0, &e19200);
    run(20000);
    cancel(&bench.request);
    expect(FATHOM_ERR_CANCELLED);
    bench.fake.never_sent = false;
    ask_1_with(0, &n9600);
    run(100);
    expect_written_with(0, 1, &n9600);
}

/* An A16 beside an HPS-167S on a bus that was opened for the latter, by 19200 baud: 38.5 bits are 2005.2 us there, and
 * 4010.4 us at 9600 baud, which the A16 needs to see where its request begins. */
TEST(the_silence_is_that_of_the_slowest_settings_that_were_named)
{
    bench.config.silence_us = 2006;
    ask_2_with(&e19200);
    run(1900);
    expect_written(0);
    run(200);
    expect_written(1);
    run(8 * BYTE_US);
    response_other(2, 222);
    ask_1_with(0, &n9600);
    run(3900);
    expect_written(1);
    run(300);
    expect_written_with(1, 1, &n9600);
    run(8 * BYTE_US);
    response_1(111);
    ask_2_with(&e19200); /* also before the faster one: the A16 hears the end of its own frame by it */
    run(3900);
    expect_written(2);
    run(300);
    expect_written_with(2, 2, &e19200);
}

TEST(a_transaction_without_settings_gets_those_of_the_parts)
{
    bench.config.line_settings = &n9600;
    ask_2_with(&e19200);
    run(REQUEST_US);
    expect_written_with(0, 2, &e19200);
    response_other(2, 222);
    ask_1_with(0, NULL);
    run(REQUEST_US + 400);
    expect_written_with(1, 1, &n9600);
}

TEST(a_longer_silence_of_the_parts_is_kept)
{
    bench.config.silence_us = 6000;
    ask_1_with(0, &n9600);
    run(5800);
    expect_written(0);
    run(400);
    expect_written_with(0, 1, &n9600);
}

/* silence.h: 38.5 / 9600 is 4010.4 us, 38.5 / 19200 is 2005.2; slower rates have none. */
TEST(the_silence_of_settings_is_that_of_9600_or_19200_baud)
{
    static const struct {
        uint32_t baud;
        uint16_t us;
    } rows[] = {{4800, 65535}, {9599, 65535}, {9600, 4011}, {19199, 4011}, {19200, 2006}, {115200, 2006}};
    for (unsigned i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        const fathom_line_settings_t settings = {rows[i].baud, FATHOM_PARITY_NONE, 1};
        assert_int_equal(fathom_silence_us(&settings), rows[i].us);
    }
}
