/* SPDX-License-Identifier: MIT */
/* HPS-167S over RS-485 when things go wrong: no reading is wrong, everything is told and counted, and the next
 * transaction is as before. */
#include "suite.h"

#include "fathom/status.h"
#include "modbus_desk.h"

static const suite_t suite = {.tear_down = desk_stop};

static uint16_t line[FATHOM_LINE_COUNTERS], port[3];

enum { PARITY = 0, FRAMING = 1, OVERRUNS = 2 }; /* of the port */

/* 40 reports, while every fifth response up to `last` has a fault, of these kinds in turns. */
typedef struct {
    uint8_t orders, kinds[2];
    uint32_t last, late_us, requests;
    uint32_t no_responses; /* FATHOM_ERR_NO_RESPONSE, or where the line saw the damage FATHOM_ERR_CHECKSUM */
    uint16_t parity;       /* that the port counts */
    uint16_t framing;
    uint16_t late; /* that the line counts */
} damaged_t;

static void assert_damaged(void **state)
{
    const damaged_t *const row = *state;
    uint64_t silence_cycles;
    desk_start(row->orders, 0);
    for (uint32_t frame = 5; frame <= row->last; frame += 5)
        fathom_sim_fault_add(&desk.faults[0], row->kinds[frame % 2], FATHOM_SIM_FAULT_ALWAYS_PPM, frame)->us =
            row->late_us;
    desk_run(40);
    const uint32_t *const hits = desk.faults[0].counters;
    assert_int_equal(hits[row->kinds[0]] + (row->kinds[0] != row->kinds[1] ? hits[row->kinds[1]] : 0),
                     row->last / 5);
    assert_int_equal(desk.errors[-FATHOM_ERR_CHECKSUM] + desk.errors[-FATHOM_ERR_NO_RESPONSE],
                     row->no_responses);
    if (row->late != 0) assert_int_equal(desk.errors[-FATHOM_ERR_CHECKSUM], 0);
    assert_int_equal(desk.samples[0], 40 - row->no_responses);
    assert_in_range(desk_assert_wire(&silence_cycles), row->requests, row->requests + 1);
    desk_counters(line, port);
    assert_int_equal(port[PARITY], row->parity);
    assert_int_equal(port[FRAMING], row->framing);
    assert_int_equal(port[OVERRUNS], 0);
    assert_true(line[FATHOM_LINE_BAD_BYTES] >= row->parity);
    assert_int_equal(line[FATHOM_LINE_LATE_RESPONSES], row->late);
}

#define DAMAGED(name, ...)                                                                                   \
    static const damaged_t name = {__VA_ARGS__};                                                             \
    TEST_ROW(name, assert_damaged, &name)

DAMAGED(a_byte_with_wrong_parity_fails_its_response_and_is_counted, ORDER_HPS167S,
        {FATHOM_SIM_FAULT_PARITY, FATHOM_SIM_FAULT_PARITY}, 25, .requests = 40, .no_responses = 5,
        .parity = 5)

DAMAGED(a_byte_without_a_stop_bit_fails_its_response_and_is_counted, ORDER_HPS167S,
        {FATHOM_SIM_FAULT_FRAMING, FATHOM_SIM_FAULT_FRAMING}, 25, .requests = 40, .no_responses = 5,
        .framing = 5)

DAMAGED(with_a_retry_a_damaged_response_is_asked_for_again, ORDER_HPS167S | ORDER_RETRY,
        {FATHOM_SIM_FAULT_PARITY, FATHOM_SIM_FAULT_FRAMING}, 25, .requests = 45, .parity = 2, .framing = 3)

/* The time-out is 100 ms; a response that comes within twice of it is known for what it is. */
DAMAGED(a_late_response_is_recognised, ORDER_HPS167S, {FATHOM_SIM_FAULT_LATE, FATHOM_SIM_FAULT_LATE}, 15,
        .late_us = 130000, .requests = 40, .no_responses = 3, .late = 3)

/* On one pair of wires a late response hits what goes on between the others; it delays its own unit alone. */
TEST(a_late_response_among_others_damages_what_it_hits_and_nothing_else)
{
    desk_start(ORDER_HPS167S | ORDER_TWO_UNITS, 0);
    for (uint32_t frame = 5; frame <= 15; frame += 5)
        fathom_sim_fault_add(&desk.faults[0], FATHOM_SIM_FAULT_LATE, FATHOM_SIM_FAULT_ALWAYS_PPM, frame)->us =
            130000;
    desk_run(80);
    const uint32_t no_responses = desk.errors[-FATHOM_ERR_NO_RESPONSE],
                   damaged = desk.errors[-FATHOM_ERR_CHECKSUM];
    assert_int_equal(desk.faults[0].counters[FATHOM_SIM_FAULT_LATE], 3);
    assert_true(desk.line.counters.collisions > 0);
    assert_in_range(no_responses + damaged, 3, 6);
    assert_int_equal(desk.samples[0] + desk.samples[1] + no_responses + damaged, 80);
    assert_true(desk.samples[1] > 35);
    assert_true(desk.samples[0] > 20);
    assert_int_equal(board.cut_bytes, 0);
}

TEST(damage_of_every_kind_never_makes_a_reading)
{
    static const uint8_t kinds[] = {
        FATHOM_SIM_FAULT_FLIP_BIT, FATHOM_SIM_FAULT_FLIP_BYTE, FATHOM_SIM_FAULT_DROP,
        FATHOM_SIM_FAULT_INSERT,   FATHOM_SIM_FAULT_TRUNCATE,  FATHOM_SIM_FAULT_OVERRUN,
        FATHOM_SIM_FAULT_PARITY,   FATHOM_SIM_FAULT_FRAMING,   FATHOM_SIM_FAULT_SILENCE,
        FATHOM_SIM_FAULT_SPLIT,    FATHOM_SIM_FAULT_EXCEPTION, FATHOM_SIM_FAULT_UNIT};
    desk_start(ORDER_HPS167S | ORDER_TWO_UNITS, 0);
    for (size_t i = 0; i < sizeof kinds; i++)
        for (int unit = 0; unit < 2; unit++) fathom_sim_fault_add(&desk.faults[unit], kinds[i], 20000, 0);
    desk_run(600);
    uint32_t hit = 0;
    for (size_t i = 0; i < sizeof kinds; i++) hit += desk.faults[0].counters[kinds[i]];
    assert_true(hit > 30);
    assert_true(desk.samples[0] > 150);
    assert_true(desk.samples[1] > 150);
}

/* Another device sends 100 bytes while the main loop is away for 60 ms: the ring is full after 63. */
TEST(a_full_ring_is_counted_and_the_next_transaction_is_as_before)
{
    static uint8_t babble[100];
    for (size_t i = 0; i < sizeof babble; i++) babble[i] = (uint8_t)(0xC0 + i);
    desk_start(ORDER_HPS167S, 0);
    desk_run(10);
    for (uint16_t round = 1; round <= 3; round++) {
        desk_order(ORDER_AWAY);
        board_feed(babble, NULL, sizeof babble, board.avr->cycle, 16000000 / 115200 * 11);
        board_run_us(20000);
        const uint32_t samples = desk.samples[0];
        uint32_t reports = samples + 10;
        for (int i = 0; i < 16; i++) reports += desk.errors[i];
        desk_run(reports);
        assert_true(desk.samples[0] - samples >= 8);
        desk_counters(line, port);
        assert_int_equal(port[OVERRUNS], round);
        assert_int_equal(port[PARITY] + port[FRAMING], 0);
    }
}

/* The sensor's settings are not the processor's: garbage is no reading, and what it has at its own rate is. */
TEST(a_sensor_at_another_rate_is_never_read)
{
    desk_start(ORDER_HPS167S, 0);
    desk_run(5);
    desk.hps[0].device.settings.baud = 57600;
    const uint32_t samples = desk.samples[0];
    desk_run(10);
    assert_true(desk.samples[0] - samples <= 1); /* one was on its way */
    assert_true(desk.hps[0].device.counters.wrong_settings >= 8 * 4);
    desk.hps[0].device.settings.baud = 19200;
    for (uint32_t more = 1; desk.samples[0] < samples + 20; more++) {
        assert_true(more < 60);
        desk_run(desk.samples[0] + desk.errors[-FATHOM_ERR_NO_RESPONSE] + 1);
    }
}
