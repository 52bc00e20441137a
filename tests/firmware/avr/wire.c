/* SPDX-License-Identifier: MIT */
#include "wire.h"

#include "suite.h"

enum { REQUEST = 8 };

static uint64_t driver_cycle(uint32_t number, bool high)
{
    if (number >= board.driver_edges_seen) return 0;
    assert_int_equal(board.driver_edges[number].high, high);
    return board.driver_edges[number].cycle;
}

bool wire_next_request(wire_t *wire)
{
    if (wire->requests != 0) wire->before_cycle = wire->end_cycle;
    for (; wire->at < board.bytes_seen && !board.bytes[wire->at].from_here; wire->at++)
        wire->before_cycle = board.bytes[wire->at].end_cycle;
    if (wire->at + REQUEST > board.bytes_seen) return false;
    wire->begin_cycle = wire->end_cycle = board.bytes[wire->at].begin_cycle;
    for (int sent = 0; sent < REQUEST; wire->at++) {
        const board_byte_t *const byte = &board.bytes[wire->at];
        if (!byte->from_here) continue; /* an echo */
        assert_int_equal(byte->begin_cycle, wire->end_cycle);
        wire->end_cycle = byte->end_cycle;
        sent++;
    }
    wire->on_cycle = driver_cycle(2 * wire->requests, true);
    wire->off_cycle = driver_cycle(2 * wire->requests + 1, false);
    wire->requests++;
    assert_true(wire->on_cycle != 0 && wire->on_cycle <= wire->begin_cycle);
    assert_true(wire->off_cycle == 0 || wire->off_cycle >= wire->end_cycle);
    return true;
}
