/* SPDX-License-Identifier: MIT */
/* The UART and the clock of the HAL on a simulated line. The clock moves when a program reads it or waits. */
#include "uart.h"

/* The lines must see the time at least every 30 minutes (sim.h). */
static const uint32_t most_unseen_us = UINT32_C(600000000);
static const uint32_t bounded_idle_us = UINT32_C(1000000);

/* ---- the clock ---- */

void fathom_sim_clock_init(fathom_sim_clock_t *clock, uint32_t start_us, uint32_t step_us)
{
    clock->now_us = start_us;
    clock->step_us = step_us;
    clock->unseen_us = 0;
    clock->ahead_us = clock->was_ahead_us = 0;
    clock->jumped_us = start_us;
    clock->lines = NULL;
}

static void show(fathom_sim_clock_t *clock)
{
    for (fathom_sim_line_t *line = clock->lines; line != NULL; line = line->next)
        fathom_sim_run(line, clock->now_us);
    clock->unseen_us = 0;
}

/* Nothing is waiting to be read from before the last jump: forget it, before times compare wrong. */
static void settle(fathom_sim_clock_t *clock)
{
    clock->jumped_us = clock->now_us;
    clock->was_ahead_us = clock->ahead_us;
}

/* by_us: at most most_unseen_us */
static void move(fathom_sim_clock_t *clock, uint32_t by_us)
{
    clock->now_us += by_us;
    clock->unseen_us += by_us;
    if (fathom_elapsed_us(clock->now_us, clock->jumped_us) > most_unseen_us) settle(clock);
    if (clock->unseen_us >= most_unseen_us) show(clock);
}

void fathom_sim_clock_advance(fathom_sim_clock_t *clock, uint32_t by_us)
{
    for (; by_us > most_unseen_us; by_us -= most_unseen_us) move(clock, most_unseen_us);
    move(clock, by_us);
    show(clock);
}

void fathom_sim_clock_jump(fathom_sim_clock_t *clock, uint32_t at_us, uint32_t by_us)
{
    clock->jumped_us = at_us;
    clock->was_ahead_us = clock->ahead_us;
    clock->ahead_us += by_us;
}

void fathom_sim_clock_idle(void *ctx, uint32_t max_us)
{
    fathom_sim_clock_t *const clock = (fathom_sim_clock_t *)ctx;
    uint32_t by_us = max_us;
    for (fathom_sim_line_t *line = clock->lines; line != NULL; line = line->next) {
        const uint32_t due_us = fathom_sim_due_us(line, clock->now_us);
        if (due_us < by_us) by_us = due_us;
    }
    if (by_us == FATHOM_NO_DEADLINE) by_us = bounded_idle_us;
    fathom_sim_clock_advance(clock, by_us);
}

void fathom_sim_clock_add(fathom_sim_clock_t *clock, fathom_sim_line_t *line)
{
    for (const fathom_sim_line_t *at = clock->lines; at != NULL; at = at->next)
        if (at == line) return;
    line->next = clock->lines;
    clock->lines = line;
}

uint32_t fathom_sim_clock_stamp_us(const fathom_sim_clock_t *clock, uint32_t at_us)
{
    const bool before = fathom_elapsed_us(at_us, clock->jumped_us) > INT32_MAX;
    return at_us + (before ? clock->was_ahead_us : clock->ahead_us);
}

static uint32_t now_us(void *ctx)
{
    fathom_sim_clock_t *const clock = (fathom_sim_clock_t *)ctx;
    if (clock->step_us > most_unseen_us)
        fathom_sim_clock_advance(clock, clock->step_us);
    else
        move(clock, clock->step_us);
    return clock->now_us + clock->ahead_us;
}

fathom_clock_t fathom_sim_clock(fathom_sim_clock_t *clock)
{
    const fathom_clock_t hal = {now_us, clock};
    return hal;
}

/* ---- the UART ---- */

static int read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    const fathom_sim_uart_t *const uart = (const fathom_sim_uart_t *)ctx;
    /* more than the line can hold is never there, so the result fits an int */
    if (capacity > FATHOM_SIM_QUEUE) capacity = FATHOM_SIM_QUEUE;
    const size_t count =
        fathom_sim_transmit_timed(uart->line, uart->clock->now_us, bytes, capacity, uart->knows, rx);
    if ((rx->flags & FATHOM_RX_TIMED) != 0) rx->last_us = fathom_sim_clock_stamp_us(uart->clock, rx->last_us);
    return (int)count;
}

static int write(void *ctx, const uint8_t *bytes, size_t length)
{
    const fathom_sim_uart_t *const uart = (const fathom_sim_uart_t *)ctx;
    if (length > FATHOM_SIM_QUEUE || !fathom_sim_sent(uart->line, uart->clock->now_us)) return 0;
    return (int)fathom_sim_receive(uart->line, bytes, length, uart->clock->now_us);
}

static bool sent(void *ctx)
{
    const fathom_sim_uart_t *const uart = (const fathom_sim_uart_t *)ctx;
    return fathom_sim_sent(uart->line, uart->clock->now_us);
}

static uint32_t leaves_in_us(void *ctx)
{
    const fathom_sim_uart_t *const uart = (const fathom_sim_uart_t *)ctx;
    return fathom_sim_leaves_in_us(uart->line, uart->clock->now_us);
}

static int set_break(void *ctx, bool on)
{
    const fathom_sim_uart_t *const uart = (const fathom_sim_uart_t *)ctx;
    if (!sent(ctx)) return 0;
    fathom_sim_break(uart->line, on, uart->clock->now_us);
    return 1;
}

static int set_line(void *ctx, const fathom_line_settings_t *settings)
{
    const fathom_sim_uart_t *const uart = (const fathom_sim_uart_t *)ctx;
    if (settings->baud < FATHOM_SIM_LEAST_BAUD || settings->baud > FATHOM_SIM_MOST_BAUD ||
        settings->parity > FATHOM_PARITY_ODD || settings->stop_bits < 1 || settings->stop_bits > 2)
        return -1;
    if (!sent(ctx)) return 0;
    fathom_sim_set_line(uart->line, settings, uart->clock->now_us);
    return 1;
}

void fathom_sim_uart_init(fathom_sim_uart_t *uart, fathom_sim_line_t *line, fathom_sim_clock_t *clock)
{
    uart->line = line;
    uart->clock = clock;
    uart->knows =
        FATHOM_RX_TIMED | FATHOM_RX_SILENCE | FATHOM_RX_PARITY | FATHOM_RX_FRAMING | FATHOM_RX_OVERRUN;
    fathom_sim_clock_add(clock, line);
}

fathom_uart_t fathom_sim_uart(fathom_sim_uart_t *uart)
{
    const fathom_uart_t hal = {.read = read,
                               .write = write,
                               .sent = sent,
                               .set_line = set_line,
                               .set_break = set_break,
                               .leaves_in_us = leaves_in_us,
                               .ctx = uart};
    return hal;
}
