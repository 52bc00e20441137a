/* SPDX-License-Identifier: MIT */
#include "fathom/engine/internal/modbus_unit.h"

#include "modbus_unit_internal.h"

/*
 * One Modbus unit that is measured again and again: its pace, its back-off, its start-up time, and how each request ends.
 * Commands and settings stand in modbus_command.c and modbus_setting.c; a program that only measures links neither.
 */

/* Back-off begins after PATIENCE time-outs in a row. Each of the next DOUBLINGS time-outs doubles the pause. */
enum { PATIENCE = 3, DOUBLINGS = 4 };

/* ---- Initialisation ---- */

/* Returns the line of a transport, or NULL if there is no transport or its line is not initialised. */
static fathom_line_t *line_of(const fathom_modbus_t *transport)
{
    if ((transport == NULL) || (transport->line == NULL) || (transport->line->parts == NULL)) return NULL;
    return transport->line;
}

fathom_status_t fathom_modbus_unit_begin(fathom_modbus_unit_t *unit, const fathom_modbus_t *transport,
                                         void *driver, size_t size)
{
    const fathom_line_t *const line = line_of(transport);
    const bool is_queued = (line != NULL) && fathom_line_is_queued(line, &unit->request.transaction);
    FATHOM_ASSERT(!is_queued); /* the driver was not deinitialised */
    if (is_queued) return FATHOM_ERR_BUSY;
    clear(driver, size);
    return (line != NULL) ? FATHOM_OK : FATHOM_ERR_ARGUMENT;
}

static bool is_valid(const fathom_modbus_config_t *config)
{
    enum { MAX_RETRIES = 254 };
    return (config->address != FATHOM_MODBUS_ANY_UNIT) &&
           (!config->address_zero || (config->address == 0u)) && (config->retries <= MAX_RETRIES) &&
           ((config->period_us | config->timeout_us | config->command_timeout_us | config->backoff_us) <=
            FATHOM_MAX_DURATION_US);
}

fathom_status_t fathom_modbus_unit_init(fathom_modbus_unit_t *unit, const fathom_modbus_t *transport,
                                        const fathom_modbus_config_t *config, uint32_t timeout_us,
                                        uint32_t pace_us)
{
    if (!is_valid(config)) return FATHOM_ERR_ARGUMENT;
    unit->transport = *transport;
    unit->line_settings = config->line_settings;
    unit->timeout_us = or_default(config->timeout_us, timeout_us);
    unit->command_timeout_us =
        or_default(config->command_timeout_us, FATHOM_MODBUS_DEFAULT_COMMAND_TIMEOUT_US);
    unit->pace_us = (config->period_us > pace_us) ? config->period_us : pace_us;
    unit->backoff_us = or_default(config->backoff_us, FATHOM_MAX_DURATION_US);
    unit->retries = config->retries;
    unit->address = ((config->address != 0u) || config->address_zero) ? config->address : 1u;
    return FATHOM_OK; /* No deadline runs, so the first poll may find any time in `polled_us`. */
}

/* ---- Polling ---- */

/* Computes the pause that follows the result of a request. */
static void back_off(fathom_modbus_unit_t *unit, int8_t status)
{
    uint32_t wait_us = unit->request.transaction.timeout_us;
    /* The line never was silent, or another master asked the same unit: that proves nothing about the unit. */
    if ((status != FATHOM_ERR_LINE_BUSY) && (status != FATHOM_ERR_OTHER_MASTER)) {
        if ((status != FATHOM_ERR_NO_RESPONSE) || (unit->warm_us != 0u)) {
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

/*
 * If the line was initialised again while it had the request, the request never ends. With many units on one line a
 * search of the queue takes long, so it takes place when the upper 16 bits of the clock change, every 65.5 ms.
 */
static bool is_forgotten(const fathom_modbus_unit_t *unit, uint32_t now_us)
{
    if ((now_us >> 16) == (unit->polled_us >> 16)) return false;
    return !fathom_line_is_queued(unit->transport.line, &unit->request.transaction);
}

/* Follows the request. */
static void follow_request(fathom_modbus_unit_t *unit, uint32_t now_us)
{
    fathom_transaction_t *const transaction = &unit->request.transaction;
    if ((transaction->status == FATHOM_PENDING) && is_forgotten(unit, now_us))
        transaction->status = FATHOM_ERR_CANCELLED;
    /* The pace counts from the last request on the wire, not from its place in a queue. */
    if ((transaction->attempts == 0u) || (transaction->attempts != unit->attempts))
        unit->pause_us = unit->pace_us;
    unit->attempts = transaction->attempts;
    const int8_t status = transaction->status;
    if (status == FATHOM_PENDING) return;
    unit->state = FATHOM_MODBUS_UNIT_ENDED;
    count_one((status == FATHOM_OK) ? &unit->responses : &unit->failures);
    back_off(unit, status);
}

void fathom_modbus_unit_poll(fathom_modbus_unit_t *unit)
{
    fathom_line_t *const line = line_of(&unit->transport);
    FATHOM_ASSERT(line != NULL); /* the driver or its line is not initialised */
    unit->transport_status = FATHOM_ERR_ARGUMENT;
    if (line == NULL) { /* A line whose next init has failed has forgotten the request. */
        unit->state = FATHOM_MODBUS_UNIT_IDLE;
        return;
    }
    unit->transport_status = FATHOM_PENDING;
    if (!fathom_line_was_polled(line, unit->polled_us)) /* by another driver in this round */
        unit->transport_status = (int8_t)fathom_line_poll(line);
    const uint32_t now_us = clock_us(line->parts->clock);
    const uint32_t passed_us = fathom_elapsed_us(now_us, unit->polled_us);
    (void)fathom_count_down(&unit->pause_us, passed_us);
    /* These are rare, and an AVR needs its time to subtract. */
    if ((unit->backoff_left_us | unit->warm_us) != 0u) {
        (void)fathom_count_down(&unit->backoff_left_us, passed_us);
        (void)fathom_count_down(&unit->warm_us, passed_us);
    }
    if (unit->state == FATHOM_MODBUS_UNIT_QUEUED) follow_request(unit, now_us);
    unit->polled_us = now_us;
}

/* ---- Requests ---- */

fathom_status_t fathom_modbus_unit_submit(fathom_modbus_unit_t *unit, uint8_t id)
{
    unit->current = id;
    unit->request.transaction.line_settings = unit->line_settings;
    const fathom_status_t status = unit->transport.submit(unit->transport.line, &unit->request);
    if (status == FATHOM_PENDING) {
        unit->state = FATHOM_MODBUS_UNIT_QUEUED;
        unit->attempts = 0;
        unit->pause_us = unit->pace_us;
    }
    return status;
}

fathom_status_t fathom_modbus_unit_result(fathom_modbus_unit_t *unit)
{
    const fathom_status_t status = (fathom_status_t)unit->request.transaction.status;
    if (unit->state == FATHOM_MODBUS_UNIT_QUEUED) return FATHOM_PENDING;
    unit->state = FATHOM_MODBUS_UNIT_IDLE;
    if ((unit->warm_us == 0u) || ((status != FATHOM_ERR_NO_RESPONSE) && (status != FATHOM_ERR_CHECKSUM) &&
                                  (status != FATHOM_ERR_EXCEPTION)))
        return status;
    return FATHOM_ERR_WARMING_UP;
}

fathom_status_t fathom_modbus_unit_measure(fathom_modbus_unit_t *unit, uint16_t first, uint8_t count,
                                           uint16_t *values)
{
    fathom_modbus_request_t *const request = &unit->request;
    if ((unit->state != FATHOM_MODBUS_UNIT_IDLE) && (unit->current == FATHOM_MODBUS_UNIT_MEASUREMENT))
        return fathom_modbus_unit_result(unit);
    /* Nothing can be sent; with FATHOM_PENDING a caller would wait. */
    if (unit->transport_status < 0) return (fathom_status_t)unit->transport_status;
    if ((unit->commands != NULL) && unit->commands->is_occupied(unit)) return FATHOM_PENDING;
    if ((unit->pause_us | unit->backoff_left_us) != 0u) return FATHOM_PENDING;
    fathom_modbus_read_holding_registers(&request->message, unit->address, first, count, values);
    request->transaction.timeout_us = unit->timeout_us;
    request->transaction.retries = unit->retries;
    return fathom_modbus_unit_submit(unit, FATHOM_MODBUS_UNIT_MEASUREMENT);
}

void fathom_modbus_unit_drop_request(fathom_modbus_unit_t *unit)
{
    if (unit->state == FATHOM_MODBUS_UNIT_QUEUED)
        fathom_line_cancel(unit->transport.line, &unit->request.transaction);
    unit->state = FATHOM_MODBUS_UNIT_IDLE;
}

void fathom_modbus_unit_cancel(fathom_modbus_unit_t *unit)
{
    fathom_modbus_unit_drop_request(unit);
    if (unit->commands != NULL) unit->commands->forget(unit);
}

void fathom_modbus_unit_power_on(fathom_modbus_unit_t *unit, uint32_t warm_us)
{
    const fathom_line_t *const line = line_of(&unit->transport);
    if (line == NULL) return;
    fathom_modbus_unit_cancel(unit);
    unit->polled_us = clock_us(line->parts->clock);
    unit->warm_us = warm_us;
    unit->pause_us = 0;
    unit->backoff_left_us = 0;
    unit->timeouts_in_row = 0;
    unit->unconfirmed = 0;
}

/* ---- The next deadline ---- */

/* Returns the time until a request may be sent. */
static uint32_t idle_due_us(const fathom_modbus_unit_t *unit, const fathom_line_t *line)
{
    uint32_t left_us = unit->pause_us;
    if ((unit->command == 0u) && (unit->backoff_left_us > left_us)) left_us = unit->backoff_left_us;
    return rest_us(left_us, fathom_elapsed_us(clock_us(line->parts->clock), unit->polled_us));
}

uint32_t fathom_modbus_unit_due_us(const fathom_modbus_unit_t *unit)
{
    const fathom_line_t *const line = line_of(&unit->transport);
    uint32_t due_us =
        0; /* not initialised: each poll returns its error; ended: the result is to be fetched */
    if (line == NULL) return due_us;
    if (unit->state == FATHOM_MODBUS_UNIT_IDLE)
        due_us = idle_due_us(unit, line);
    else if (unit->request.transaction.status == FATHOM_PENDING) /* Else the request has ended. */
        due_us = fathom_line_due_us(line);
    return (unit->commands != NULL) ? unit->commands->due_us(unit, due_us) : due_us;
}
