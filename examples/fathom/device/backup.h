/* SPDX-License-Identifier: MIT */
#ifndef BACKUP_H
#define BACKUP_H

#include "device/session.h"

/* What a unit has of what `fathom save` keeps; as it tells it, or as a file has it. */
typedef enum {
    HELD_NOTHING = 0, /* no line of the file says anything */
    HELD_VALUE,
    HELD_NOT_READABLE, /* it can be set only */
    HELD_NOT_THERE,    /* this variant of the device does not answer */
    HELD_NOT_SETTABLE  /* the unit has a value that cannot be set */
} held_t;

typedef struct {
    held_t held;
    int32_t value;           /* of what can be set: as a setting has it */
    char text[SETTING_TEXT]; /* the value in words */
    fathom_status_t status;  /* why it is not there */
    unsigned line;           /* of the file; 0: none */
} backup_row_t;

enum { BACKUP_ROWS = 32 };

typedef struct {
    const model_t *model;
    backup_row_t rows[BACKUP_ROWS]; /* as the model's table of settings has them */
} backup_t;

/* How many rows the model's table has. */
size_t backup_count(const model_t *model);

/* Is this of what is kept? */
bool backup_has(const setting_t *setting);

/* The words for what is no value, "not readable"; NULL: there are none. */
const char *backup_word(held_t held);

/* A value that can be set; or address 0, which a unit can have and which restore does not write. */
bool backup_value(const setting_t *setting, const char *text, int32_t *value);

/* Do both have a value, and the same one? */
bool backup_is_same(const setting_t *setting, const backup_row_t *one, const backup_row_t *other);

/* Asks the unit for all of it. False after saying why. */
bool backup_read(session_t *session, backup_t *unit);

#endif
