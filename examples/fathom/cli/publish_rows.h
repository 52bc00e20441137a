/* SPDX-License-Identifier: MIT */
#ifndef PUBLISH_ROWS_H
#define PUBLISH_ROWS_H

#include <stdio.h>

#include "cli/rows.h"
#include "mqtt/settings.h"

/* The keys of the configuration file of `fathom publish`, and the structures that they fill. */

typedef struct {
    broker_settings_t settings;
    char credential[SETTINGS_NAME]; /* of systemd; "": none */
} publish_broker_t;

typedef struct {
    char site[SETTINGS_NAME]; /* "": the host's name */
    char prefix[SETTINGS_NAME];
    char discovery[SETTINGS_NAME]; /* "off": none */
    publish_broker_t broker;
    uint32_t queue_messages;
    uint32_t queue_bytes;
    reader_settings_t reader; /* of sensors without their own */
    const void *lines;        /* a list */
} publish_top_t;

typedef struct {
    const char *port;
    port_keys_t keys;
    const void *sensors; /* a list */
} publish_line_t;

typedef struct {
    const char *name;
    char *sensor;
    reader_settings_t reader;
    results_config_t results;
    option_given_t given;
} publish_sensor_t;

extern const option_table_t publish_top_tables[];
extern const option_table_t publish_sensor_tables[];
extern const option_t publish_broker_keys[];
extern const option_t publish_tls_keys[];
extern const option_t publish_line_keys[]; /* without the keys of its port */

/* Can it be a level of a topic, or with `has_slashes` several? */
bool topic_name_is_good(const char *text, bool has_slashes);

/* Prints all keys, a line each. */
void publish_print_keys(FILE *to);

#endif
