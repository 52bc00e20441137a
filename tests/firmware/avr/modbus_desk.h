/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TEST_AVR_MODBUS_DESK_H
#define FATHOM_TEST_AVR_MODBUS_DESK_H

#include "board.h"
#include "fathom/engine/line.h"
#include "reports.h"

/* The image "sensors" on RS-485 with two HPS-167S, addresses 1 and 2, each with faults of its own. */

typedef struct {
    fathom_sim_line_t line;
    fathom_sim_hps167s_t hps[2];
    fathom_sim_fault_t faults[2];
    uint32_t baud;
    uint32_t measured[2];    /* distances that each has been asked for: number n was desk_distance(unit, n) */
    uint32_t last_number[2]; /* the newest of which a reading came, + 1 */
    uint32_t samples[2];
    uint32_t errors[16]; /* by -status */
} desk_t;

extern desk_t desk;

/* Device 2 is silent unless the orders have ORDER_TWO_UNITS; clock_us: what the image's clock begins at, a multiple of
 * 32768. */
void desk_start(uint8_t orders, uint32_t clock_us);
/* For a suite_t: the image has not ended. */
int desk_stop(void **state);

/* Gives an image that waits for its orders these, and lets its clock begin there; returns when that was 0. */
uint32_t desk_begin(uint8_t orders, uint32_t clock_us);

/* Gives an order while it runs, and waits until it is obeyed. */
void desk_order(uint8_t order);

/* The counters of the line and of the port (parity, framing, overruns), as the image has them. */
void desk_counters(uint16_t line[FATHOM_LINE_COUNTERS], uint16_t port[3]);

/* Runs until so many readings and errors (of both units) have come since the start. Fails the test on a reading that
 * its device did not measure, on one that comes twice, or on none in 3 s. */
void desk_run(uint32_t reports);

/*
 * All that is on the wire, of which the log has everything: each request begins at least t3.5 after whatever was
 * before it, its bytes are back to back, and the driver is on around it and off before another may send.
 * Returns how many requests there were; silence_cycles: the shortest that was kept before one.
 */
uint32_t desk_assert_wire(uint64_t *silence_cycles);

#endif
