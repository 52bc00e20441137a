/* SPDX-License-Identifier: MIT */
#ifndef PORT_SETTINGS_H
#define PORT_SETTINGS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "fathom/hal.h"
#include "fathom_loop.h"
#include "ports/pins.h"

/* A port as a user names it, with its settings. */

/* What a path promises, as the functions of port.h say it of an open port: a serial line; Modbus behind tcp:HOST[:PORT];
 * or the lines of a GPIO chip, if the last part of the path begins with gpiochip. */
bool port_path_has_line(const char *path);
bool port_path_has_gateway(const char *path);
bool port_path_has_pins(const char *path);

/* Returns NULL, or what is wrong with the path. */
const char *port_path_error(const char *path);

/* The part of a path behind its last slash. */
const char *port_last_part(const char *path);

/* Do both paths lead to the same port, as a link and its target do? A port that does not exist is known by its path
 * only. */
bool port_is_same(const char *one, const char *other);

/* ---- what can be set for a port ---- */

typedef enum {
    /* of a serial port */
    KEY_BAUD,
    KEY_PARITY, /* FATHOM_PARITY_... */
    KEY_STOP_BITS,
    KEY_RS485, /* 0 or 1: the kernel's driver switches the transceiver */
    KEY_ECHO,  /* fathom_line_parts_t.echo */
    /* of a GPIO chip: lines, by their number on it */
    KEY_TRIGGER, /* of a serial port as well, with its chip */
    KEY_PULSE,   /* written echo= */
    KEY_IN,
    KEY_BIAS, /* fathom_gpio_bias_t */
    KEY_NEAR, /* pins_near_t */
    PORT_KEYS
} port_key_t;

typedef struct {
    uint32_t value[PORT_KEYS];
    bool has[PORT_KEYS]; /* the user set this one */
} port_keys_t;

/* What port_open() needs (port.h). */
typedef struct {
    const char *path;             /* of a serial port, tcp:HOST[:PORT], or of a GPIO chip; copied */
    fathom_line_settings_t line;  /* of a serial port */
    uint8_t echo;                 /* of a serial port: fathom_line_parts_t.echo */
    bool rs485;                   /* of a serial port: the kernel's driver switches the transceiver */
    pin_options_t pins;           /* of a GPIO chip; of a serial port: the trigger */
    fathom_loop_source_t *source; /* the port is read only after this source became ready; NULL: always */
} port_settings_t;

/* A port, and the line behind it. */
typedef struct {
    const char *path;   /* of a serial port; tcp:HOST[:PORT]; of a GPIO chip, "gpiochip0" too */
    bool has_pins;      /* it belongs to one sensor; another sensor at this chip has a row of its own */
    pin_options_t pins; /* of a chip */
    bool rs485;         /* the kernel's driver switches the transceiver */
    fathom_line_settings_t line; /* with which it is opened: those of its slowest sensor */
    bool has_mixed_lines;        /* its sensors have different ones */
    uint8_t echo;                /* fathom_line_parts_t.echo */
    port_keys_t keys;            /* that stand behind it */
    size_t station_count;        /* sensors at it */
} port_options_t;

/* Fills in what follows from its keys, and for a serial port from the defaults of those that it does not have; all but
 * the line. */
void port_options_take(port_options_t *port, const port_keys_t *defaults);

/* Changes the line settings of one of its sensors in the same way. */
void port_options_line(const port_options_t *port, const port_keys_t *defaults, fathom_line_settings_t *line);

port_settings_t port_options_settings(const port_options_t *port);

#endif
