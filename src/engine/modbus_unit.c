/* SPDX-License-Identifier: MIT */
#include "fathom/engine/internal/modbus_unit.h"

#include "../common.h"

enum { IDLE = 0, ASKED = 1, ANSWERED = 2 };

/* Back-off begins after PATIENCE time-outs in a row. Each of the next DOUBLINGS time-outs doubles the pause. */
enum { PATIENCE = 3, DOUBLINGS = 4 };

enum { POLLS_TO_SEARCH = 16 };

/* The line never was silent, or another master asked the same unit: that proves nothing about the unit. */
static bool is_of_unit(fathom_status_t status)
{
    return (status != FATHOM_ERR_LINE_BUSY) && (status != FATHOM_ERR_OTHER_MASTER);
}

/* Computes the pause that follows the result of a request. */
static void back_off(fathom_modbus_unit_t *unit)
{
    const fathom_transaction_t *const transaction = &unit->request.transaction;
    uint32_t wait_us = transaction->timeout_us;
    if (is_of_unit((fathom_status_t)transaction->status)) {
        if ((transaction->status != FATHOM_ERR_NO_RESPONSE) || (unit->warm_us != 0u)) {
            unit->timeouts_in_row = 0;
            unit->backoff_left_us = 0;
            return;
        }
        if (unit->timeouts_in_row != (PATIENCE + DOUBLINGS)) unit->timeouts_in_row++;
    }
    if (unit->timeouts_in_row < PATIENCE) return;
    for (uint8_t n = unit->timeouts_in_row; (n != PATIENCE) && (wait_us < unit->backoff_us); n--)
        wait_us += wait_us;
    unit->backoff_left_us = least_us(wait_us, unit->backoff_us);
}

/* ---- An abandoned command ---- */

/*
 * A command that its caller has abandoned would keep the measurement and all other commands out without end.
 *
 *     details()   |pending
 *     fathom_poll()   | |pending ...                                |ready
 *     abandoned_in_us |<- FATHOM_MODBUS_ABANDONED_US, 16 polls ---->| cancelled
 *
 * Each poll takes the time since the previous one off `abandoned_in_us`, but at most a sixteenth of the whole: a loop
 * whose turns are longer than the whole time still completes its commands, because it calls for them in each turn.
 */
static bool is_occupied(const fathom_modbus_unit_t *unit)
{
    return (unit->setting != 0u) || (unit->waiting != 0u) ||
           ((unit->state != IDLE) && (unit->current >= FATHOM_MODBUS_COMMAND));
}

#define ABANDONED_STEP_US (FATHOM_MODBUS_ABANDONED_US / FATHOM_MODBUS_ABANDONED_POLLS)
#define NAP_US            1000u

static void drop_request(fathom_modbus_unit_t *unit)
{
    if (unit->state == ASKED) unit->transport->cancel(unit->transport->ctx, &unit->request);
    unit->state = IDLE;
    unit->waiting = 0;
}

static void drop_setting(fathom_modbus_unit_t *unit)
{
    if (unit->setting == 0u) return;
    unit->setting = 0;
    unit->is_blind = false;
    unit->address = unit->known_address;
    unit->line_settings = unit->known_line_settings;
}

/* A setting has the unit to itself, and the present call is not one of its own. */
static bool is_kept_out(const fathom_modbus_unit_t *unit)
{
    return (unit->setting != 0u) && !unit->is_in_setting;
}

bool fathom_modbus_unit_give_way(fathom_modbus_unit_t *unit)
{
    if (unit->abandoned_in_us != 0u) return false;
    drop_request(unit);
    if (is_kept_out(unit)) drop_setting(unit);
    return true;
}

/* ---- Polling ---- */

/*
 * If the transport was initialised again while it had the request, the request never ends. With many units on one line a
 * search of the queue takes long, so only every POLLS_TO_SEARCH-th poll of a request does it.
 */
static void end_forgotten(fathom_modbus_unit_t *unit)
{
    const fathom_modbus_t *const transport = unit->transport;
    fathom_transaction_t *const transaction = &unit->request.transaction;
    unit->polls++;
    if ((unit->polls == POLLS_TO_SEARCH) && (transaction->status == FATHOM_PENDING)) {
        unit->polls = 0;
        if ((transport->has != NULL) && !transport->has(transport->ctx, &unit->request))
            transaction->status = FATHOM_ERR_CANCELLED;
    }
}

void fathom_modbus_unit_poll(fathom_modbus_unit_t *unit)
{
    const fathom_transaction_t *const transaction = &unit->request.transaction;
    FATHOM_ASSERT(unit->transport != NULL); /* the driver is not initialised */
    unit->transport_status = FATHOM_ERR_ARGUMENT;
    if (unit->transport == NULL) return;
    unit->transport_status = (int8_t)unit->transport->poll(unit->transport->ctx, unit->polled_us);
    const uint32_t now_us = clock_us(unit->transport->clock);
    const uint32_t passed_us = fathom_elapsed_us(now_us, unit->polled_us);
    unit->polled_us = now_us;
    (void)fathom_count_down(&unit->pause_us, passed_us);
    /* These are rare, and an AVR needs its time to subtract. */
    if ((unit->backoff_left_us | unit->warm_us) != 0u) {
        (void)fathom_count_down(&unit->backoff_left_us, passed_us);
        (void)fathom_count_down(&unit->warm_us, passed_us);
    }
    if (is_occupied(unit))
        (void)fathom_count_down(&unit->abandoned_in_us, least_us(passed_us, ABANDONED_STEP_US));
    if (unit->state != ASKED) return;
    end_forgotten(unit);
    /* The pace counts from the last request on the wire, not from its place in a queue. */
    if ((transaction->attempts == 0u) || (transaction->attempts != unit->attempts))
        unit->pause_us = unit->pace_us;
    unit->attempts = transaction->attempts;
    if (transaction->status == FATHOM_PENDING) return;
    unit->state = ANSWERED;
    count_one((transaction->status == FATHOM_OK) ? &unit->responses : &unit->failures);
    back_off(unit);
}

static fathom_status_t submit(fathom_modbus_unit_t *unit, const fathom_modbus_unit_request_t *request)
{
    fathom_modbus_request_t *const node = &unit->request;
    /* The write of a setting is sent once: no retry. The reads of a setting have other ids. */
    const bool is_once = unit->is_in_setting && (request->id == unit->setting);
    node->transaction.line_settings = unit->line_settings;
    node->transaction.timeout_us =
        (request->id < FATHOM_MODBUS_COMMAND) ? unit->timeout_us : unit->command_timeout_us;
    node->transaction.retries = is_once ? 0u : unit->retries;
    node->message.values = request->values;
    node->message.exception = 0;
    node->message.has_effect = is_once;
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
    unit->polls = 0;
    unit->current = request->id;
    unit->pause_us = unit->pace_us;
    if (is_once) unit->is_written = true;
    return status;
}

/* ---- Initialisation ---- */

bool fathom_modbus_unit_is_queued(const fathom_modbus_unit_t *unit, const fathom_modbus_config_t *config)
{
    const fathom_modbus_t *const transport = config->transport;
    const bool is_queued = (transport != NULL) && (transport->clock != NULL) && (transport->has != NULL) &&
                           transport->has(transport->ctx, &unit->request);
    FATHOM_ASSERT(!is_queued); /* the driver was not deinitialised */
    return is_queued;
}

static bool is_valid(const fathom_modbus_config_t *config)
{
    enum { MAX_RETRIES = 254 };
    return (config->transport != NULL) && (config->transport->clock != NULL) &&
           (config->address != FATHOM_MODBUS_ANY_UNIT) &&
           (!config->address_zero || (config->address == 0u)) && (config->retries <= MAX_RETRIES) &&
           ((config->period_us | config->timeout_us | config->command_timeout_us | config->backoff_us) <=
            FATHOM_MAX_DURATION_US);
}

fathom_status_t fathom_modbus_unit_init(fathom_modbus_unit_t *unit, const fathom_modbus_config_t *config,
                                        uint32_t timeout_us, uint32_t pace_us)
{
    const uint8_t address = config->address;
    if (fathom_modbus_unit_is_queued(unit, config)) return FATHOM_ERR_BUSY;
    clear(unit, sizeof *unit);
    if (!is_valid(config)) return FATHOM_ERR_ARGUMENT;
    unit->transport = config->transport;
    unit->line_settings = config->line_settings;
    unit->timeout_us = or_default(config->timeout_us, timeout_us);
    unit->command_timeout_us =
        or_default(config->command_timeout_us, FATHOM_MODBUS_DEFAULT_COMMAND_TIMEOUT_US);
    unit->pace_us = (config->period_us > pace_us) ? config->period_us : pace_us;
    unit->backoff_us = or_default(config->backoff_us, FATHOM_MAX_DURATION_US);
    unit->retries = config->retries;
    unit->address = ((address != 0u) || config->address_zero) ? address : 1u;
    unit->polled_us = clock_us(config->transport->clock);
    return FATHOM_OK;
}

/* ---- Requests ---- */

/* Returns how the present request has ended. */
static fathom_status_t outcome(const fathom_modbus_unit_t *unit)
{
    const fathom_status_t status = (fathom_status_t)unit->request.transaction.status;
    if ((unit->warm_us == 0u) || ((status != FATHOM_ERR_NO_RESPONSE) && (status != FATHOM_ERR_CHECKSUM) &&
                                  (status != FATHOM_ERR_EXCEPTION)))
        return status;
    return FATHOM_ERR_WARMING_UP;
}

/* A command waits only for another command and for the request on the wire. The repeated request lets commands pass,
 * and while a setting is in progress the device may be elsewhere. */
static bool is_blocked(const fathom_modbus_unit_t *unit, uint8_t id)
{
    return is_kept_out(unit) || ((unit->waiting != 0u) && (unit->waiting != id)) ||
           ((unit->state != IDLE) && (unit->current >= FATHOM_MODBUS_COMMAND));
}

fathom_status_t fathom_modbus_unit_ask(fathom_modbus_unit_t *unit,
                                       const fathom_modbus_unit_request_t *request)
{
    const uint8_t id = request->id;
    const bool is_command = id >= FATHOM_MODBUS_COMMAND;
    /* If another caller has the same command, it would take the result away from the setting. */
    const bool is_of_setting = is_command && is_kept_out(unit);
    if ((unit->state != IDLE) && (unit->current == id) && !is_of_setting) {
        if (unit->state == ASKED) {
            if (is_command) fathom_modbus_unit_keep(unit);
            return FATHOM_PENDING;
        }
        unit->state = IDLE;
        return outcome(unit);
    }
    if (unit->transport_status < 0) { /* Nothing can be sent; with FATHOM_PENDING a caller would wait. */
        if (unit->waiting == id) unit->waiting = 0; /* This error is its result. */
        return (fathom_status_t)unit->transport_status;
    }
    if (is_blocked(unit, id) && !fathom_modbus_unit_give_way(unit))
        return is_command ? FATHOM_ERR_BUSY : FATHOM_PENDING;
    if (is_command) {
        unit->waiting = id;
        fathom_modbus_unit_keep(unit);
    }
    if (unit->state == ASKED) return FATHOM_PENDING;
    unit->state = IDLE; /* A result of the repeated request that was not fetched gives way. */
    if ((unit->pause_us != 0u) || ((unit->backoff_left_us != 0u) && !is_command)) return FATHOM_PENDING;
    return submit(unit, request);
}

void fathom_modbus_unit_cancel(fathom_modbus_unit_t *unit)
{
    drop_request(unit);
    drop_setting(unit);
    unit->is_blind = false;
}

void fathom_modbus_unit_power_on(fathom_modbus_unit_t *unit, uint32_t warm_us)
{
    if (unit->transport == NULL) return;
    fathom_modbus_unit_cancel(unit);
    unit->polled_us = clock_us(unit->transport->clock);
    unit->warm_us = warm_us;
    unit->pause_us = 0;
    unit->backoff_left_us = 0;
    unit->timeouts_in_row = 0;
    unit->unconfirmed = 0;
}

/* The time until poll has something to do, without regard to abandoned commands. */
static uint32_t own_due_us(const fathom_modbus_unit_t *unit)
{
    if (unit->state == ANSWERED) return 0;
    if (unit->state == ASKED) { /* Another unit's poll may have ended it already. */
        const bool has_ended = unit->request.transaction.status != FATHOM_PENDING;
        return has_ended ? 0u : unit->transport->due_us(unit->transport->ctx);
    }
    uint32_t left_us = unit->pause_us;
    if ((unit->waiting == 0u) && (unit->backoff_left_us > left_us)) left_us = unit->backoff_left_us;
    return rest_us(left_us, fathom_elapsed_us(clock_us(unit->transport->clock), unit->polled_us));
}

uint32_t fathom_modbus_unit_due_us(const fathom_modbus_unit_t *unit)
{
    if (unit->transport == NULL) return 0; /* Each poll returns its error. */
    const uint32_t due_us = own_due_us(unit);
    /* If the caller of the command has not called for a while, polling at once would only keep the processor busy. */
    if (is_occupied(unit) && (unit->abandoned_in_us < (FATHOM_MODBUS_ABANDONED_US / 2u)))
        return least_us((due_us > NAP_US) ? due_us : (uint32_t)NAP_US, ABANDONED_STEP_US);
    return due_us;
}
