/* SPDX-License-Identifier: MIT */
/*
 * The policy of a line to a Modbus TCP server: no request leaves while a response is pending. Otherwise a gateway
 * that still tries a dead unit answers each following request too late, and so for ever.
 */
#include <stddef.h>

#include "internal/libmodbus_port.h"

uint32_t fathom_libmodbus_now_us(const fathom_libmodbus_t *port)
{
    return port->parts.clock->now_us(port->parts.clock->ctx);
}

enum { MOST_OVERTAKEN = 8 };

static bool is_silent(const fathom_libmodbus_t *port, uint8_t unit)
{
    return (port->silent[unit / 8] >> unit % 8 & 1) != 0;
}

void fathom_libmodbus_note_response_of(fathom_libmodbus_t *port, uint8_t unit)
{
    port->silent[unit / 8] &= (uint8_t) ~(1u << unit % 8);
}

/* Returns true if the server may be busy with a request that it has not responded to. */
static bool may_be_busy(const fathom_libmodbus_t *port)
{
    if (!port->is_response_pending) return false;
    if (port->is_busy_us_known) return true;
    return !port->is_never_busy && (!port->has_held || port->is_crowded);
}

/* Returns the time for which the response to the newest request may still be pending, in microseconds. */
static uint32_t hold_left_us(fathom_libmodbus_t *port)
{
    if (!may_be_busy(port)) return 0;
    const uint32_t sent_us = port->sent_us[port->transaction % FATHOM_LIBMODBUS_DATED];
    const uint32_t passed_us = fathom_elapsed_us(fathom_libmodbus_now_us(port), sent_us);
    if (passed_us < port->busy_us) return port->busy_us - passed_us;
    port->is_response_pending = false;
    port->has_held = true;
    return 0;
}

void fathom_libmodbus_note_request(fathom_libmodbus_t *port, uint8_t unit)
{
    const uint32_t now_us = fathom_libmodbus_now_us(port);
    const uint32_t last_us = port->sent_us[(port->transaction - 1u) % FATHOM_LIBMODBUS_DATED];
    port->sent_us[port->transaction % FATHOM_LIBMODBUS_DATED] = now_us;
    port->is_crowded = port->has_unanswered && fathom_elapsed_us(now_us, last_us) < port->hold_us;
    port->is_response_pending = unit != 0; /* No unit responds to a broadcast. */
    port->is_overdue = false;
    if (unit == 0) return;
    if (!port->has_unanswered) port->unanswered_us = now_us;
    port->has_unanswered = true;
    if (is_silent(port, unit))
        port->overtaken = 0;
    else if (port->overtaken < MOST_OVERTAKEN)
        port->overtaken++;
    port->silent[unit / 8] |= (uint8_t)(1u << unit % 8);
}

void fathom_libmodbus_note_broken(fathom_libmodbus_t *port)
{
    port->is_response_pending = false;
    port->has_unanswered = false;
}

void fathom_libmodbus_note_response(fathom_libmodbus_t *port, bool is_to_newest)
{
    const bool is_late = !is_to_newest || port->is_overdue;
    const bool has_unanswered = port->has_unanswered;
    if (is_to_newest) port->is_response_pending = false;
    port->has_unanswered = false;
    if (!is_late && port->is_crowded) port->is_never_busy = true;
    if (!is_late || !has_unanswered) return;
    const uint32_t passed_us = fathom_elapsed_us(fathom_libmodbus_now_us(port), port->unanswered_us);
    const uint32_t busy_us = passed_us + passed_us / 4;
    port->busy_us = busy_us < port->hold_us ? busy_us : port->hold_us;
    port->is_busy_us_known = true;
}

static fathom_libmodbus_t *port_of(fathom_line_turns_t *turns)
{
    return (fathom_libmodbus_t *)(void *)((uint8_t *)turns - offsetof(fathom_libmodbus_t, turns));
}

static fathom_transaction_t *next(fathom_line_turns_t *turns, const fathom_line_t *line)
{
    fathom_libmodbus_t *const port = port_of(turns);
    fathom_transaction_t *first = NULL;
    turns->wait_us = hold_left_us(port);
    if (turns->wait_us != 0) return NULL;
    turns->wait_us = line->quarantine_left_us;
    for (fathom_transaction_t *at = line->head; at != NULL; at = at->link.next) {
        if (fathom_line_is_quarantined(line, at->address)) continue;
        if (first == NULL) first = at;
        if (!is_silent(port, at->address)) return port->overtaken < MOST_OVERTAKEN ? at : first;
    }
    return first;
}

static void ignore(fathom_line_turns_t *turns, uint8_t address, uint32_t at_us)
{
    (void)turns, (void)address, (void)at_us;
}

static void ended(fathom_line_turns_t *turns, uint8_t address, uint32_t at_us)
{
    fathom_libmodbus_t *const port = port_of(turns);
    (void)address, (void)at_us;
    port->is_overdue = port->is_response_pending;
}

void fathom_libmodbus_hold(fathom_libmodbus_t *port, fathom_line_t *line)
{
    port->turns.next = next;
    port->turns.asked = ignore;
    port->turns.ended = ended;
    fathom_line_take_turns(line, &port->turns);
}
