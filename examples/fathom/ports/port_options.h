/* SPDX-License-Identifier: MIT */
#ifndef PORT_OPTIONS_H
#define PORT_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "fathom/hal.h"

/* A port as a user names it, with its settings. */

typedef enum {
    PORT_SERIAL,
    PORT_GATEWAY, /* tcp:HOST[:PORT], a Modbus TCP server */
    PORT_PINS     /* lines of a GPIO chip: the last part of the path begins with gpiochip */
} port_kind_t;

port_kind_t port_kind(const char *path);

/* The parts of tcp:HOST[:PORT]. An IPv6 address stands in brackets. */
typedef struct {
    char host[256]; /* DNS allows no longer name */
    char service[6];
} tcp_address_t;

/* Parses the path of a gateway. Returns NULL, or what is wrong with it. */
const char *tcp_parse(const char *path, tcp_address_t *address);

/* Returns the part of a path behind its last slash. */
const char *port_last_part(const char *path);

/* Returns true if both paths lead to the same port, as a link and its target do. A port that does not exist is known by
 * its path only. */
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
    KEY_TRIGGER, /* of a serial port also, with the number of its chip in the upper 16 bits */
    KEY_PULSE,   /* written echo= */
    KEY_IN,
    KEY_BIAS, /* fathom_gpio_bias_t */
    KEY_NEAR, /* pins_near_t */
    PORT_KEYS
} port_key_t;

typedef struct {
    uint32_t value[PORT_KEYS]; /* 0 unless the user set this key */
    bool has[PORT_KEYS];
} port_keys_t;

/* The level of `in` that means that something is near. */
typedef enum {
    PINS_NEAR_USUAL = 0, /* with factory settings */
    PINS_NEAR_LOW = 1,
    PINS_NEAR_HIGH = 2
} pins_near_t;

/* Lines of a GPIO chip by their numbers; -1: none. */
typedef struct {
    int32_t trigger; /* to the sensor's RX; an output */
    uint32_t chip;   /* of a serial port: 1 + the number of the chip that has the trigger; 0: no trigger */
    int32_t echo;    /* from the sensor's TX: pulses */
    int32_t in;      /* a switch, or the contact of a relay */
    uint8_t bias;    /* of the inputs; fathom_gpio_bias_t */
    uint8_t near;    /* pins_near_t */
} pin_options_t;

/* A port, and the line behind it. port_open() needs the path and, for a serial port, the line. */
typedef struct {
    const char *path;
    fathom_line_settings_t line; /* with which it is opened: those of its slowest sensor */
    bool has_mixed_lines;        /* its sensors have different ones */
    size_t station_count;        /* sensors at it */
    port_keys_t keys;            /* that stand behind it */
    /* port_options_take() sets the rest. */
    port_kind_t kind;
    bool rs485;
    uint8_t echo;
    pin_options_t pins;
} port_options_t;

/* Sets what follows from the path and the keys. A serial port uses the defaults of the keys that it does not have. */
void port_options_take(port_options_t *port, const port_keys_t *defaults);

/* Changes the line settings of one of its sensors in the same way. */
void port_options_line(const port_options_t *port, const port_keys_t *defaults, fathom_line_settings_t *line);

/* ---- the settings of a line in words ---- */

/* The rates that a port can have, and the names of FATHOM_PARITY_NONE, _EVEN and _ODD, as word_find() searches them. */
#define PORT_BAUDS    "9600 19200 38400 57600 115200 230400"
#define PORT_PARITIES "none even odd"

/* Writes "9600 8N1". Returns text. */
enum { LINE_TEXT = 24 };
const char *line_text(const fathom_line_settings_t *settings, char text[LINE_TEXT]);

/* Returns "none", "even" or "odd". */
const char *parity_name(uint8_t parity);

#endif
