/* SPDX-License-Identifier: MIT */
#ifndef BACKUP_H
#define BACKUP_H

#include "device/session.h"

/* The settings that `fathom save` keeps, as the sensor reports them or as a file has them. */
typedef enum {
    HELD_NOTHING = 0, /* the file does not have the setting */
    HELD_VALUE,
    HELD_NOT_READABLE, /* write-only */
    HELD_NOT_THERE,    /* this variant of the sensor does not have it */
    HELD_NOT_SETTABLE  /* the sensor has a value that cannot be set */
} held_t;

typedef struct {
    held_t held;
    int32_t value;           /* of a setting that can be set */
    char text[SETTING_TEXT]; /* the value as text */
    fathom_status_t status;  /* with HELD_NOT_THERE: the reason */
    unsigned line;           /* of the file; 0: none */
} backup_row_t;

enum { BACKUP_ROWS = 32 };

typedef struct {
    const model_t *model;
    backup_row_t rows[BACKUP_ROWS]; /* in the order of the model's settings */
} backup_t;

/* Returns the number of the model's settings. */
size_t backup_count(const model_t *model);

/* Returns true if a backup keeps this setting. */
bool backup_has(const setting_t *setting);

/* Returns the text in place of a value, "not readable"; NULL: there is none. */
const char *backup_word(held_t held);

/* Stores the value. It can be set, or it is address 0, which a sensor can have and restore does not write. */
bool backup_value(const setting_t *setting, const char *text, int32_t *value);

/* Returns true if both rows have the same value. */
bool backup_is_same(const setting_t *setting, const backup_row_t *one, const backup_row_t *other);

/* Reads all settings of the sensor. Returns false after printing the reason. */
bool backup_read(session_t *session, backup_t *unit);

#endif
