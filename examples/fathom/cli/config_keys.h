/* SPDX-License-Identifier: MIT */
#ifndef CONFIG_KEYS_H
#define CONFIG_KEYS_H

#include "cli/config_file.h"
#include "cli/sensor_word.h"

/* The keys of the configuration file, in one table: what the file may have, the help, and the page's table come from it. */

typedef enum {
    SECTION_TOP,
    SECTION_BROKER,
    SECTION_TLS,
    SECTION_QUEUE,
    SECTION_LINE,
    SECTION_SENSOR,
    SECTIONS
} section_t;

typedef enum {
    CONFIG_SITE,
    CONFIG_PREFIX,
    CONFIG_DISCOVERY,
    CONFIG_BROKER,
    CONFIG_QUEUE,
    CONFIG_INTERVAL,
    CONFIG_TIMEOUT,
    CONFIG_RETRIES,
    CONFIG_LINES,
    BROKER_HOST,
    BROKER_PORT,
    BROKER_CLIENT_ID,
    BROKER_USER,
    BROKER_PASSWORD_FILE,
    BROKER_PASSWORD_CREDENTIAL,
    BROKER_KEEP_ALIVE,
    BROKER_TLS,
    TLS_CA_FILE,
    TLS_CERTIFICATE_FILE,
    TLS_KEY_FILE,
    QUEUE_MESSAGES,
    QUEUE_BYTES,
    LINE_PORT,
    LINE_SENSORS,
    SENSOR_NAME,
    SENSOR_SENSOR,
    SENSOR_INTERVAL,
    SENSOR_TIMEOUT,
    SENSOR_RETRIES,
    SENSOR_VALUE,
    SENSOR_PROBES,
    SENSOR_FIRST_REGISTER,
    SENSOR_WINDOW,
    SENSOR_MEANS,
    SENSOR_TEMPERATURE,
    SENSOR_MEDIAN,
    SENSOR_GATE,
    SENSOR_LEVEL,
    SENSOR_ALARM,
    CONFIG_KEYS
} config_key_t;

/* What a value is. PAIRS: a text such as "key=value,key=value", or a map of these keys. */
typedef enum { SHAPE_TEXT, SHAPE_PAIRS, SHAPE_MAP, SHAPE_LIST } shape_t;

typedef struct {
    const char *name;
    const char *takes; /* in words */
    section_t section;
    shape_t shape;
    bool is_needed;
} config_row_t;

extern const config_row_t config_rows[CONFIG_KEYS];

/* What stands in a map of the file: NULL where a key does not. */
typedef struct {
    const yaml_node_t *at[CONFIG_KEYS];
    const yaml_node_t
        *port_keys[PORT_KEYS]; /* in SECTION_LINE; one that two kinds of ports have, as the first of them */
} config_values_t;

/* Takes a map apart. False after saying what is wrong with it: what is no map, an unknown key, one that stands twice, a value
 * of another shape, one that is missing. */
bool config_take(config_file_t *file, const char *command, const yaml_node_t *map, section_t section,
                 config_values_t *values);

/* What a value may be, in words; until the next call. */
const char *port_key_takes(port_key_t key);

/* "broker:", "" for the top. */
const char *config_section_name(section_t section);

/* A line a key. */
void config_keys_help(FILE *to);

#endif
