/* SPDX-License-Identifier: MIT */
#include "check.h"

#include "semihosting.h"

static bool has_failed;

void check(bool is_right, const char *what)
{
    semihosting_write(is_right ? "ok " : "FAILED ");
    semihosting_write(what);
    semihosting_write("\n");
    if (!is_right) has_failed = true;
}

static void write_hex(uint32_t value)
{
    char text[] = " 00000000";
    for (unsigned i = 8; i != 0; i--, value >>= 4) text[i] = "0123456789ABCDEF"[value & 15];
    semihosting_write(text);
}

void check_within(uint32_t value, uint32_t least, uint32_t most, const char *what)
{
    const bool is_right = value >= least && value <= most;
    check(is_right, what);
    if (is_right) return;
    write_hex(value);
    write_hex(least);
    write_hex(most);
    semihosting_write("\n");
}

uint32_t counted_in_us(const counter_t *counter, const fathom_clock_t *clock, uint32_t length_us)
{
    const uint32_t since_us = clock->now_us(clock->ctx);
    const uint32_t since = *counter->at;
    while (fathom_elapsed_us(clock->now_us(clock->ctx), since_us) < length_us) continue;
    const uint32_t now = *counter->at;
    return (counter->is_down ? since - now : now - since) & counter->bits;
}

/* ARMv7-M B3.3: SYST_CSR, SYST_RVR, SYST_CVR */
enum { SYST_BITS = 0xFFFFFF, CLOCK_OF_THE_CORE_ON = 5 };
static volatile uint32_t *const syst = (volatile uint32_t *)0xE000E010u;
const counter_t systick = {(volatile uint32_t *)0xE000E018u, SYST_BITS, true};

void systick_begin(void)
{
    syst[1] = SYST_BITS;
    syst[2] = 0;
    syst[0] = CLOCK_OF_THE_CORE_ON;
}

uint32_t slept_us(const fathom_clock_t *clock, fathom_idle_t idle, void *idle_ctx, uint32_t max_us)
{
    const uint32_t since_us = clock->now_us(clock->ctx);
    idle(idle_ctx, max_us);
    return fathom_elapsed_us(clock->now_us(clock->ctx), since_us);
}

int check_short_sleeps(fathom_idle_t idle, void *idle_ctx)
{
    for (uint32_t us = 1; us <= 200; us++) idle(idle_ctx, us);
    check(true, "200 short sleeps have ended");
    return check_result();
}

int set(const fathom_uart_t *uart, uint32_t baud, uint8_t parity, uint8_t stop_bits)
{
    const fathom_line_settings_t line = {baud, parity, stop_bits};
    return uart->set_line(uart->ctx, &line);
}

void check_request(const fathom_uart_t *uart, uint8_t size, uint32_t takes_us)
{
    static const uint8_t many[32];
    check(uart->write(uart->ctx, many, size + 1U) < 0, "more than its memory holds is refused");
    check(uart->sent(uart->ctx) && uart->leaves_in_us(uart->ctx) == 0, "nothing leaves");
    check(uart->write(uart->ctx, many, size) == size, "a request is taken");
    check(!uart->sent(uart->ctx) && uart->leaves_in_us(uart->ctx) == takes_us, "which leaves");
    check(uart->write(uart->ctx, many, 8) == 0, "so that the next one is not taken");
    check(set(uart, 9600, FATHOM_PARITY_NONE, 1) == 0, "and no other rate");
}

int check_result(void) { return has_failed ? 1 : 0; }
