/* SPDX-License-Identifier: MIT */

/* HPS-167S over RS-485 when things go wrong: no reading is wrong, everything is told and counted, and the next exchange
 * is as before. */
#include <stdint.h>

#include "suite.h"

#include "fathom/status.h"
#include "modbus_desk.h"

static desk_t desk;
static uint16_t line[FATHOM_LINE_COUNTERS], port[3];

enum { PARITY = 0, FRAMING = 1, OVERRUNS = 2 }; /* of the port */

TEST(a_byte_with_wrong_parity_fails_its_answer_and_is_counted)
{
    uint64_t silence_cycles;
    desk_start(&desk, ORDER_BEGIN, 0);
    for (uint32_t frame = 5; frame <= 25; frame += 5)
        fathom_sim_fault_add(&desk.faults[0], FATHOM_SIM_FAULT_PARITY, FATHOM_SIM_FAULT_ALWAYS_PPM, frame);
    desk_run(&desk, 40);
    assert_int_equal(desk.faults[0].counters[FATHOM_SIM_FAULT_PARITY], 5);
    assert_int_equal(desk.errors[-FATHOM_ERR_CHECKSUM] + desk.errors[-FATHOM_ERR_NO_ANSWER], 5);
    assert_int_equal(desk.samples[0], 35);
    desk_assert_wire(&desk, &silence_cycles);
    desk_counters(&desk, line, port);
    assert_int_equal(port[PARITY], 5);
    assert_int_equal(port[FRAMING], 0);
    assert_int_equal(port[OVERRUNS], 0);
    assert_true(line[FATHOM_LINE_BAD_BYTES] >= 5);
    desk_end(&desk);
}

TEST(a_byte_without_a_stop_bit_fails_its_answer_and_is_counted)
{
    uint64_t silence_cycles;
    desk_start(&desk, ORDER_BEGIN, 0);
    for (uint32_t frame = 5; frame <= 25; frame += 5)
        fathom_sim_fault_add(&desk.faults[0], FATHOM_SIM_FAULT_FRAMING, FATHOM_SIM_FAULT_ALWAYS_PPM, frame);
    desk_run(&desk, 40);
    assert_int_equal(desk.errors[-FATHOM_ERR_CHECKSUM] + desk.errors[-FATHOM_ERR_NO_ANSWER], 5);
    assert_int_equal(desk.samples[0], 35);
    desk_assert_wire(&desk, &silence_cycles);
    desk_counters(&desk, line, port);
    assert_int_equal(port[PARITY], 0);
    assert_int_equal(port[FRAMING], 5);
    desk_end(&desk);
}

TEST(with_a_retry_a_damaged_answer_is_asked_for_again)
{
    uint64_t silence_cycles;
    desk_start(&desk, ORDER_BEGIN | ORDER_RETRY, 0);
    for (uint32_t frame = 5; frame <= 25; frame += 5)
        fathom_sim_fault_add(&desk.faults[0],
                             frame % 2 == 0 ? FATHOM_SIM_FAULT_PARITY : FATHOM_SIM_FAULT_FRAMING,
                             FATHOM_SIM_FAULT_ALWAYS_PPM, frame);
    desk_run(&desk, 40);
    assert_int_equal(desk.samples[0], 40);
    assert_in_range(desk_assert_wire(&desk, &silence_cycles), 45, 46);
    desk_counters(&desk, line, port);
    assert_int_equal(port[PARITY], 2);
    assert_int_equal(port[FRAMING], 3);
    desk_end(&desk);
}

/* The time-out is 100 ms; an answer that comes within twice of it is known for what it is. */
TEST(a_late_answer_is_recognised)
{
    uint64_t silence_cycles;
    desk_start(&desk, ORDER_BEGIN, 0);
    for (uint32_t frame = 5; frame <= 15; frame += 5)
        fathom_sim_fault_add(&desk.faults[0], FATHOM_SIM_FAULT_LATE, FATHOM_SIM_FAULT_ALWAYS_PPM, frame)->us =
            130000;
    desk_run(&desk, 40);
    assert_int_equal(desk.faults[0].counters[FATHOM_SIM_FAULT_LATE], 3);
    assert_int_equal(desk.errors[-FATHOM_ERR_NO_ANSWER], 3);
    assert_int_equal(desk.samples[0], 37);
    desk_assert_wire(&desk, &silence_cycles);
    desk_counters(&desk, line, port);
    assert_int_equal(line[FATHOM_LINE_LATE_ANSWERS], 3);
    desk_end(&desk);
}

/* On one pair of wires a late answer hits what goes on between the others; it delays its own unit alone. */
TEST(a_late_answer_among_others_spoils_what_it_hits_and_nothing_else)
{
    desk_start(&desk, ORDER_BEGIN | ORDER_TWO_UNITS, 0);
    for (uint32_t frame = 5; frame <= 15; frame += 5)
        fathom_sim_fault_add(&desk.faults[0], FATHOM_SIM_FAULT_LATE, FATHOM_SIM_FAULT_ALWAYS_PPM, frame)->us =
            130000;
    desk_run(&desk, 80);
    const uint32_t no_answers = desk.errors[-FATHOM_ERR_NO_ANSWER],
                   damaged = desk.errors[-FATHOM_ERR_CHECKSUM];
    assert_int_equal(desk.faults[0].counters[FATHOM_SIM_FAULT_LATE], 3);
    assert_true(desk.line.counters.collisions > 0);
    assert_in_range(no_answers + damaged, 3, 6);
    assert_int_equal(desk.samples[0] + desk.samples[1] + no_answers + damaged, 80);
    assert_true(desk.samples[1] > 35);
    assert_true(desk.samples[0] > 20);
    assert_int_equal(desk.board.cut_bytes, 0);
    desk_end(&desk);
}

TEST(damage_of_every_kind_never_makes_a_reading)
{
    static const uint8_t kinds[] = {
        FATHOM_SIM_FAULT_FLIP_BIT, FATHOM_SIM_FAULT_FLIP_BYTE, FATHOM_SIM_FAULT_DROP,
        FATHOM_SIM_FAULT_INSERT,   FATHOM_SIM_FAULT_TRUNCATE,  FATHOM_SIM_FAULT_OVERRUN,
        FATHOM_SIM_FAULT_PARITY,   FATHOM_SIM_FAULT_FRAMING,   FATHOM_SIM_FAULT_SILENCE,
        FATHOM_SIM_FAULT_SPLIT,    FATHOM_SIM_FAULT_EXCEPTION, FATHOM_SIM_FAULT_UNIT};
    desk_start(&desk, ORDER_BEGIN | ORDER_TWO_UNITS, 0);
    for (size_t i = 0; i < sizeof kinds; i++)
        for (int unit = 0; unit < 2; unit++) fathom_sim_fault_add(&desk.faults[unit], kinds[i], 20000, 0);
    desk_run(&desk, 600);
    uint32_t hit = 0;
    for (size_t i = 0; i < sizeof kinds; i++) hit += desk.faults[0].counters[kinds[i]];
    assert_true(hit > 30);
    assert_true(desk.samples[0] > 150);
    assert_true(desk.samples[1] > 150);
    desk_end(&desk);
}

/* Somebody else talks for 100 bytes while the main loop is away for 60 ms: the ring is full after 63. */
TEST(a_full_ring_is_counted_and_the_next_exchange_is_as_before)
{
    static uint8_t babble[100];
    for (size_t i = 0; i < sizeof babble; i++) babble[i] = (uint8_t)(0xC0 + i);
    desk_start(&desk, ORDER_BEGIN, 0);
    desk_run(&desk, 10);
    for (uint16_t round = 1; round <= 3; round++) {
        desk_order(&desk, ORDER_AWAY);
        board_feed(&desk.board, babble, NULL, sizeof babble, desk.board.avr->cycle, 16000000 / 115200 * 11);
        board_run_us(&desk.board, 20000);
        const uint32_t samples = desk.samples[0];
        uint32_t reports = samples + 10;
        for (int i = 0; i < 16; i++) reports += desk.errors[i];
        desk_run(&desk, reports);
        assert_true(desk.samples[0] - samples >= 8);
        desk_counters(&desk, line, port);
        assert_int_equal(port[OVERRUNS], round);
        assert_int_equal(port[PARITY] + port[FRAMING], 0);
    }
    desk_end(&desk);
}

/* The sensor's settings are not the processor's: garbage is no reading, and what it has at its own rate is. */
TEST(a_sensor_at_another_rate_is_never_read)
{
    desk_start(&desk, ORDER_BEGIN, 0);
    desk_run(&desk, 5);
    desk.hps[0].device.settings.baud = 57600;
    const uint32_t samples = desk.samples[0];
    desk_run(&desk, 10);
    assert_true(desk.samples[0] - samples <= 1); /* one was on its way */
    assert_true(desk.hps[0].device.counters.wrong_settings >= 8 * 4);
    desk.hps[0].device.settings.baud = 19200;
    for (uint32_t more = 1; desk.samples[0] < samples + 20; more++) {
        assert_true(more < 60);
        desk_run(&desk, desk.samples[0] + desk.errors[-FATHOM_ERR_NO_ANSWER] + 1);
    }
    desk_end(&desk);
}
