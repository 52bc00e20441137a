/* SPDX-License-Identifier: MIT */
#ifndef SENSOR_WORDS_H
#define SENSOR_WORDS_H

#include "cli/option.h"
#include "reading/site.h"

/*
 * [NAME=]SENSOR[:ADDRESS][:MODE][@PORT[,key=value...]], as a user names a sensor and its port:
 *
 *     word   = [ NAME "=" ] sensor [ "@" PORT { "," key "=" value } ]
 *     sensor = model [ ":" [ ADDRESS ] ] [ ":" MODE ]
 *
 * A PORT is any path without a comma. An ADDRESS is a number; what begins with a letter is a MODE.
 */
enum { SENSOR_NAME_SIZE = 32 };

typedef struct {
    origin_t origin;
    const char *word;            /* all of it but the keys */
    char name[SENSOR_NAME_SIZE]; /* "": none was given */
    const model_t *model;
    const char *address; /* NULL: none was given; "": the factory's */
    const char *mode;    /* NULL: none was given */
    const char *port;    /* NULL: none was given */
    port_keys_t keys;
    char parts[40];
} sensor_word_t;

/* The keys of serial ports and of GPIO chips: a port_keys_t. */
extern const option_t serial_keys[];
extern const option_t chip_keys[];

/* The name of a key. */
const char *port_key_name(port_key_t key);

/* Can the first `length` bytes of it be a NAME? */
bool sensor_name_is_good(const char *text, size_t length);

/* Cuts the word, into which *sensor then points. *sensor may not be moved. False after rejecting it. */
bool sensor_word_parse(sensor_word_t *sensor, char *word, const origin_t *origin);

/* Parses the ADDRESS of a sensor in this mode. Without one *address stays. False after rejecting it. */
bool sensor_word_address(const sensor_word_t *word, const model_mode_t *mode, uint8_t *address);

/* The model, or the mode of a model, with this name. NULL after rejecting it. */
const model_t *model_word(const char *name, const origin_t *origin);
const model_mode_t *mode_word(const model_t *model, const char *name, const origin_t *origin);

/* What options set for the sensors of a command: for their ports, unless a key stands behind one, and for a single
 * sensor. */
typedef struct {
    const char *path; /* NULL: not given */
    port_keys_t keys; /* of serial ports */
    uint32_t address;
    bool has_address;
    const char *mode; /* NULL: not given */
} sensor_defaults_t;

/*
 * Reads the words that name sensors, and finds out which share a port. The words are cut. `asks_all` is set before, all
 * else is set here but what a reader is to do. False after rejecting what cannot be.
 */
bool sensor_words(site_t *site, const sensor_defaults_t *defaults, char **words, int count,
                  const origin_t *origin);

/* The same for sensors whose words were parsed. */
bool sensors_add(site_t *site, const sensor_defaults_t *defaults, const sensor_word_t *words, int count);

#endif
