/* SPDX-License-Identifier: MIT */
#ifndef RECORD_H
#define RECORD_H

#include "sensors/models.h"

/*
 * The record of what was commissioned: a file of text, a line a unit. What is intended is in it before anything is
 * written to a unit, so that after any end of the program, or of the power, it tells where each unit can be.
 */
enum { RECORD_UNITS = 254, RECORD_NUMBER = 64, RECORD_TIME = 24 };

typedef enum {
    RECORD_PLANNED, /* it is at its address, or still at address 1 */
    RECORD_RESTART, /* the same; its termination was acknowledged, and reads so from the next power-on only */
    RECORD_DONE     /* and verified */
} record_state_t;
extern const char *const record_states[]; /* as words */

typedef struct {
    const model_t *model;
    char number[RECORD_NUMBER]; /* its own: the UUID; "-": the model has none */
    char when[RECORD_TIME];     /* since when it is so, UTC */
    uint8_t address;
    record_state_t state;
} record_unit_t;

typedef struct {
    const char *path;
    uint32_t count;
    record_unit_t units[RECORD_UNITS];
} record_t;

/* Reads the file; one that is not there is empty. False after saying what is wrong with it. */
bool record_read(record_t *record, const char *path);

/* Writes the file, or leaves it as it was: false after saying why. */
bool record_write(const record_t *record);

/* The unit with this address, or with this number; NULL: there is none. */
record_unit_t *record_at(record_t *record, uint8_t address);
record_unit_t *record_of(record_t *record, const model_t *model, const char *number);

/* Puts a unit in, in place of the one with its address, and writes the file. utc_us: now. NULL after saying why. */
record_unit_t *record_put(record_t *record, const record_unit_t *unit, uint64_t utc_us);

/* Takes a unit out and writes the file. False after saying why. */
bool record_drop(record_t *record, const record_unit_t *unit);

/* Does the model have numbers? */
bool record_has_numbers(const model_t *model);

#endif
