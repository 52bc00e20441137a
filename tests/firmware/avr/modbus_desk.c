/* SPDX-License-Identifier: MIT */
#include "modbus_desk.h"

#include <string.h>

#include "suite.h"

#include "fathom/sample.h"

enum { REQUEST = 8, GPIOR0 = 0x3E };

static uint16_t distance_of(uint8_t unit, uint32_t number)
{
    return (uint16_t)((unit == 1 ? 1000 : 15000) + number % 13000);
}

static int32_t measure(desk_t *desk, uint8_t unit) { return distance_of(unit, desk->measured[unit - 1]++); }

static int32_t measure_1(void *ctx, uint8_t probe, uint32_t now_us)
{
    (void)probe, (void)now_us;
    return measure((desk_t *)ctx, 1);
}

static int32_t measure_2(void *ctx, uint8_t probe, uint32_t now_us)
{
    (void)probe, (void)now_us;
    return measure((desk_t *)ctx, 2);
}

void desk_start(desk_t *desk, uint8_t orders, uint32_t clock_us)
{
    memset(desk, 0, sizeof *desk);
    desk->baud = (orders & ORDER_115200) != 0 ? 115200 : 19200;
    const fathom_line_settings_t settings = {desk->baud, FATHOM_PARITY_EVEN, 1};
    assert_true(board_start(&desk->board, "modbus"));
    fathom_sim_line_init(&desk->line, &settings, desk->board.clock.now_us);
    for (uint8_t i = 0; i < 2; i++) {
        const fathom_sim_hps167s_config_t config = {
            .unit = (uint8_t)(1 + i),
            .baud_code = desk->baud == 115200 ? 3 : 1,
            .seed = i,
            .scene = {i == 0 ? measure_1 : measure_2, desk},
        };
        fathom_sim_hps167s_init(&desk->hps[i], &config);
        fathom_sim_fault_init(&desk->faults[i], 5U + i);
        fathom_sim_fault_attach(&desk->faults[i], &desk->line, &desk->hps[i].device);
        if (i == 0 || (orders & ORDER_TWO_UNITS) != 0)
            fathom_sim_attach(&desk->line, &desk->hps[i].device, desk->board.clock.now_us);
    }
    board_join_line(&desk->board, &desk->line);
    board_join_driver(&desk->board, 'D', 3);
    const board_record_t *const ready = board_next_record(&desk->board, 1000);
    assert_non_null(ready);
    assert_int_equal(ready->kind, REPORT_READY);
    desk->zero_us = (uint32_t)(ready->cycle / BOARD_CYCLES_PER_US);
    for (int i = 0; i < 4; i++) board_data(&desk->board, "periods_us")[i] = (uint8_t)(clock_us >> 8 * i);
    desk->board.avr->data[GPIOR0] = orders;
    assert_int_equal(board_next_record(&desk->board, 1000)->kind, REPORT_BEGUN);
}

void desk_end(desk_t *desk)
{
    assert_false(desk->board.finished);
    board_end(&desk->board);
}

static void take_sample(desk_t *desk, const board_record_t *record)
{
    const uint16_t mm = (uint16_t)(record->bytes[4] | record->bytes[5] << 8);
    const uint8_t unit = record->bytes[9];
    assert_in_range(unit, 1, 2);
    assert_int_equal(record->bytes[8], FATHOM_TARGET);
    const uint32_t measured = desk->measured[unit - 1];
    uint32_t number = measured;
    while (number != 0 && distance_of(unit, number - 1) != mm && measured - number < 20) number--;
    assert_int_not_equal(number, 0);
    assert_int_equal(distance_of(unit, number - 1), mm);
    assert_true(number > desk->last_number[unit - 1]);
    desk->last_number[unit - 1] = number;
    desk->samples[unit - 1]++;
}

static void take(desk_t *desk, const board_record_t *record)
{
    if (record->kind == REPORT_SAMPLE) take_sample(desk, record);
    if (record->kind == REPORT_ERROR) desk->errors[record->bytes[0] & 15]++;
}

static const board_record_t *next(desk_t *desk)
{
    const board_record_t *const record = board_next_record(&desk->board, 3000000);
    assert_non_null(record);
    take(desk, record);
    return record;
}

void desk_run(desk_t *desk, uint32_t reports)
{
    for (;;) {
        uint32_t so_far = desk->samples[0] + desk->samples[1];
        for (int i = 0; i < 16; i++) so_far += desk->errors[i];
        if (so_far >= reports) return;
        next(desk);
    }
}

void desk_order(desk_t *desk, uint8_t order)
{
    desk->board.avr->data[GPIOR0] = order;
    while (next(desk)->kind != REPORT_ASKED) {
    }
}

void desk_counters(desk_t *desk, uint16_t line[FATHOM_LINE_COUNTERS], uint16_t port[3])
{
    desk_order(desk, ORDER_COUNTERS);
    for (int i = 0; i < 2; i++) {
        const board_record_t *record = next(desk);
        while (record->kind != REPORT_COUNTERS) record = next(desk);
        const uint8_t count = i == 0 ? FATHOM_LINE_COUNTERS : 3;
        assert_int_equal(record->length, 2 * count);
        for (uint8_t at = 0; at < count; at++)
            (i == 0 ? line : port)[at] = (uint16_t)(record->bytes[2 * at] | record->bytes[2 * at + 1] << 8);
    }
}

/* ---- the wire ---- */

static const board_edge_t *edge(const desk_t *desk, uint32_t number)
{
    assert_true(number < desk->board.driver_edges_seen);
    return &desk->board.driver_edges[number % BOARD_EDGES];
}

/* t3.5 in cycles: of 11 bits at 19200, 1750 us above (HPS-167S 2.2.3). */
static uint64_t t3_5_cycles(const desk_t *desk)
{
    return desk->baud > 19200 ? 1750 * BOARD_CYCLES_PER_US : (uint64_t)BOARD_HZ * 77 / 2 / 19200;
}

uint32_t desk_assert_wire(const desk_t *desk, uint64_t *silence_cycles)
{
    const board_t *const board = &desk->board;
    const uint32_t bit_cycles = BOARD_HZ / desk->baud;
    uint32_t requests = 0;
    uint64_t before_cycle = 0; /* the end of whatever came before */
    *silence_cycles = UINT64_MAX;
    assert_true(board->bytes_seen < BOARD_BYTES && board->driver_edges_seen < BOARD_EDGES);
    assert_int_equal(board->cut_bytes, 0);
    assert_int_equal(board->talked_over, 0);
    for (uint32_t i = 0; i < board->bytes_seen;) {
        if (!board->bytes[i].from_here) {
            before_cycle = board->bytes[i++].end_cycle;
            continue;
        }
        if (i + REQUEST > board->bytes_seen) break; /* it is still leaving */
        const uint64_t begin_cycle = board->bytes[i].begin_cycle;
        uint64_t end_cycle = begin_cycle;
        for (uint32_t sent = 0; sent < REQUEST; i++) {
            if (!board->bytes[i].from_here) continue; /* an echo */
            assert_int_equal(board->bytes[i].begin_cycle, end_cycle);
            end_cycle = board->bytes[i].end_cycle;
            sent++;
        }
        if (before_cycle != 0) {
            assert_true(begin_cycle - before_cycle >= t3_5_cycles(desk));
            if (begin_cycle - before_cycle < *silence_cycles) *silence_cycles = begin_cycle - before_cycle;
        }
        before_cycle = end_cycle;
        if (2 * requests + 1 < board->driver_edges_seen) {
            assert_true(edge(desk, 2 * requests)->high);
            assert_true(edge(desk, 2 * requests)->cycle < begin_cycle);
            assert_true(begin_cycle - edge(desk, 2 * requests)->cycle < bit_cycles);
            assert_false(edge(desk, 2 * requests + 1)->high);
            assert_true(edge(desk, 2 * requests + 1)->cycle >= end_cycle);
            assert_true(edge(desk, 2 * requests + 1)->cycle < end_cycle + 3 * (uint64_t)bit_cycles);
        }
        requests++;
    }
    assert_in_range(board->driver_edges_seen, 2 * requests - 1, 2 * requests + 1);
    return requests;
}
