/* SPDX-License-Identifier: MIT */
#ifndef RECORD_H
#define RECORD_H

#include "sensors/models.h"

/*
 * The record of `fathom commission`: a text file with a line for each sensor. A sensor is in the record before anything
 * is written to it, so the record shows after any interruption where each sensor can be.
 */
enum { RECORD_UNITS = 255, RECORD_NUMBER = 64, RECORD_TIME = 24 };

typedef struct {
    const model_t *model;       /* NULL: no sensor has or gets this address */
    char number[RECORD_NUMBER]; /* the UUID; "-" if the model has none */
    char when[RECORD_TIME];     /* time of the last change, UTC */
    uint8_t address;
    bool
        is_done; /* the sensor is at its address and verified. Otherwise it is there, or still at address 1 */
} record_unit_t;

typedef struct {
    const char *path;
    record_unit_t units[RECORD_UNITS]; /* by address */
} record_t;

/* Reads the file. A file that does not exist is an empty record. Returns false after printing what is wrong. */
bool record_read(record_t *record, const char *path);

/* Replaces the file, or leaves it unchanged and returns false after printing the reason. */
bool record_write(const record_t *record);

/* Stores a line with the time, in place of that of the same address, and writes the file. Returns false after printing
 * the reason; the record is unchanged then. */
bool record_put(record_t *record, const record_unit_t *unit, uint64_t utc_us);

/* Returns the line of a UUID; NULL if there is none. */
const record_unit_t *record_of(const record_t *record, const model_t *model, const char *number);

/* Returns true if the sensors of this model have a UUID. */
bool record_has_numbers(const model_t *model);

#endif
