/* SPDX-License-Identifier: MIT */
#include "echo_bench.h"
#include "fake_modbus.h"
#include "fathom/engine/internal/modbus_unit.h"
#include "fathom/engine/stream.h"

static uint16_t values[4];

static const suite_t suite = {.set_up = set_up};

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
