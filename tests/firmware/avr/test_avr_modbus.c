/* SPDX-License-Identifier: MIT */
/* HPS-167S over RS-485: the driver-enable pin, the silences, readings in any loop and across the wrap. */
#include "suite.h"

#include "fathom/status.h"
#include "modbus_desk.h"

static const suite_t suite = {.tear_down = desk_stop};

/* Each request has its response, all is well on the wire and nothing is counted. */
typedef struct {
    uint8_t orders;
    bool echo; /* of the line: an adapter or a transceiver whose receiver stays on hands back what is sent */
    uint32_t clock_us, readings;
    uint32_t more_requests; /* that may have been made */
    uint32_t least_us;      /* the shortest silence before a request; 0: any */
    uint32_t most_us;
} run_t;

static void assert_run(void **state)
{
    const run_t *const run = *state;
    uint64_t silence_cycles;
    uint16_t line[FATHOM_LINE_COUNTERS], port[3];
    desk_start(run->orders, run->clock_us);
    desk.line.echo = run->echo;
    desk_run(run->readings);
    assert_int_equal(desk.samples[0] + desk.samples[1], run->readings);
    if ((run->orders & ORDER_TWO_UNITS) != 0)
        assert_in_range(desk.samples[1], run->readings * 2 / 5 + 1, run->readings);
    assert_in_range(desk_assert_wire(&silence_cycles), run->readings, run->readings + run->more_requests);
    if (run->least_us != 0) {
        const uint64_t us = silence_cycles / BOARD_CYCLES_PER_US;
        print_message("%u baud: %u us between a response and the next request\n", (unsigned)desk.baud,
                      (unsigned)us);
        assert_in_range(us, run->least_us, run->most_us);
    }
    if (run->clock_us != 0)
        assert_true(board.avr->cycle > (uint64_t)(0 - run->clock_us) * BOARD_CYCLES_PER_US);
    desk_counters(line, port);
    for (int i = 0; i < 3; i++) assert_int_equal(port[i], 0);
    for (int i = 1; i < FATHOM_LINE_COUNTERS; i++) assert_int_equal(line[i], 0);
    for (int i = 0; i < 16; i++) assert_int_equal(desk.errors[i], 0);
    assert_int_equal(desk.hps[0].device.counters.crc_errors, 0);
    assert_int_equal(desk.hps[0].device.counters.truncated, 0);
    assert_int_equal(desk.hps[0].device.counters.unheard, 0);
    assert_int_equal(desk.hps[0].device.counters.wrong_settings, 0);
}

#define RUN(name, ...)                                                                                       \
    static const run_t name = {__VA_ARGS__};                                                                 \
    TEST_ROW(name, assert_run, &name)

RUN(every_request_has_its_response_and_the_wire_its_silences, ORDER_HPS167S, .readings = 60,
    .more_requests = 1)

/* Where two units wait to be asked, one request follows upon the other's response as soon as it may: t3.5 are 2005 us,
 * and the processor wakes and looks for less than half a millisecond. */
RUN(the_next_request_comes_t3_5_after_the_response_before_and_not_much_later, ORDER_HPS167S | ORDER_TWO_UNITS,
    .readings = 100, .more_requests = 1, .least_us = 2005, .most_us = 2504)

RUN(at_115200_too, ORDER_HPS167S | ORDER_TWO_UNITS | ORDER_115200, .readings = 100, .more_requests = 1,
    .least_us = 1750, .most_us = 2249)

RUN(in_a_loop_that_comes_round_every_20_ms, ORDER_HPS167S | ORDER_TWO_UNITS | ORDER_SLOW_LOOP, .readings = 40,
    .more_requests = 2)

/* 40 periods of Timer1 before the wrap: 1.3 s. */
RUN(across_the_wrap_of_the_clock, ORDER_HPS167S, .clock_us = UINT32_C(0) - 40 * 32768, .readings = 100,
    .more_requests = 1)

RUN(with_the_echo_of_the_line, ORDER_HPS167S, .echo = true, .readings = 40, .more_requests = 1)
RUN(with_the_echo_of_the_line_in_a_slow_loop, ORDER_HPS167S | ORDER_SLOW_LOOP, .echo = true, .readings = 40,
    .more_requests = 2)

TEST(a_unit_that_is_not_there_costs_its_time_outs_and_nothing_else)
{
    uint64_t silence_cycles;
    desk_start(ORDER_HPS167S | ORDER_TWO_UNITS, 0);
    fathom_sim_detach(&desk.line, &desk.hps[1].device, board.clock.now_us);
    board_plan();
    desk_run(100);
    assert_int_equal(desk.samples[1], 0);
    assert_true(desk.errors[-FATHOM_ERR_NO_RESPONSE] > 0);
    assert_int_equal(desk.samples[0] + desk.errors[-FATHOM_ERR_NO_RESPONSE], 100);
    assert_true(desk.samples[0] > 80);
    assert_in_range(desk_assert_wire(&silence_cycles), 100, 102);
}
