/* SPDX-License-Identifier: MIT */
#include "fathom/engine/internal/modbus_command.h"

#include "modbus_unit_internal.h"

/*
 * Requests to a Modbus unit that are sent once, beside its measurement. At most one command or setting is in progress;
 * it keeps the measurement and all others out, until its caller has the result or has abandoned it.
 */

/* The longest and the shortest sleep of a program whose command may be abandoned soon. */
#define ABANDONED_STEP_US (FATHOM_MODBUS_ABANDONED_US / FATHOM_MODBUS_ABANDONED_POLLS)
#define NAP_US            1000u

/* ---- An abandoned command ---- */

/*
 * A command that its caller has abandoned would keep the measurement and all other commands out without end.
 *
 *     details()     |pending
 *     fathom_poll()   | |pending ...                                |ready
 *     kept_us       |<- FATHOM_MODBUS_ABANDONED_US, 16 calls ------>| cancelled
 *
 * The calls count as well as the time: a loop whose turns are longer than the whole time still completes its commands,
 * because it calls for them in each turn.
 */
void fathom_modbus_command_keep(fathom_modbus_unit_t *unit)
{
    unit->commands = &fathom_modbus_commands;
    unit->kept_us = unit->polled_us;
    unit->calls_left = FATHOM_MODBUS_ABANDONED_POLLS;
}

/* A setting has the unit to itself, and the present call is not one of its own. */
static bool is_kept_out(const fathom_modbus_unit_t *unit)
{
    return (unit->setting != 0u) && !unit->is_in_setting;
}

static bool is_in_progress(const fathom_modbus_unit_t *unit) { return (unit->setting | unit->command) != 0u; }

static void drop_setting(fathom_modbus_unit_t *unit)
{
    if (unit->setting == 0u) return;
    unit->setting = 0;
    unit->is_blind = false;
    unit->address = unit->known_address;
    unit->line_settings = unit->known_line_settings;
}

static uint32_t kept_for_us(const fathom_modbus_unit_t *unit)
{
    return fathom_elapsed_us(unit->polled_us, unit->kept_us);
}

bool fathom_modbus_command_give_way(fathom_modbus_unit_t *unit)
{
    if (unit->calls_left != 0u) unit->calls_left--;
    if ((unit->calls_left != 0u) || (kept_for_us(unit) < FATHOM_MODBUS_ABANDONED_US)) return false;
    fathom_modbus_unit_drop_request(unit);
    unit->command = 0;
    if (is_kept_out(unit)) drop_setting(unit);
    return true;
}

/* ---- What the measurement needs ---- */

static bool is_occupied(fathom_modbus_unit_t *unit)
{
    return is_in_progress(unit) && !fathom_modbus_command_give_way(unit);
}

/* If the caller of the command has not called for a while, polling at once would only keep the processor busy. */
static uint32_t due_us(const fathom_modbus_unit_t *unit, uint32_t us)
{
    if (!is_in_progress(unit) || (kept_for_us(unit) <= (FATHOM_MODBUS_ABANDONED_US / 2u))) return us;
    return least_us((us > NAP_US) ? us : (uint32_t)NAP_US, ABANDONED_STEP_US);
}

static void forget(fathom_modbus_unit_t *unit)
{
    unit->command = 0;
    drop_setting(unit);
    unit->is_blind = false;
}

const fathom_modbus_commands_t fathom_modbus_commands = {is_occupied, forget, due_us};

/* ---- Commands ---- */

static fathom_status_t submit(fathom_modbus_unit_t *unit, const fathom_modbus_unit_request_t *command)
{
    fathom_modbus_message_t *const message = &unit->request.message;
    fathom_transaction_t *const transaction = &unit->request.transaction;
    /* The write of a setting is sent once: no retry. The reads of a setting have other ids. */
    const bool is_once = unit->is_in_setting && (command->id == unit->setting);
    message->head[0] = unit->address;
    message->head[1] = command->function;
    message->head[2] = (uint8_t)(command->first >> 8);
    message->head[3] = (uint8_t)command->first;
    message->head[4] = (uint8_t)(command->last >> 8);
    message->head[5] = (uint8_t)command->last;
    message->values = command->values;
    message->exception = 0;
    message->has_effect = is_once;
    transaction->timeout_us = unit->command_timeout_us;
    transaction->retries = is_once ? 0u : unit->retries;
    const fathom_status_t status = fathom_modbus_unit_submit(unit, command->id);
    if (is_once && (status == FATHOM_PENDING)) unit->is_written = true;
    return status;
}

/* A command waits for another command. While a setting is in progress the device may be elsewhere. */
static bool is_blocked(const fathom_modbus_unit_t *unit, uint8_t id)
{
    return is_kept_out(unit) || ((unit->command != 0u) && (unit->command != id));
}

/* Sends the command, unless the measurement is on the wire or the pace has not passed. A measurement whose result was not
 * fetched gives way. */
static fathom_status_t begin(fathom_modbus_unit_t *unit, const fathom_modbus_unit_request_t *command)
{
    unit->command = command->id;
    if (unit->state == FATHOM_MODBUS_UNIT_QUEUED) return FATHOM_PENDING;
    unit->state = FATHOM_MODBUS_UNIT_IDLE;
    return (unit->pause_us != 0u) ? FATHOM_PENDING : submit(unit, command);
}

fathom_status_t fathom_modbus_command(fathom_modbus_unit_t *unit, const fathom_modbus_unit_request_t *command)
{
    const uint8_t id = command->id;
    const bool has_request = (unit->state != FATHOM_MODBUS_UNIT_IDLE) && (unit->current == id);
    fathom_status_t status;
    if (has_request &&
        !is_kept_out(unit)) /* Else another caller would take the result away from the setting. */
        status = fathom_modbus_unit_result(unit);
    else if (unit->transport_status < 0) /* Nothing can be sent; with FATHOM_PENDING a caller would wait. */
        status = (fathom_status_t)unit->transport_status;
    else if (is_blocked(unit, id) && !fathom_modbus_command_give_way(unit))
        return FATHOM_ERR_BUSY;
    else
        status = begin(unit, command);
    if (status == FATHOM_PENDING)
        fathom_modbus_command_keep(unit);
    else if (unit->command == id)
        unit->command = 0;
    return status;
}
