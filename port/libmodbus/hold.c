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

/* Returns the time for which the response to the newest request may still be pending, in microseconds. */
static uint32_t hold_left_us(fathom_libmodbus_t *port)
{
    if (!port->is_response_pending || port->never_responds_late) return 0;
    const uint32_t sent_us = port->sent_us[port->transaction % FATHOM_LIBMODBUS_DATED];
    const uint32_t passed_us = fathom_elapsed_us(fathom_libmodbus_now_us(port), sent_us);
    if (passed_us < port->hold_us) return port->hold_us - passed_us;
    port->is_response_pending = false;
    port->never_responds_late = true;
    return 0;
}

static fathom_transaction_t *next(fathom_line_turns_t *turns, const fathom_line_t *line)
{
    fathom_libmodbus_t *const port =
        (fathom_libmodbus_t *)(void *)((uint8_t *)turns - offsetof(fathom_libmodbus_t, turns));
    fathom_transaction_t *transaction = line->head;
    turns->wait_us = hold_left_us(port);
    if (turns->wait_us != 0) return NULL;
    while (transaction != NULL && fathom_line_is_quarantined(line, transaction->address))
        transaction = transaction->link.next;
    turns->wait_us = line->quarantine_left_us;
    return transaction;
}

static void ignore(fathom_line_turns_t *turns, uint8_t address, uint32_t at_us)
{
    (void)turns, (void)address, (void)at_us;
}

void fathom_libmodbus_hold(fathom_libmodbus_t *port, fathom_line_t *line)
{
    port->turns.next = next;
    port->turns.asked = ignore;
    port->turns.ended = ignore;
    fathom_line_take_turns(line, &port->turns);
}
