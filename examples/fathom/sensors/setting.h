/* SPDX-License-Identifier: MIT */
#ifndef SETTING_H
#define SETTING_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "sensors/reader.h"

/*
 * What a device tells and what can be set in it: the rows that `fathom info`, `get` and `set` work from. A new setting
 * is a row in the table of its model, which a row without a name ends.
 */
enum { SETTING_TEXT = 64 };

/* What a row is of: what `fathom save` keeps of a unit, and `fathom restore` writes. */
typedef enum {
    SETTING_KEPT = 0, /* what can be set and holds over power-off */
    SETTING_VERSION,  /* which make of unit it is; cannot be set */
    SETTING_IDENTITY, /* which unit it is, of all of its model; cannot be set */
    SETTING_PRESENT   /* of the moment: measured, a command, or what another row tells in another way */
} setting_kind_t;

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
    setting_kind_t kind;
    /* Number of the command whose response has the values of several rows. 0: the response has only this value, or the
     * rows fail for different reasons. */
    uint8_t shared_command;
    bool has_zero;       /* 0 is a value too, at which it may not be found again */
    bool moves;          /* from then on the device is elsewhere: its address, ... */
    bool is_baud;        /* ... or its line settings */
    bool is_never_blind; /* it has to be read before it is written, or afterwards */
    bool is_of_variant;  /* not every variant of the device has it */
    const char *risk;    /* what writing it may do to a unit whose value is not known; NULL: nothing else */
    /* Where it cannot be read: what shows that it holds; NULL: its acknowledgement alone. */
    const char *confirmed;
    const char *unconfirmed; /* the same for what does not */
    /* Called until they are not FATHOM_PENDING. get leaves the value in `text`; NULL: it cannot be read. set takes a
     * number or the number of a word. */
    fathom_status_t (*get)(reader_t *reader, char text[SETTING_TEXT]);
    fathom_status_t (*set)(reader_t *reader, int32_t value);
    /* Of all units on a line; NULL: there is none. */
    fathom_status_t (*set_all)(reader_t *reader, int32_t value);
    /* After a set: does it hold from the next power-on only? NULL: it holds now, or as `effect` says. */
    bool (*is_later)(const reader_t *reader);
    void (*remark)(FILE *to, const char *text); /* what to know of this value; NULL: nothing */
} setting_t;

#endif
