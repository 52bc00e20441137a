/* SPDX-License-Identifier: MIT */
#include "fathom/modbus_unit.h"

#include "common.h"

enum { IDLE = 0, ASKED = 1, ANSWERED = 2 };

/* After so many silences in a row a unit is left alone, and with each of the next the time is doubled. */
enum { PATIENCE = 3, DOUBLINGS = 4 };
#define LONGEST_US 0x80000000u

/* An outcome is there: for how long is the unit left alone? */
static void back_off(fathom_modbus_unit_t *unit)
{
    const fathom_exchange_t *const exchange = &unit->request.exchange;
    uint32_t wait_us = exchange->timeout_us;
    if (exchange->status != FATHOM_ERR_NO_ANSWER || unit->warm_us != 0) {
        unit->silences = 0;
        unit->alone_us = 0;
        return;
    }
    if (unit->silences != PATIENCE + DOUBLINGS) unit->silences++;
    if (unit->silences < PATIENCE) return;
    for (uint8_t n = unit->silences; n != PATIENCE && wait_us < unit->backoff_us; n--) wait_us += wait_us;
    unit->alone_us = least_us(wait_us, unit->backoff_us);
}

void fathom_modbus_unit_poll(fathom_modbus_unit_t *unit)
{
    const fathom_exchange_t *const exchange = &unit->request.exchange;
    unit->carrier = (int8_t)unit->modbus->poll(unit->modbus->ctx);
    const uint32_t now_us = clock_us(unit->modbus->clock);
    const uint32_t passed_us = fathom_elapsed_us(now_us, unit->polled_us);
    unit->polled_us = now_us;
    fathom_run_down(&unit->pause_us, passed_us);
    if ((unit->alone_us | unit->warm_us) != 0) { /* which is rare, and an AVR takes its time to subtract */
        fathom_run_down(&unit->alone_us, passed_us);
        fathom_run_down(&unit->warm_us, passed_us);
    }
    if (unit->state != ASKED) return;
    /* The pace counts from the last request on the wire, not from its place in a queue. */
    if (exchange->attempts == 0 || exchange->attempts != unit->attempts) unit->pause_us = unit->pace_us;
    unit->attempts = exchange->attempts;
    if (exchange->status == FATHOM_PENDING) return;
    unit->state = ANSWERED;
    count_one(exchange->status == FATHOM_READY ? &unit->answers : &unit->failures);
    back_off(unit);
}

static fathom_status_t submit(fathom_modbus_unit_t *unit, const fathom_modbus_question_t *question)
{
    fathom_modbus_request_t *const request = &unit->request;
    const bool is_once = (unit->step & FATHOM_MODBUS_UNIT_ONCE) != 0;
    request->exchange.settings = unit->settings;
    request->exchange.timeout_us =
        question->id < FATHOM_MODBUS_COMMAND ? unit->timeout_us : unit->command_timeout_us;
    request->exchange.retries = is_once ? 0 : unit->retries;
    request->message.values = question->values;
    request->message.exception = 0;
    request->message.head[0] = unit->address;
    request->message.head[1] = question->function;
    request->message.head[2] = (uint8_t)(question->first >> 8);
    request->message.head[3] = (uint8_t)question->first;
    request->message.head[4] = (uint8_t)(question->last >> 8);
    request->message.head[5] = (uint8_t)question->last;
    const fathom_status_t status = unit->modbus->submit(unit->modbus->ctx, request);
    unit->waiting = 0;
    if (status != FATHOM_PENDING) return status;
    unit->state = ASKED;
    unit->attempts = 0;
    unit->asked = question->id;
    unit->pause_us = unit->pace_us;
    if (is_once) unit->is_written = true;
    return status;
}

fathom_status_t fathom_modbus_unit_init(fathom_modbus_unit_t *unit, const fathom_modbus_config_t *config,
                                        uint32_t timeout_us, uint32_t pace_us)
{
    const fathom_modbus_t *const modbus = config->transport;
    const uint8_t address = config->address;
    if (modbus == NULL || modbus->clock == NULL || address == FATHOM_MODBUS_ANY_UNIT ||
        (config->address_zero && address != 0))
        return FATHOM_ERR_ARGUMENT;
    /* volatile: or compilers make it a call of memset, which costs more */
    for (volatile uint8_t *byte = (uint8_t *)unit; byte != (uint8_t *)(unit + 1); byte++) *byte = 0;
    unit->modbus = modbus;
    unit->settings = config->settings;
    unit->timeout_us = or_default(config->timeout_us, timeout_us);
    unit->command_timeout_us =
        or_default(config->command_timeout_us, FATHOM_MODBUS_DEFAULT_COMMAND_TIMEOUT_US);
    unit->pace_us = config->period_us > pace_us ? config->period_us : pace_us;
    unit->backoff_us = or_default(config->backoff_us, LONGEST_US);
    unit->retries = config->retries;
    unit->address = address != 0 || config->address_zero ? address : 1;
    unit->polled_us = clock_us(modbus->clock);
    return FATHOM_READY;
}

/* The present question has ended: how. */
static fathom_status_t outcome(const fathom_modbus_unit_t *unit)
{
    const fathom_status_t status = (fathom_status_t)unit->request.exchange.status;
    if (unit->warm_us == 0 ||
        (status != FATHOM_ERR_NO_ANSWER && status != FATHOM_ERR_CHECKSUM && status != FATHOM_ERR_EXCEPTION))
        return status;
    return FATHOM_ERR_WARMING_UP;
}

fathom_status_t fathom_modbus_unit_ask(fathom_modbus_unit_t *unit, const fathom_modbus_question_t *question)
{
    const uint8_t id = question->id;
    const bool is_command = id >= FATHOM_MODBUS_COMMAND;
    /* Does a setting have the unit to itself, and this question is none of its? */
    const bool is_kept_out = unit->setting != 0 && (unit->step & FATHOM_MODBUS_UNIT_INSIDE) == 0;
    /* The same command asked by another caller would take a setting's outcome away from it. */
    if (unit->state != IDLE && unit->asked == id && !(is_command && is_kept_out)) {
        if (unit->state == ASKED) return FATHOM_PENDING;
        unit->state = IDLE;
        return outcome(unit);
    }
    if (unit->carrier < 0) { /* nothing could be asked; not to say so would let a caller wait */
        if (unit->waiting == id) unit->waiting = 0; /* that was its outcome */
        return (fathom_status_t)unit->carrier;
    }
    /* A command waits for nothing but another command and for what is on its way; the repeated question lets commands
     * pass, and while a setting is carried out the device may be elsewhere. */
    if (is_kept_out || (unit->waiting != 0 && unit->waiting != id) ||
        (unit->state != IDLE && unit->asked >= FATHOM_MODBUS_COMMAND))
        return is_command ? FATHOM_ERR_BUSY : FATHOM_PENDING;
    if (is_command) unit->waiting = id;
    if (unit->state == ASKED) return FATHOM_PENDING;
    unit->state = IDLE; /* an outcome of the repeated question that was not taken gives way */
    if (unit->pause_us != 0 || (unit->alone_us != 0 && !is_command)) return FATHOM_PENDING;
    return submit(unit, question);
}

void fathom_modbus_unit_cancel(fathom_modbus_unit_t *unit)
{
    if (unit->state == ASKED) unit->modbus->cancel(unit->modbus->ctx, &unit->request);
    unit->state = IDLE;
    unit->waiting = 0;
    unit->is_blind = false;
    if (unit->setting == 0) return;
    unit->setting = 0;
    unit->address = unit->home_address;
    unit->settings = unit->home_settings;
}

void fathom_modbus_unit_power_on(fathom_modbus_unit_t *unit, uint32_t warm_us)
{
    fathom_modbus_unit_cancel(unit);
    unit->polled_us = clock_us(unit->modbus->clock);
    unit->warm_us = warm_us;
    unit->pause_us = 0;
    unit->alone_us = 0;
    unit->silences = 0;
    unit->doubts = 0;
}

uint32_t fathom_modbus_unit_due_us(const fathom_modbus_unit_t *unit)
{
    if (unit->state == ANSWERED) return 0;
    if (unit->state == ASKED) { /* another unit's poll may have ended it already */
        const bool has_ended = unit->request.exchange.status != FATHOM_PENDING;
        return has_ended ? 0 : unit->modbus->due_us(unit->modbus->ctx);
    }
    uint32_t left_us = unit->pause_us;
    if (unit->waiting == 0 && unit->alone_us > left_us) left_us = unit->alone_us;
    return rest_us(left_us, fathom_elapsed_us(clock_us(unit->modbus->clock), unit->polled_us));
}
