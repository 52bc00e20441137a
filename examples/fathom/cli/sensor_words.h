/* SPDX-License-Identifier: MIT */
#ifndef SENSOR_WORDS_H
#define SENSOR_WORDS_H

#include "cli/sensor_word.h"
#include "reading/site.h"

/* What options set for the sensors of a command: for their ports, unless a key stands behind one, and for a single
 * sensor. */
typedef struct {
    const char *path; /* NULL: not given */
    port_keys_t keys; /* of serial ports */
    bool rs485;
    uint32_t address;
    bool has_address;
    const char *mode; /* NULL: not given */
} sensor_defaults_t;

/*
 * Reads the words that name sensors, and finds out which share a port. `origins` has one for each word. The words are
 * cut. `asks_all` is set before, all else is set here but what a reader is to do. False after rejecting what cannot be.
 */
bool sensor_words(site_t *site, const sensor_defaults_t *defaults, char **words, int count,
                  const origin_t *origins);

/* The same for sensors whose words were parsed. */
bool sensors_add(site_t *site, const sensor_defaults_t *defaults, const sensor_word_t *sensors, int count,
                 const origin_t *origins);

/* ---- rules, for sensor_words; false after rejecting what breaks one ---- */

/* Can a sensor be read in its mode at this port? */
bool sensor_suits_port(const sensor_t *sensor, const origin_t *origin);

/* Can these sensors be read together at their ports? */
bool sensors_suit_lines(const site_t *site, const origin_t *origins);

/* Is no line of a GPIO chip used twice? */
bool sensors_suit_pins(const site_t *site, const port_options_t *port, const origin_t *origin);

/* Gives sensors with the same name others by their ports. */
bool sensors_set_names(const site_t *site, const origin_t *origins);

/* The port of a mode on pins, as an example: "gpiochip0,in=5". False: the mode has no pins. */
enum { PORT_EXAMPLE = 80 };
bool pins_example(const model_mode_t *mode, const char *chip, char text[PORT_EXAMPLE]);

#endif
