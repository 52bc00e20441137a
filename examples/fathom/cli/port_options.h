/* SPDX-License-Identifier: MIT */
#ifndef PORT_OPTIONS_H
#define PORT_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "fathom/hal.h"
#include "ports/pins.h"

/* The port of a sensor, and what may stand behind it: PORT[,key=value...]. */

typedef enum {
    PORT_TTY,
    PORT_TCP, /* tcp:HOST[:PORT] */
    PORT_CHIP /* of GPIO lines: the last part of its path begins with gpiochip */
} port_kind_t;

/* Of the first `length` bytes of a path. */
port_kind_t port_kind(const char *path, size_t length);

/* Behind its last slash. */
const char *port_last_part(const char *path);

/* Do both paths lead to the same port, as a link and what it leads to do? Of one that is not there only its path is
 * known. */
bool port_is_same(const char *one, const char *other);

/* ---- keys ---- */

typedef enum {
    /* of a tty */
    KEY_BAUD,
    KEY_PARITY, /* FATHOM_PARITY_... */
    KEY_STOP_BITS,
    KEY_RS485, /* 0 or 1: the kernel's driver is to drive the transceiver */
    KEY_ECHO,  /* fathom_line_parts_t.echo */
    /* of a GPIO chip: lines, by their number on it */
    KEY_TRIGGER,
    KEY_PULSE, /* written echo= */
    KEY_IN,
    KEY_BIAS, /* fathom_gpio_bias_t */
    KEY_NEAR, /* pins_near_t */
    PORT_KEYS
} port_key_t;

typedef struct {
    uint32_t value[PORT_KEYS];
    uint16_t given; /* bits 1 << port_key_t */
} port_keys_t;

bool port_keys_has(const port_keys_t *keys, port_key_t key);

/* Do a comma, a key and "=" follow in it? Then they were meant to stand behind a sensor. */
bool port_path_has_keys(const char *path);

/* As a user writes it, and what its value may be, in words. */
const char *port_key_name(port_key_t key);
const char *port_key_takes(port_key_t key);

/* Reads "key=value,key=value". word: what the user has written, for messages. False after a usage error. */
bool port_keys_parse(port_keys_t *keys, const char *command, const char *word, port_kind_t kind,
                     const char *list);

/* Reads the options that say the same as keys: for each key what was given; NULL: nothing. False after a usage error. */
bool port_keys_options(port_keys_t *keys, const char *command, const char *const given[PORT_KEYS]);

/* Adds those of another sensor at this port. False after a usage error: they do not agree. */
bool port_keys_add(port_keys_t *keys, const char *command, const char *word, const port_keys_t *others);

/* ---- the port ---- */

/* A port, and the line behind it. */
typedef struct {
    const char *path;   /* of a tty; tcp:HOST[:PORT]; or of a GPIO chip, "gpiochip0" too */
    bool is_chip;       /* then it is one sensor's alone; another at this chip has a row of its own */
    pin_options_t pins; /* then */
    bool rs485;         /* the kernel's driver is to drive the transceiver */
    fathom_line_settings_t line; /* with which it is opened: the slowest of its sensors' */
    bool has_mixed_lines;        /* they differ in that */
    uint8_t echo;                /* fathom_line_parts_t.echo */
    port_keys_t keys;            /* that stood behind it */
    size_t station_count;        /* sensors at it */
} port_options_t;

/* What its keys, and of a tty these defaults of those that are not given, say for it; all but the line. */
void port_options_take(port_options_t *port, const port_keys_t *defaults);

/* The same for the line of one of its sensors, which is the factory's before. */
void port_options_line(const port_options_t *port, const port_keys_t *defaults, fathom_line_settings_t *line);

/* The help of --port, of the options that say the same as keys, and of the keys. */
void port_options_help(FILE *to);

#endif
