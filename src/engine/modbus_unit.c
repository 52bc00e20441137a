/* SPDX-License-Identifier: MIT */
#include "fathom/engine/modbus_unit.h"

#include "../common.h"

enum { IDLE = 0, ASKED = 1, ANSWERED = 2 };

/* Back-off begins after so many time-outs in a row, and is doubled so often by the next ones. */
enum { PATIENCE = 3, DOUBLINGS = 4 };
#define LONGEST_US 0x80000000u

/* An outcome is there: how long is the back-off? */
static void back_off(fathom_modbus_unit_t *unit)
{
    const fathom_transaction_t *const transaction = &unit->request.transaction;
    uint32_t wait_us = transaction->timeout_us;
    if ((transaction->status != FATHOM_ERR_NO_RESPONSE) || (unit->warm_us != 0u)) {
        unit->timeouts_in_row = 0;
        unit->backoff_left_us = 0;
        return;
    }
    if (unit->timeouts_in_row != (PATIENCE + DOUBLINGS)) unit->timeouts_in_row++;
    if (unit->timeouts_in_row < PATIENCE) return;
    for (uint8_t n = unit->timeouts_in_row; (n != PATIENCE) && (wait_us < unit->backoff_us); n--)
        wait_us += wait_us;
    unit->backoff_left_us = least_us(wait_us, unit->backoff_us);
}

void fathom_modbus_unit_poll(fathom_modbus_unit_t *unit)
{
    const fathom_transaction_t *const transaction = &unit->request.transaction;
    unit->transport_status = (int8_t)unit->transport->poll(unit->transport->ctx);
    const uint32_t now_us = clock_us(unit->transport->clock);
    const uint32_t passed_us = fathom_elapsed_us(now_us, unit->polled_us);
    unit->polled_us = now_us;
    (void)fathom_count_down(&unit->pause_us, passed_us);
    /* Which is rare, and an AVR takes its time to subtract. */
    if ((unit->backoff_left_us | unit->warm_us) != 0u) {
        (void)fathom_count_down(&unit->backoff_left_us, passed_us);
        (void)fathom_count_down(&unit->warm_us, passed_us);
    }
    if (unit->state != ASKED) return;
    /* The pace counts from the last request on the wire, not from its place in a queue. */
    if ((transaction->attempts == 0u) || (transaction->attempts != unit->attempts))
        unit->pause_us = unit->pace_us;
    unit->attempts = transaction->attempts;
    if (transaction->status == FATHOM_PENDING) return;
    unit->state = ANSWERED;
    count_one((transaction->status == FATHOM_READY) ? &unit->responses : &unit->failures);
    back_off(unit);
}

static fathom_status_t submit(fathom_modbus_unit_t *unit, const fathom_modbus_unit_request_t *request)
{
    fathom_modbus_request_t *const node = &unit->request;
    const bool is_once = (unit->step & FATHOM_MODBUS_UNIT_ONCE) != 0;
    node->transaction.line_settings = unit->line_settings;
    node->transaction.timeout_us =
        (request->id < FATHOM_MODBUS_COMMAND) ? unit->timeout_us : unit->command_timeout_us;
    node->transaction.retries = is_once ? 0u : unit->retries;
    node->message.values = request->values;
    node->message.exception = 0;
    node->message.head[0] = unit->address;
    node->message.head[1] = request->function;
    node->message.head[2] = (uint8_t)(request->first >> 8);
    node->message.head[3] = (uint8_t)request->first;
    node->message.head[4] = (uint8_t)(request->last >> 8);
    node->message.head[5] = (uint8_t)request->last;
    const fathom_status_t status = unit->transport->submit(unit->transport->ctx, node);
    unit->waiting = 0;
    if (status != FATHOM_PENDING) return status;
    unit->state = ASKED;
    unit->attempts = 0;
    unit->current = request->id;
    unit->pause_us = unit->pace_us;
    if (is_once) unit->is_written = true;
    return status;
}

fathom_status_t fathom_modbus_unit_init(fathom_modbus_unit_t *unit, const fathom_modbus_config_t *config,
                                        uint32_t timeout_us, uint32_t pace_us)
{
    const fathom_modbus_t *const transport = config->transport;
    const uint8_t address = config->address;
    if ((transport == NULL) || (transport->clock == NULL) || (address == FATHOM_MODBUS_ANY_UNIT) ||
        (config->address_zero && (address != 0u)))
        return FATHOM_ERR_ARGUMENT;
    /* volatile: or compilers make it a call of memset, which costs more */
    for (volatile uint8_t *byte = (uint8_t *)unit; byte != (uint8_t *)(unit + 1); byte++) *byte = 0;
    unit->transport = transport;
    unit->line_settings = config->line_settings;
    unit->timeout_us = or_default(config->timeout_us, timeout_us);
    unit->command_timeout_us =
        or_default(config->command_timeout_us, FATHOM_MODBUS_DEFAULT_COMMAND_TIMEOUT_US);
    unit->pace_us = (config->period_us > pace_us) ? config->period_us : pace_us;
    unit->backoff_us = or_default(config->backoff_us, LONGEST_US);
    unit->retries = config->retries;
    unit->address = ((address != 0u) || config->address_zero) ? address : 1u;
    unit->polled_us = clock_us(transport->clock);
    return FATHOM_READY;
}

/* The present request has ended: how. */
static fathom_status_t outcome(const fathom_modbus_unit_t *unit)
{
    const fathom_status_t status = (fathom_status_t)unit->request.transaction.status;
    if ((unit->warm_us == 0u) || ((status != FATHOM_ERR_NO_RESPONSE) && (status != FATHOM_ERR_CHECKSUM) &&
                                  (status != FATHOM_ERR_EXCEPTION)))
        return status;
    return FATHOM_ERR_WARMING_UP;
}

fathom_status_t fathom_modbus_unit_ask(fathom_modbus_unit_t *unit,
                                       const fathom_modbus_unit_request_t *request)
{
    const uint8_t id = request->id;
    const bool is_command = id >= FATHOM_MODBUS_COMMAND;
    /* Does a setting have the unit to itself, and this request is not its own? */
    const bool is_kept_out = (unit->setting != 0u) && ((unit->step & FATHOM_MODBUS_UNIT_IN_SETTING) == 0);
    /* The same command of another caller would take a setting's outcome away from it. */
    const bool is_anothers = is_command && is_kept_out;
    if ((unit->state != IDLE) && (unit->current == id) && !is_anothers) {
        if (unit->state == ASKED) return FATHOM_PENDING;
        unit->state = IDLE;
        return outcome(unit);
    }
    if (unit->transport_status < 0) { /* nothing can be sent; with FATHOM_PENDING a caller would wait */
        if (unit->waiting == id) unit->waiting = 0; /* that was its outcome */
        return (fathom_status_t)unit->transport_status;
    }
    /* A command waits only for another command and for the request on the wire; the repeated request lets commands
     * pass, and while a setting is carried out the device may be elsewhere. */
    if (is_kept_out || ((unit->waiting != 0u) && (unit->waiting != id)) ||
        ((unit->state != IDLE) && (unit->current >= FATHOM_MODBUS_COMMAND)))
        return is_command ? FATHOM_ERR_BUSY : FATHOM_PENDING;
    if (is_command) unit->waiting = id;
    if (unit->state == ASKED) return FATHOM_PENDING;
    unit->state = IDLE; /* an outcome of the repeated request that was not taken gives way */
    if ((unit->pause_us != 0u) || ((unit->backoff_left_us != 0u) && !is_command)) return FATHOM_PENDING;
    return submit(unit, request);
}

void fathom_modbus_unit_cancel(fathom_modbus_unit_t *unit)
{
    if (unit->state == ASKED) unit->transport->cancel(unit->transport->ctx, &unit->request);
    unit->state = IDLE;
    unit->waiting = 0;
    unit->is_blind = false;
    if (unit->setting == 0u) return;
    unit->setting = 0;
    unit->address = unit->known_address;
    unit->line_settings = unit->known_line_settings;
}

void fathom_modbus_unit_power_on(fathom_modbus_unit_t *unit, uint32_t warm_us)
{
    fathom_modbus_unit_cancel(unit);
    unit->polled_us = clock_us(unit->transport->clock);
    unit->warm_us = warm_us;
    unit->pause_us = 0;
    unit->backoff_left_us = 0;
    unit->timeouts_in_row = 0;
    unit->unconfirmed = 0;
}

uint32_t fathom_modbus_unit_due_us(const fathom_modbus_unit_t *unit)
{
    if (unit->state == ANSWERED) return 0;
    if (unit->state == ASKED) { /* another unit's poll may have ended it already */
        const bool has_ended = unit->request.transaction.status != FATHOM_PENDING;
        return has_ended ? 0u : unit->transport->due_us(unit->transport->ctx);
    }
    uint32_t left_us = unit->pause_us;
    if ((unit->waiting == 0u) && (unit->backoff_left_us > left_us)) left_us = unit->backoff_left_us;
    return rest_us(left_us, fathom_elapsed_us(clock_us(unit->transport->clock), unit->polled_us));
}
