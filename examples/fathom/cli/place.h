/* SPDX-License-Identifier: MIT */
#ifndef PLACE_H
#define PLACE_H

#include "cli/port_options.h"
#include "sensors/sensor_text.h"

/*
 * [NAME=]SENSOR[:ADDRESS][:MODE][@PORT[,key=value...]], as a user names a sensor and where it is:
 *
 *     word   = [ NAME "=" ] sensor [ "@" PORT { "," key "=" value } ]
 *     sensor = model [ ":" [ ADDRESS ] ] [ ":" MODE ]
 *
 * No comma is in a PORT, which else is any path; with one, but no key behind it, it may stand in --port.
 */
enum { PLACE_NAME = 32 };

typedef struct {
    const char *word;      /* all of it but the keys */
    char name[PLACE_NAME]; /* "": none was given */
    sensor_text_t sensor;
    const char *port; /* NULL: none */
    port_keys_t keys;
} sensor_place_t;

/* May the first `length` bytes of it be a NAME? */
bool place_is_name(const char *text, size_t length);

/* The word is cut behind its port, which place->port then points into. *place may not be moved. False after a usage
 * error. */
bool place_parse(sensor_place_t *place, const char *command, char *word);

#endif
