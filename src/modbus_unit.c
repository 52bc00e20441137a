/* SPDX-License-Identifier: MIT */
#include "fathom/modbus_unit.h"

enum { IDLE = 0, ASKED = 1, ANSWERED = 2 };

/* After so many silences in a row a unit is left alone, and with each of the next the time is doubled. */
enum { PATIENCE = 3, DOUBLINGS = 4 };
#define LONGEST_US 0x80000000u

static uint16_t one_more(uint16_t n) { return n != UINT16_MAX ? (uint16_t)(n + 1) : n; }

static uint32_t now_us(const fathom_modbus_unit_t *unit) { return unit->clock->now_us(unit->clock->ctx); }

uint16_t fathom_modbus_unit_name(const fathom_modbus_question_t *question)
{
    uint16_t name = question->first;
    if (question->function != 0) name |= 0x8000u;
    if (question->is_command) name |= 0x4000u;
    return name;
}

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
    if (wait_us > unit->backoff_us) wait_us = unit->backoff_us;
    unit->alone_us = wait_us;
}

/* Lets time pass and the carrier work; returns how that is. */
static fathom_status_t advance(fathom_modbus_unit_t *unit)
{
    const fathom_exchange_t *const exchange = &unit->request.exchange;
    const fathom_status_t carrier = unit->modbus->poll(unit->modbus->ctx);
    const uint32_t now = now_us(unit);
    const uint32_t passed_us = fathom_elapsed_us(now, unit->polled_us);
    unit->polled_us = now;
    fathom_run_down(&unit->alone_us, passed_us);
    fathom_run_down(&unit->warm_us, passed_us);
    /* The pace counts from the last request on the wire, not from its place in a queue. */
    if (unit->state == ASKED && exchange->attempts != unit->attempts) {
        unit->attempts = exchange->attempts;
        unit->pause_us = unit->pace_us;
    } else if (unit->state != ASKED || unit->attempts != 0) {
        fathom_run_down(&unit->pause_us, passed_us);
    }
    if (unit->state != ASKED || exchange->status == FATHOM_PENDING) return carrier;
    unit->state = ANSWERED;
    unit->heard_us = exchange->link.heard_us;
    if (exchange->status == FATHOM_READY)
        unit->answers = one_more(unit->answers);
    else
        unit->failures = one_more(unit->failures);
    back_off(unit);
    return carrier;
}

static void describe(const fathom_modbus_unit_t *unit, const fathom_modbus_question_t *question,
                     fathom_modbus_message_t *message)
{
    fathom_modbus_read_holding_registers(message, unit->address, question->first, question->count,
                                         question->values);
    if (question->function == 0) return;
    message->head[1] = question->function;
    if (question->function != FATHOM_MODBUS_WRITE_SINGLE_REGISTER) return;
    message->values = NULL; /* what it pointed to may be gone before the request is */
    message->head[4] = (uint8_t)(*question->values >> 8);
    message->head[5] = (uint8_t)*question->values;
}

static fathom_status_t ask(fathom_modbus_unit_t *unit, const fathom_modbus_question_t *question)
{
    fathom_modbus_request_t *const request = &unit->request;
    if (unit->pause_us != 0 || (unit->alone_us != 0 && !question->is_command)) return FATHOM_PENDING;
    request->exchange.timeout_us = question->timeout_us;
    request->exchange.retries = question->retries;
    request->exchange.settings = unit->settings != NULL ? unit->settings : question->settings;
    describe(unit, question, &request->message);
    unit->waiting = 0;
    const fathom_status_t status = unit->modbus->submit(unit->modbus->ctx, request);
    if (status == FATHOM_PENDING) {
        unit->state = ASKED;
        unit->attempts = 0;
        unit->is_command = question->is_command;
        unit->asked = fathom_modbus_unit_name(question);
        if (unit->asked == unit->setting) unit->is_written = true;
        unit->pace_us = question->pace_us;
        unit->backoff_us = question->backoff_us != 0 ? question->backoff_us : LONGEST_US;
        unit->pause_us = question->pace_us;
    }
    return status;
}

fathom_status_t fathom_modbus_unit_init(fathom_modbus_unit_t *unit, const fathom_modbus_t *modbus,
                                        const fathom_clock_t *clock, uint8_t address)
{
    if (modbus == NULL || clock == NULL || address == FATHOM_MODBUS_ANY_UNIT) return FATHOM_ERR_ARGUMENT;
    unit->modbus = modbus;
    unit->clock = clock;
    unit->polled_us = now_us(unit);
    unit->pause_us = 0;
    unit->heard_us = unit->polled_us;
    unit->answers = 0;
    unit->failures = 0;
    unit->address = address;
    unit->state = IDLE;
    unit->attempts = 0;
    unit->is_command = false;
    unit->waiting = 0;
    unit->pace_us = 0;
    unit->backoff_us = 0;
    unit->alone_us = 0;
    unit->silences = 0;
    unit->warm_us = 0;
    unit->settings = NULL;
    unit->asked = 0;
    unit->setting = 0;
    unit->doubts = 0;
    unit->is_written = false;
    unit->is_blind = false;
    unit->request.message.exception = 0;
    return FATHOM_READY;
}

/* Does a setting have the unit to itself, and this question is none of its? */
static bool is_kept_out(const fathom_modbus_unit_t *unit)
{
    return unit->setting != 0 && (unit->step & FATHOM_MODBUS_UNIT_INSIDE) == 0;
}

/* Is it another question's turn first? A command waits for nothing but another command and for what is on its
 * way; the repeated question lets commands pass. */
static fathom_status_t turn(fathom_modbus_unit_t *unit, const fathom_modbus_question_t *question)
{
    const uint16_t name = fathom_modbus_unit_name(question);
    const bool is_waiting = unit->waiting != 0 && unit->waiting != name;
    const bool is_untaken = unit->state != IDLE && unit->is_command;
    /* While a setting is carried out the device may be elsewhere. */
    if (is_kept_out(unit)) return question->is_command ? FATHOM_ERR_BUSY : FATHOM_PENDING;
    if (!question->is_command) return is_waiting || is_untaken ? FATHOM_PENDING : FATHOM_READY;
    if (is_waiting || is_untaken) return FATHOM_ERR_BUSY;
    unit->waiting = name;
    return unit->state == ASKED ? FATHOM_PENDING : FATHOM_READY;
}

/* The present question has ended: how. */
static fathom_status_t outcome(const fathom_modbus_unit_t *unit)
{
    const fathom_status_t status = (fathom_status_t)unit->request.exchange.status;
    const bool is_warm = unit->warm_us == 0;
    if (is_warm ||
        (status != FATHOM_ERR_NO_ANSWER && status != FATHOM_ERR_CHECKSUM && status != FATHOM_ERR_EXCEPTION))
        return status;
    return FATHOM_ERR_WARMING_UP;
}

fathom_status_t fathom_modbus_unit_ask(fathom_modbus_unit_t *unit, const fathom_modbus_question_t *question)
{
    const fathom_status_t carrier = advance(unit);
    /* The same command asked by somebody else would take a setting's outcome away from it. */
    const bool is_anothers = question->is_command && is_kept_out(unit);
    if (unit->state != IDLE && unit->asked == fathom_modbus_unit_name(question) && !is_anothers) {
        if (unit->state == ASKED) return FATHOM_PENDING;
        unit->state = IDLE;
        return outcome(unit);
    }
    if (carrier < 0) { /* nothing could be asked; not to say so would let a caller wait */
        if (unit->waiting == fathom_modbus_unit_name(question)) unit->waiting = 0; /* that was its outcome */
        return carrier;
    }
    const fathom_status_t status = turn(unit, question);
    if (status != FATHOM_READY) return status;
    unit->state = IDLE; /* an outcome of the repeated question that nobody took gives way */
    return ask(unit, question);
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
    unit->polled_us = now_us(unit);
    unit->warm_us = warm_us;
    unit->pause_us = 0;
    unit->alone_us = 0;
    unit->silences = 0;
    unit->doubts = 0;
}

bool fathom_modbus_unit_is_warming_up(const fathom_modbus_unit_t *unit) { return unit->warm_us != 0; }

uint32_t fathom_modbus_unit_due_us(const fathom_modbus_unit_t *unit)
{
    if (unit->state == ASKED) { /* another unit's poll may have ended it already */
        const bool has_ended = unit->request.exchange.status != FATHOM_PENDING;
        return has_ended ? 0 : unit->modbus->due_us(unit->modbus->ctx);
    }
    const uint32_t passed_us = fathom_elapsed_us(now_us(unit), unit->polled_us);
    const bool is_alone = unit->waiting == 0 && unit->alone_us > unit->pause_us;
    const uint32_t left_us = is_alone ? unit->alone_us : unit->pause_us;
    return unit->state == IDLE && left_us > passed_us ? left_us - passed_us : 0;
}
