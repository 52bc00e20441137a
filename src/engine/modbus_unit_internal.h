/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_MODBUS_UNIT_INTERNAL_H
#define FATHOM_MODBUS_UNIT_INTERNAL_H

#include "../common.h"
#include "fathom/engine/internal/modbus_unit.h"

/* What modbus_unit.c, modbus_command.c and modbus_setting.c share. Programs do not include this file. */

/* fathom_modbus_unit_t::state */
enum {
    FATHOM_MODBUS_UNIT_IDLE = 0,   /* There is no request. */
    FATHOM_MODBUS_UNIT_QUEUED = 1, /* The line has the request. */
    FATHOM_MODBUS_UNIT_ENDED = 2   /* The request has ended, and its caller has not fetched the result. */
};

/* What the part for commands does for the measurement (modbus_command.c). */
struct fathom_modbus_commands {
    /* Returns true if a command or setting keeps the measurement out. Ends one that its caller has abandoned. */
    bool (*is_occupied)(fathom_modbus_unit_t *unit);

    /* Forgets the command and the setting in progress, whose request was cancelled. */
    void (*forget)(fathom_modbus_unit_t *unit);

    /* Returns the time until the next poll, if it is `due_us` without regard to abandoned commands. */
    uint32_t (*due_us)(const fathom_modbus_unit_t *unit, uint32_t due_us);
};

/* Each function that begins a command or setting names it in fathom_modbus_unit_t::commands. */
extern const fathom_modbus_commands_t fathom_modbus_commands;

/* Submits `unit->request`, whose message, time-out and retries are set. `id`: fathom_modbus_unit_t::current. */
fathom_status_t fathom_modbus_unit_submit(fathom_modbus_unit_t *unit, uint8_t id);

/* Cancels the request, and forgets its result. */
void fathom_modbus_unit_drop_request(fathom_modbus_unit_t *unit);

/* Returns how the present request has ended, once; FATHOM_PENDING: it has not. The state is not IDLE. */
fathom_status_t fathom_modbus_unit_result(fathom_modbus_unit_t *unit);

#endif
