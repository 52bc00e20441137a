/* SPDX-License-Identifier: MIT */
#include "modbus_desk.h"

#include "suite.h"

#include "fathom/sample.h"
#include "wire.h"

static uint16_t distance_of(uint8_t unit, uint32_t number)
{
    return (uint16_t)((unit == 1 ? 1000 : 15000) + number % 13000);
}

desk_t desk;

/* Of the device with that number; ctx: how often it was asked. */
static int32_t measure(void *ctx, uint8_t probe, uint32_t now_us)
{
    uint32_t *const asked = (uint32_t *)ctx;
    return distance_of((uint8_t)(asked - desk.measured + 1), (*asked)++);
}

uint32_t desk_begin(uint8_t orders, uint32_t clock_us)
{
    const board_record_t *const ready = board_next_record(1000);
    assert_non_null(ready);
    assert_int_equal(ready->kind, REPORT_READY);
    const uint32_t zero_us = (uint32_t)(ready->cycle / BOARD_CYCLES_PER_US);
    for (int i = 0; i < 4; i++) board_data("periods_us")[i] = (uint8_t)(clock_us >> 8 * i);
    *board_data("ordered") = orders;
    assert_int_equal(board_next_record(1000)->kind, REPORT_BEGUN);
    return zero_us;
}

void desk_start(uint8_t orders, uint32_t clock_us)
{
    memset(&desk, 0, sizeof desk);
    desk.baud = (orders & ORDER_115200) != 0 ? 115200 : 19200;
    const fathom_line_settings_t settings = {desk.baud, FATHOM_PARITY_EVEN, 1};
    board_start("sensors");
    fathom_sim_line_init(&desk.line, &settings, board.clock.now_us);
    for (uint8_t i = 0; i < 2; i++) {
        const fathom_sim_hps167s_config_t config = {
            .address = (uint8_t)(1 + i),
            .baud_code = desk.baud == 115200 ? 3 : 1,
            .seed = i,
            .scene = {measure, &desk.measured[i]},
        };
        fathom_sim_hps167s_init(&desk.hps[i], &config);
        fathom_sim_fault_init(&desk.faults[i], 5U + i);
        fathom_sim_fault_attach(&desk.faults[i], &desk.line, &desk.hps[i].device);
        if (i == 0 || (orders & ORDER_TWO_UNITS) != 0)
            fathom_sim_attach(&desk.line, &desk.hps[i].device, board.clock.now_us);
    }
    board_join_line(&desk.line);
    board_join_driver('D', 3);
    desk_begin(orders, clock_us);
}

int desk_stop(void **state)
{
    const bool has_ended = board.finished;
    board_end();
    return has_ended;
}

static void take_sample(const board_record_t *record)
{
    const uint16_t mm = (uint16_t)board_number(record->bytes + 4, 2);
    const uint8_t unit = record->bytes[9];
    assert_in_range(unit, 1, 2);
    assert_int_equal(record->bytes[8], FATHOM_TARGET);
    const uint32_t measured = desk.measured[unit - 1];
    uint32_t number = measured;
    while (number != 0 && distance_of(unit, number - 1) != mm && measured - number < 20) number--;
    assert_int_not_equal(number, 0);
    assert_int_equal(distance_of(unit, number - 1), mm);
    assert_true(number > desk.last_number[unit - 1]);
    desk.last_number[unit - 1] = number;
    desk.samples[unit - 1]++;
}

static void take(const board_record_t *record)
{
    if (record->kind == REPORT_SAMPLE) take_sample(record);
    if (record->kind == REPORT_ERROR) desk.errors[record->bytes[0] & 15]++;
}

static const board_record_t *next(void)
{
    const board_record_t *const record = board_next_record(3000000);
    assert_non_null(record);
    take(record);
    return record;
}

void desk_run(uint32_t reports)
{
    for (;;) {
        uint32_t so_far = desk.samples[0] + desk.samples[1];
        for (int i = 0; i < 16; i++) so_far += desk.errors[i];
        if (so_far >= reports) return;
        next();
    }
}

void desk_order(uint8_t order)
{
    *board_data("ordered") = order;
    while (next()->kind != REPORT_ASKED) continue;
}

void desk_counters(uint16_t line[FATHOM_LINE_COUNTERS], uint16_t port[3])
{
    desk_order(ORDER_COUNTERS);
    for (int i = 0; i < 2; i++) {
        const board_record_t *record = next();
        while (record->kind != REPORT_COUNTERS) record = next();
        const uint8_t count = i == 0 ? FATHOM_LINE_COUNTERS : 3;
        assert_int_equal(record->length, 2 * count);
        for (uint8_t at = 0; at < count; at++)
            (i == 0 ? line : port)[at] = (uint16_t)board_number(record->bytes + 2 * at, 2);
    }
}

/* ---- the wire ---- */

/* t3.5 in cycles: of 11 bits at 19200, 1750 us above (HPS-167S 2.2.3). */
static uint64_t t3_5_cycles(void)
{
    return desk.baud > 19200 ? 1750 * BOARD_CYCLES_PER_US : (uint64_t)BOARD_HZ * 77 / 2 / 19200;
}

uint32_t desk_assert_wire(uint64_t *silence_cycles)
{
    const uint32_t bit_cycles = BOARD_HZ / desk.baud;
    wire_t wire = {0};
    *silence_cycles = UINT64_MAX;
    assert_true(board.bytes_seen < BOARD_BYTES && board.driver_edges_seen < BOARD_EDGES);
    assert_int_equal(board.cut_bytes, 0);
    assert_int_equal(board.talked_over, 0);
    while (wire_next_request(&wire)) {
        const uint64_t silence = wire.begin_cycle - wire.before_cycle;
        if (wire.before_cycle != 0) {
            assert_true(silence >= t3_5_cycles());
            if (silence < *silence_cycles) *silence_cycles = silence;
        }
        assert_in_range(wire.begin_cycle - wire.on_cycle, 1, bit_cycles - 1);
        if (wire.off_cycle != 0) assert_true(wire.off_cycle < wire.end_cycle + 3 * (uint64_t)bit_cycles);
    }
    assert_in_range(board.driver_edges_seen, 2 * wire.requests - 1, 2 * wire.requests + 1);
    return wire.requests;
}
