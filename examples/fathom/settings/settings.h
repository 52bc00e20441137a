/* SPDX-License-Identifier: MIT */
#ifndef SETTINGS_H
#define SETTINGS_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "models/readers.h"

/*
 * What a device tells and what can be set in it: the rows that `fathom info`, `get` and `set` work from. A new setting
 * is a row in the table of its sensor.
 */
enum { SETTING_TEXT = 64 };

typedef struct {
    const char *name;
    const char *what;
    const char *mode;         /* in which it can be asked: "modbus", "dyp" */
    const char *unit;         /* of the value; NULL: it has none */
    const char *effect;       /* of a change: when it holds and how long; NULL: it cannot be changed */
    const char *const *words; /* the values by name, 0 the first, ended by NULL; or NULL: numbers, ... */
    int32_t least;            /* ... from here */
    int32_t most;             /* to here, */
    int32_t step;             /* a multiple of this */
    bool has_zero;            /* 0 is a value too, at which it may not be found again */
    bool moves;               /* from then on the device is elsewhere: its address, ... */
    bool is_baud;             /* ... or its line settings */
    bool is_never_blind;      /* it has to be read before it is written, or afterwards */
    const char
        *confirmed; /* where it cannot be read: what shows that it holds; NULL: its acknowledgement alone */
    const char *unconfirmed; /* the same for what does not */
    /* Called until they are not FATHOM_PENDING. get leaves the value in `text`; NULL: it cannot be read. set takes a
     * number or the number of a word. */
    fathom_status_t (*get)(reader_t *reader, char text[SETTING_TEXT]);
    fathom_status_t (*set)(reader_t *reader, int32_t value);
    fathom_status_t (*set_all)(reader_t *reader,
                               int32_t value); /* of all units on a line; NULL: there is none */
    /* After a set: does it hold from the next power-on only? NULL: it holds now, or as `effect` says. */
    bool (*is_later)(const reader_t *reader);
    void (*remark)(FILE *to, const char *text); /* what to know of this value; NULL: nothing */
} setting_t;

/* Ended by a row without a name. */
extern const setting_t settings_a16[];
extern const setting_t settings_a05[];
extern const setting_t settings_hps167s[];

/* By name; NULL after a usage error that lists what there is. */
const setting_t *setting_find(const char *command, const char *model, const setting_t *settings,
                              const char *name);

/* False after a usage error. */
bool setting_parse(const char *command, const setting_t *setting, const char *text, int32_t *value);

/* A word, or a number. */
void setting_print_value(const setting_t *setting, int32_t value, char text[SETTING_TEXT]);

/* All of them with their values and effects, for people. */
void settings_print(FILE *to, const setting_t *settings);

#endif
