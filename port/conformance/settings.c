/* SPDX-License-Identifier: MIT */
/* The items of line settings and breaks. Each restores the first settings afterwards. */
#include <stddef.h>

#include "internal/kit.h"

static int set(const kit_t *kit, const fathom_line_settings_t *line)
{
    return kit->bench->uart->set_line(kit->bench->uart->ctx, line);
}

/* Sets the line as soon as the port is no longer busy. */
static int set_at_last(kit_t *kit, const fathom_line_settings_t *line)
{
    const uint32_t since_us = kit_now(kit);
    int result;
    do result = set(kit, line);
    while (result == 0 && kit_since(kit, since_us) < 1000000);
    return result;
}

static uint32_t character_of(const fathom_line_settings_t *line)
{
    const uint32_t bits = 9u + (line->parity != FATHOM_PARITY_NONE) + line->stop_bits;
    return (bits * 1000000u + line->baud - 1) / line->baud;
}

/* Returns the time of a character on the wire, from the times of the first byte and the last. Returns 0 if the bytes
 * did not arrive. */
static uint32_t takes_us(kit_t *kit)
{
    enum { LENGTH = 8 };
    kit_begin(kit);
    if (!kit_send(kit, LENGTH) || !kit_await(kit, LENGTH)) return 0;
    return fathom_elapsed_us(kit->arrivals[LENGTH - 1].at_us, kit->arrivals[0].at_us) / (LENGTH - 1);
}

static void holds(kit_t *kit)
{
    const fathom_line_settings_t *const other = &kit->bench->other;
    const uint32_t due_us = character_of(other);
    bool is_right = set(kit, &kit->bench->line) == 1 && set_at_last(kit, other) == 1 && set(kit, other) == 1;
    const uint32_t real_us = takes_us(kit);
    const uint32_t off_us = real_us > due_us ? real_us - due_us : due_us - real_us;
    if (kit->has_time && !kit_lacks(kit, BIT_OF(WRITE_NO_GAP)))
        is_right = is_right && off_us <= due_us / 20 + kit->step_us;
    is_right = set_at_last(kit, &kit->bench->line) == 1 && is_right;
    kit_tell(kit, SET_LINE_HOLDS, kit_kept_if(is_right && real_us + kit->step_us != 0), real_us);
}

/* If `sent` is false after the call too, the call came while bytes were leaving. */
static void waits(kit_t *kit)
{
    fathom_verdict_t verdict = FATHOM_NOT_SEEN;
    int result = 0;
    kit_begin(kit);
    if (kit_send(kit, 8)) {
        result = set(kit, &kit->bench->other);
        if (!kit_is_sent(kit)) verdict = kit_kept_if(result == 0);
        (void)kit_await_sent(kit);
    }
    (void)set_at_last(kit, &kit->bench->line);
    kit_tell(kit, SET_LINE_WAITS, verdict, (uint32_t)result);
}

static void keeps(kit_t *kit)
{
    uint16_t right = 0;
    kit_begin(kit);
    const bool is_sent = kit_send(kit, 8) && kit_await_sent(kit);
    kit_wait(kit, 2 * kit->character_us + kit->bench->late_us);
    const bool is_set = set_at_last(kit, &kit->bench->other) == 1;
    (void)kit_await(kit, 8);
    while (right != kit->got && kit->arrivals[right].byte == kit_value(kit, right)) right++;
    (void)set_at_last(kit, &kit->bench->line);
    kit_tell(kit, SET_LINE_KEEPS, is_sent && is_set ? kit_kept_if(right == 8) : FATHOM_NOT_SEEN, right);
}

/* No port has a rate of 0 or of a thousand million baud. After the refusal the previous settings are still in force. */
static void refuses(kit_t *kit)
{
    static const uint32_t rates[] = {0, 1000000007};
    uint32_t taken = 0;
    bool is_right = true;
    for (int i = 0; i != 2; i++) {
        fathom_line_settings_t line = kit->bench->line;
        line.baud = rates[i];
        if (set_at_last(kit, &line) < 0) continue;
        is_right = false;
        taken = rates[i];
    }
    if (!is_right) (void)set_at_last(kit, &kit->bench->line);
    const bool still = takes_us(kit) != 0 || !kit->has_time;
    kit_tell(kit, SET_LINE_REFUSES, kit_kept_if(is_right && still), taken);
}

/* Requests a break while bytes leave, and after they have left. Afterwards bytes must come back as before. */
static void set_break(kit_t *kit)
{
    const fathom_uart_t *const uart = kit->bench->uart;
    if (uart->set_break == NULL || !kit_has_wire(kit) || kit_lacks(kit, BIT_OF(SENT_NOT_EARLY))) {
        kit_tell(kit, SET_BREAK, FATHOM_NOT_SEEN, 0);
        return;
    }
    kit_begin(kit);
    (void)kit_send(kit, 8);
    int result = uart->set_break(uart->ctx, true);
    bool is_right = kit_is_sent(kit) || result == 0;
    (void)kit_await_sent(kit);
    if (result != 1) result = uart->set_break(uart->ctx, true);
    is_right = is_right && result == 1;
    kit_wait(kit, 20 * kit->character_us);
    is_right = uart->set_break(uart->ctx, false) == 1 && is_right;
    kit_begin(kit);
    is_right = kit_send(kit, 8) && kit_await(kit, 8) && is_right;
    kit_tell(kit, SET_BREAK, kit_kept_if(is_right), (uint32_t)result);
}

void kit_settings(kit_t *kit)
{
    if (kit->bench->uart->set_line == NULL || kit->bench->other.baud == 0 || !kit_has_wire(kit)) {
        for (unsigned item = SET_LINE_HOLDS; item != SET_BREAK; item++)
            kit_tell(kit, (item_t)item, FATHOM_NOT_SEEN, 0);
    } else {
        holds(kit);
        waits(kit);
        keeps(kit);
        refuses(kit);
    }
    set_break(kit);
}
