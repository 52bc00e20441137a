/* SPDX-License-Identifier: MIT */
#ifndef SETTING_H
#define SETTING_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/status.h"

/*
 * The values of a sensor: `fathom info`, `get`, `set`, `save`, `restore` and `decode` work from these rows. A new value
 * is a row in the table of its sensor, which a row without a name ends.
 */
enum { SETTING_TEXT = 64 };

/* What `fathom save` keeps and `fathom restore` writes. */
typedef enum {
    SETTING_KEPT = 0, /* it can be set, and is kept over power-off */
    SETTING_VERSION,  /* of the make of the unit; it cannot be set */
    SETTING_IDENTITY, /* of this unit alone; it cannot be set */
    SETTING_PRESENT   /* a measurement, a command, or another form of another row */
} setting_kind_t;

typedef struct {
    const char *name;
    const char *what;
    setting_kind_t kind;

    /* ---- in the frames of the sensor ---- */
    uint16_t read_at;    /* register whose response has the value, or several; 0: write-only */
    uint16_t write_at;   /* register that sets it; 0: none */
    uint8_t byte;        /* position in the response */
    uint8_t size;        /* bytes; 0: a register of two bytes */
    uint16_t first_word; /* on the wire: the value of words[0] ... */
    uint16_t word_step;  /* ... and the distance to that of words[1]; 0: 1 */
    /* Prints the value of a response, instead of a number or a word. */
    void (*print)(char text[SETTING_TEXT], const uint16_t *registers);
    const char *(*note)(int64_t value); /* why this value is odd, besides its range; NULL: it is not */

    /* ---- its values ---- */
    const char *unit;         /* NULL: none */
    const char *const *words; /* names of the values from 0 on, ended by NULL. NULL: numbers, ... */
    int32_t least;            /* ... from here */
    int32_t most;             /* to here, */
    int32_t step;             /* a multiple of this */
    bool has_zero;            /* 0 is a value as well, at which the unit may not be found again */

    /* ---- a change ---- */
    const char *effect;      /* when it takes effect, and how long; NULL: read-only */
    bool is_later;           /* it takes effect from the next power-on */
    const char *mode;        /* name of the mode that it needs; NULL: the mode that uses Modbus */
    const char *risk;        /* of writing it to a unit whose value is not known; NULL: none */
    const char *confirmed;   /* if it is write-only: what shows its effect; NULL: the acknowledgement */
    const char *unconfirmed; /* the same if nothing does */
    const char *remark;      /* a message for a value that is words[1], and that words[0] mends; NULL: none */
    bool moves;              /* it moves the unit to another address ... */
    bool is_baud;            /* ... or to another baud rate */
    bool is_never_blind;     /* it must be read before or after it is written */
    bool is_of_variant;      /* not every variant of the sensor has it */
    bool has_broadcast;      /* it can be set in all units on the line */
} setting_t;

/* Returns the value in the registers of a response. */
int64_t setting_decode(const setting_t *setting, const uint16_t *registers);

/* Returns the number of the word with this value on the wire; -1: no word has it. */
int32_t setting_word(const setting_t *setting, int64_t value);

/* Returns true if the value is one of the words, or in the range. */
bool setting_can_be(const setting_t *setting, int64_t value);

/* Prints the value of a response as `get` does. Returns FATHOM_ERR_MALFORMED if no word has it. */
fathom_status_t setting_print(const setting_t *setting, const uint16_t *registers, char text[SETTING_TEXT]);

/* Returns the setting with this name; NULL: there is none. */
const setting_t *setting_of(const setting_t *settings, const char *name);

#endif
