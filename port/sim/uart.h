/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_SIM_UART_H
#define FATHOM_SIM_UART_H

#include <stdint.h>

#include "fathom/hal.h"
#include "sim.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * The HAL of an application on a desk: a fathom_uart_t whose far end is a simulated line, and a fathom_clock_t
 * in simulated time, deterministic and as fast as the machine can count.
 *
 * Time moves in three ways, which go together:
 *   - the test moves it:            fathom_sim_clock_advance(&clock, 20000);
 *   - a blocking wait moves it:     fathom_sim_clock_idle is an `idle(ctx, max_us)` hook, ctx the clock: it
 *                                   goes to the next thing that happens on any of the clock's lines, but not
 *                                   further than max_us;
 *   - each look at the clock does:  step_us, for a main loop that just polls. 50 is a good number; 0 for
 *                                   none, as tests with exact times want it.
 */
typedef struct {
    uint32_t now_us;  /* may be read; is moved by the functions below only */
    uint32_t step_us; /* the caller's to change */
    uint32_t unseen_us;
    uint32_t ahead_us; /* of now_us is what the HAL's clock and time stamps have */
    uint32_t was_ahead_us;
    uint32_t jumped_us; /* at this now_us it was `was_ahead_us` until then */
    fathom_sim_line_t *lines;
} fathom_sim_clock_t;

/* start_us: any, e.g. 0xFFFF0000 to see the wrap soon. */
void fathom_sim_clock_init(fathom_sim_clock_t *clock, uint32_t start_us, uint32_t step_us);

/* Moves the time on by as much as you like and lets all lines live through it. */
void fathom_sim_clock_advance(fathom_sim_clock_t *clock, uint32_t by_us);

/* The HAL's clock, and nothing else, jumps: the host was stopped with its clock going on, or the user set it.
 * From then on it is ahead of now_us by so much; bytes that ended before at_us keep their time stamps. */
void fathom_sim_clock_jump(fathom_sim_clock_t *clock, uint32_t at_us, uint32_t by_us);

/* The idle hook; `clock` is a fathom_sim_clock_t. With no limit (FATHOM_NO_DEADLINE) and nothing to come it
 * moves one second. */
void fathom_sim_clock_idle(void *clock, uint32_t max_us);

/* Puts `line` on the clock, if it is not there yet: it lives through what the clock does. */
void fathom_sim_clock_add(fathom_sim_clock_t *clock, fathom_sim_line_t *line);

/* What the HAL's clock had when it was at_us, up to 10 minutes ago. */
uint32_t fathom_sim_clock_stamp_us(const fathom_sim_clock_t *clock, uint32_t at_us);

/* The HAL's clock: each now_us() moves the time by step_us first. */
fathom_clock_t fathom_sim_clock(fathom_sim_clock_t *clock);

/*
 * A UART at the host's end of a line. write takes all or, until the last one has left the pin, nothing;
 * sent is exact. set_line refuses other rates than FATHOM_SIM_LEAST_BAUD to FATHOM_SIM_MOST_BAUD (wire.h). set_break
 * holds the RX pins of the devices low. read reports what is in `knows` (FATHOM_RX_..., all of
 * them after init): set it to 0 to be a port that knows nothing. None of them moves the time.
 */
typedef struct {
    fathom_sim_line_t *line;
    fathom_sim_clock_t *clock;
    uint8_t knows; /* the caller's to change */
} fathom_sim_uart_t;

/* Puts `line` on `clock` (it may be there already; one clock for a line's life) and a UART on it. Both
 * outlive the UART. The line was initialised with the same time: clock->now_us. */
void fathom_sim_uart_init(fathom_sim_uart_t *uart, fathom_sim_line_t *line, fathom_sim_clock_t *clock);

fathom_uart_t fathom_sim_uart(fathom_sim_uart_t *uart);

#ifdef __cplusplus
}
#endif

#endif
