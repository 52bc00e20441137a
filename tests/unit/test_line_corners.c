/* SPDX-License-Identifier: MIT */
#include "echo_bench.h"
#include "fake_modbus.h"
#include "fathom/engine/internal/modbus_unit.h"
#include "fathom/engine/stream.h"

static uint16_t values[4];

static const suite_t suite = {.set_up = set_up};
static const suite_t asked = {.set_up = set_up_asked};

static void refuse_set_address(void)
{
    assert_int_equal(fathom_dyp_client_broadcast_address(&bench.line, &bench.request, 5), FATHOM_ERR_BUSY);
}

/* dyp_client.h: FATHOM_ERR_BUSY; line.h: "it is queued already; nothing changed". */
TEST(a_refused_set_address_does_not_turn_a_read_under_way_into_a_set_address)
{
    bench.request.transaction.retries = 1;
    ask_dyp(&bench.request, 1, 4, values);
    run_until_written(1, 100);
    refuse_set_address();
    run_until_written(2, 100); /* the retry */
    expect_bytes(1, bench.fake.writes[0].bytes, 5);
}

/* the same for a response that comes. */
TEST(a_refused_set_address_leaves_the_response_of_a_read_under_way_alone)
{
    ask_dyp(&bench.request, 1, 4, values);
    run_until_written(1, 100);
    refuse_set_address();
    run(20000);
    deliver_all(dyp_four);
    expect(FATHOM_OK);
}

/* line.h: "A late response does serve a retry of the same transaction." */
TEST(a_late_response_serves_the_retry_of_a_request_to_unit_255)
{
    bench.request.transaction.retries = 1;
    ask_dyp(&bench.request, 255, 1, values);
    run_until_written(1, 100);
    run(TIMEOUT_US + 10000);
    deliver_hex("55 AA 05 10 07 A1 BC");
    expect_count(FATHOM_LINE_LATE_RESPONSES, 1);
    expect(FATHOM_OK);
}

/* line.h: FATHOM_LINE_ANY_UNIT: "the first response is taken, whosever it is"; A16 6(3), A05 3(3): FF is the broadcast
 * address. */
TEST(modbus_to_unit_255_takes_any_units_response)
{
    ask(&bench.request, 255, &bench.value, 0);
    run_until_written(1, 100);
    run(20000);
    deliver_response(5, 111);
    expect_mm(111);
    assert_int_equal(bench.request.message.head[0], 5);
}

/* line.h: after_gap: "the line was seen to be silent ... before the first of them": but bytes were lost between. */
TEST(bytes_after_an_overrun_are_not_the_first_after_a_silence)
{
    static const uint8_t rest[] = {0xA1, 0xA7};
    listen_for(5000);
    run(10000);
    receive_rx(rest, sizeof rest, FATHOM_RX_OVERRUN);
    run(100);
    assert_int_equal(bench_listener.length, sizeof rest);
    assert_int_equal(bench_listener.losses, 1);
    assert_int_equal(bench_listener.gaps, 0);
}

static uint8_t storage[20];
/* what follows from it: 1000 2000 2047 1339 permuted to 1339 2047 1000 2000, with plausible values. */
TEST(an_overrun_after_a_silence_does_not_permute_the_probes)
{
    static const uint8_t good[] = {0xFF, 0x03, 0xE8, 0x07, 0xD0, 0x07, 0xFF, 0x05, 0x3B, 0x07};
    static const fathom_stream_config_t config = {.storage = storage, .length = 10};
    fathom_stream_t stream;
    assert_int_equal(fathom_stream_init(&stream, &config, 0), FATHOM_OK);
    (void)fathom_line_replace_listener(&bench.line, &stream.listener);
    run(10000);
    receive_rx(good + 6, 4, FATHOM_RX_OVERRUN); /* six were lost */
    deliver(good, 10);
    if (fathom_stream_poll(&stream, 0) == FATHOM_OK)
        assert_memory_equal(fathom_stream_frame(&stream), good, 10);
}

/* line.h: "A response is complete by its length, at once". */
TEST_IN(asked, after_a_broken_port_a_response_is_complete_at_once)
{
    deliver_hex("01 03 14 00");
    break_port();
    ask_other(2);
    run_until_written(2, 100);
    run(9 * BYTE_US);
    receive_response(2, 222);
    poll_line();
    expect_other(FATHOM_OK);
}

/* A write on an echoing line, whose request has been handed over. */
static void write_with_echo(void)
{
    set_up_with(FATHOM_LINE_ECHO_ON);
    ask_to_write(&bench.request, 1);
    run_until_written(1, 100);
    come_all(0, set_address_5);
}

/* line.h: cancel: the unit is then quarantined, and no later transaction takes its response. The echo is no
 * response. */
TEST(the_echo_of_a_cancelled_write_is_not_its_late_response)
{
    write_with_echo();
    cancel(&bench.request);
    run(9 * BYTE_US);
    ask_to_write(&bench.other, 1);
    expect_written_after(20000, 1); /* the unit is still quarantined */
}

/* After the echo the next copy is the late response. */
TEST(the_response_after_the_echo_of_a_cancelled_write_ends_the_quarantine)
{
    write_with_echo();
    run(9 * BYTE_US);
    cancel(&bench.request);
    deliver(set_address_5, 8);
    expect_count(FATHOM_LINE_LATE_RESPONSES, 1);
    ask_other(1);
    expect_written_after(T3_5_US + 200, 2);
}

static fathom_status_t asks(fathom_modbus_unit_t *unit, const fathom_modbus_unit_request_t *request)
{
    fathom_modbus_unit_poll(unit);
    return ask_unit(unit, request);
}

/* modbus_unit.h: "A command is asked at once all the same." The pace has long passed. */
TEST(a_command_goes_out_at_once_when_the_pace_has_passed)
{
    static fake_modbus_t fake;
    static fathom_modbus_unit_t unit;
    const fathom_modbus_unit_request_t measure = {values, 0x0100, 1, 3, 1};
    const fathom_modbus_unit_request_t version = {values, 0x0001, 3, 3, 0x81};
    fake_modbus_init(&fake);
    assert_int_equal(init_unit(&unit, &fake.modbus, &(fathom_modbus_config_t){.address = 9}, 300000, 100000),
                     FATHOM_OK);
    for (unsigned n = 0; n != 3; n++) {
        assert_int_equal(asks(&unit, &measure), FATHOM_PENDING);
        fake_modbus_send(&fake);
        assert_int_equal(asks(&unit, &measure), FATHOM_PENDING);
        fake_modbus_fail(&fake, FATHOM_ERR_NO_RESPONSE);
        fake.now_us += 300000;
        assert_int_equal(asks(&unit, &measure), FATHOM_ERR_NO_RESPONSE);
    }
    assert_int_equal(asks(&unit, &version), FATHOM_PENDING);
    assert_int_equal(fake.submits, 4);
}

/* line.h, FATHOM_LINE_SEND_US: "how long a port may ... take to send it, before it counts as broken". */
TEST(a_port_that_never_sends_is_broken_on_a_noisy_line_too)
{
    bench.fake.never_sent = true;
    ask_1(0);
    run_until_written(1, 100);
    for (unsigned i = 0; i != 60; i++) {
        receive_hex("00");
        run_in_steps(20000, 20000);
    }
    expect(FATHOM_ERR_PORT);
}

/* two A05 answer FF; the second one's response, 10 ms later (A05 2(3)1: 65..75 ms), is taken for the response to
 * the next request. */
TEST(the_second_response_to_unit_255_is_not_the_next_requests)
{
    ask_dyp(&bench.request, 255, 1, values);
    run_until_written(1, 100);
    run(65000);
    deliver_hex("55 AA 05 10 07 A1 BC");
    expect(FATHOM_OK);
    ask_dyp(&bench.other, 254, 1, &bench.other_value);
    run(10000);
    deliver_hex("55 AA FE 10 07 A1 B5");
    assert_int_equal(bench.other_value, 0xDEAD);
}
