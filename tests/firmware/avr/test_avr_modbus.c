/* SPDX-License-Identifier: MIT */

/* HPS-167S over RS-485: the driver-enable pin, the silences, readings in any loop and across the wrap. */
#include <stdint.h>

#include "suite.h"

#include "fathom/status.h"
#include "modbus_desk.h"

static desk_t desk;

static void assert_all_well(void)
{
    uint16_t line[FATHOM_LINE_COUNTERS], port[3];
    desk_counters(&desk, line, port);
    for (int i = 0; i < 3; i++) assert_int_equal(port[i], 0);
    for (int i = 1; i < FATHOM_LINE_COUNTERS; i++) assert_int_equal(line[i], 0);
    for (int i = 0; i < 16; i++) assert_int_equal(desk.errors[i], 0);
    assert_int_equal(desk.hps[0].device.counters.crc_errors, 0);
    assert_int_equal(desk.hps[0].device.counters.torn, 0);
    assert_int_equal(desk.hps[0].device.counters.unheard, 0);
    assert_int_equal(desk.hps[0].device.counters.wrong_settings, 0);
}

TEST(every_request_has_its_answer_and_the_wire_its_silences)
{
    uint64_t silence_cycles;
    desk_start(&desk, ORDER_BEGIN, 0);
    desk_run(&desk, 60);
    assert_int_equal(desk.samples[0], 60);
    assert_in_range(desk_assert_wire(&desk, &silence_cycles), 60, 61);
    assert_all_well();
    desk_end(&desk);
}

/* Where two units wait to be asked, one request follows upon the other's answer as soon as it may: t3.5 are 2005 us,
 * and the processor wakes and looks for less than half a millisecond. */
TEST(the_next_request_comes_t3_5_after_the_answer_before_and_not_much_later)
{
    uint64_t silence_cycles;
    desk_start(&desk, ORDER_BEGIN | ORDER_TWO_UNITS, 0);
    desk_run(&desk, 100);
    assert_int_equal(desk.samples[0] + desk.samples[1], 100);
    assert_true(desk.samples[1] > 40);
    assert_in_range(desk_assert_wire(&desk, &silence_cycles), 100, 101);
    assert_in_range(silence_cycles, 2005 * BOARD_CYCLES_PER_US, 2505 * BOARD_CYCLES_PER_US);
    print_message("19200: %u us between an answer and the next request\n",
                  (unsigned)(silence_cycles / BOARD_CYCLES_PER_US));
    assert_all_well();
    desk_end(&desk);
}

TEST(at_115200_too)
{
    uint64_t silence_cycles;
    desk_start(&desk, ORDER_BEGIN | ORDER_TWO_UNITS | ORDER_115200, 0);
    desk_run(&desk, 100);
    assert_int_equal(desk.samples[0] + desk.samples[1], 100);
    assert_in_range(desk_assert_wire(&desk, &silence_cycles), 100, 101);
    assert_in_range(silence_cycles, 1750 * BOARD_CYCLES_PER_US, 2250 * BOARD_CYCLES_PER_US);
    print_message("115200: %u us between an answer and the next request\n",
                  (unsigned)(silence_cycles / BOARD_CYCLES_PER_US));
    assert_all_well();
    desk_end(&desk);
}

TEST(in_a_loop_that_comes_round_every_20_ms)
{
    uint64_t silence_cycles;
    desk_start(&desk, ORDER_BEGIN | ORDER_TWO_UNITS | ORDER_SLOW_LOOP, 0);
    desk_run(&desk, 40);
    assert_int_equal(desk.samples[0] + desk.samples[1], 40);
    desk_assert_wire(&desk, &silence_cycles);
    assert_all_well();
    desk_end(&desk);
}

/* 40 periods of Timer1 before the wrap: 1.3 s. */
TEST(across_the_wrap_of_the_clock)
{
    uint64_t silence_cycles;
    desk_start(&desk, ORDER_BEGIN, UINT32_C(0) - 40 * 32768);
    desk_run(&desk, 100);
    assert_true(desk.board.avr->cycle > (uint64_t)40 * 32768 * BOARD_CYCLES_PER_US);
    assert_int_equal(desk.samples[0], 100);
    assert_in_range(desk_assert_wire(&desk, &silence_cycles), 100, 101);
    assert_all_well();
    desk_end(&desk);
}

/* An adapter, or a transceiver whose receiver stays on, hands back what is sent. */
TEST(with_the_echo_of_the_line)
{
    uint64_t silence_cycles;
    for (int slow = 0; slow < 2; slow++) {
        desk_start(&desk, (uint8_t)(ORDER_BEGIN | (slow != 0 ? ORDER_SLOW_LOOP : 0)), 0);
        desk.line.echo = true;
        desk_run(&desk, 40);
        assert_int_equal(desk.samples[0], 40);
        desk_assert_wire(&desk, &silence_cycles);
        assert_all_well();
        desk_end(&desk);
    }
}

TEST(a_unit_that_is_not_there_costs_its_time_outs_and_nothing_else)
{
    uint64_t silence_cycles;
    desk_start(&desk, ORDER_BEGIN | ORDER_TWO_UNITS, 0);
    fathom_sim_detach(&desk.line, &desk.hps[1].device, desk.board.clock.now_us);
    board_plan(&desk.board);
    desk_run(&desk, 100);
    assert_int_equal(desk.samples[1], 0);
    assert_true(desk.errors[-FATHOM_ERR_NO_ANSWER] > 0);
    assert_int_equal(desk.samples[0] + desk.errors[-FATHOM_ERR_NO_ANSWER], 100);
    assert_true(desk.samples[0] > 80);
    assert_in_range(desk_assert_wire(&desk, &silence_cycles), 100, 102);
    desk_end(&desk);
}
