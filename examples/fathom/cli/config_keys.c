/* SPDX-License-Identifier: MIT */
#include "cli/config_keys.h"

#include <string.h>

#include "cli/command.h"
#include "cli/options.h"

#define OF_SITE "letters, digits, - _ . and / between them, 100 characters at most"
#define AS_READ "as --"

const config_row_t config_rows[CONFIG_KEYS] = {
    [CONFIG_SITE] = {"site", "the second level of all topics: " OF_SITE "; default: the host's name",
                     SECTION_TOP, SHAPE_TEXT, false},
    [CONFIG_PREFIX] = {"prefix", "the first level of all topics: " OF_SITE "; default: fathom", SECTION_TOP,
                       SHAPE_TEXT, false},
    [CONFIG_DISCOVERY] = {"discovery", "Home Assistant's discovery prefix, or off; default: homeassistant",
                          SECTION_TOP, SHAPE_TEXT, false},
    [CONFIG_BROKER] = {"broker", "a map with at least host:", SECTION_TOP, SHAPE_MAP, true},
    [CONFIG_QUEUE] = {"queue", "a map with messages: or bytes:, what is kept while the broker is away",
                      SECTION_TOP, SHAPE_MAP, false},
    [CONFIG_INTERVAL] = {"interval",
                         "ms from one attempt to the next, of sensors without their own; default: 1000",
                         SECTION_TOP, SHAPE_TEXT, false},
    [CONFIG_TIMEOUT] =
        {"timeout", "ms to wait for a response, of sensors without their own; default: as the sensor needs",
         SECTION_TOP, SHAPE_TEXT, false},
    [CONFIG_RETRIES] = {"retries",
                        "how often a request is repeated, of sensors without their own; default: 0",
                        SECTION_TOP, SHAPE_TEXT, false},
    [CONFIG_LINES] = {"lines", "a list of maps, each with port: and sensors:", SECTION_TOP, SHAPE_LIST, true},

    [BROKER_HOST] = {"host", "the broker's name or address", SECTION_BROKER, SHAPE_TEXT, true},
    [BROKER_PORT] = {"port", "a whole number from 1 to 65535; default: 1883, with tls: 8883", SECTION_BROKER,
                     SHAPE_TEXT, false},
    [BROKER_CLIENT_ID] = {"client-id", "up to 100 letters, digits, - and _; default: from prefix: and site:",
                          SECTION_BROKER, SHAPE_TEXT, false},
    [BROKER_USER] = {"user", "the name to log in with, up to 100 characters", SECTION_BROKER, SHAPE_TEXT,
                     false},
    [BROKER_PASSWORD_FILE] = {"password-file", "a file with the password in its first line", SECTION_BROKER,
                              SHAPE_TEXT, false},
    [BROKER_PASSWORD_CREDENTIAL] = {"password-credential",
                                    "the name of a systemd credential with the password in its first line",
                                    SECTION_BROKER, SHAPE_TEXT, false},
    [BROKER_KEEP_ALIVE] = {"keep-alive",
                           "s, from 5 to 3600, of silence before the broker is asked; default: 30",
                           SECTION_BROKER, SHAPE_TEXT, false},
    [BROKER_TLS] = {"tls", "a map; an empty one, {}, trusts the system's authorities", SECTION_BROKER,
                    SHAPE_MAP, false},

    [TLS_CA_FILE] = {"ca-file", "a file with the certificates of the authorities that are trusted",
                     SECTION_TLS, SHAPE_TEXT, false},
    [TLS_CERTIFICATE_FILE] = {"certificate-file", "the client's own certificate", SECTION_TLS, SHAPE_TEXT,
                              false},
    [TLS_KEY_FILE] = {"key-file", "its private key, without a passphrase", SECTION_TLS, SHAPE_TEXT, false},

    [QUEUE_MESSAGES] = {"messages", "a whole number from 1 to 1000000; default: 10000", SECTION_QUEUE,
                        SHAPE_TEXT, false},
    [QUEUE_BYTES] = {"bytes", "a whole number from 4096 to 1073741824; default: 4194304", SECTION_QUEUE,
                     SHAPE_TEXT, false},

    [LINE_PORT] = {"port", "a serial port, tcp:HOST[:PORT], or a GPIO chip", SECTION_LINE, SHAPE_TEXT, true},
    [LINE_SENSORS] = {"sensors", "a list of maps, each with name: and sensor:", SECTION_LINE, SHAPE_LIST,
                      true},

    [SENSOR_NAME] = {"name", "the sensor's level in the topics: up to 31 letters, digits, - _ and .",
                     SECTION_SENSOR, SHAPE_TEXT, true},
    [SENSOR_SENSOR] = {"sensor", "a16, a05 or hps167s, and :ADDRESS:MODE as `fathom read` has them",
                       SECTION_SENSOR, SHAPE_TEXT, true},
    [SENSOR_INTERVAL] = {"interval", AS_READ "interval of `fathom read`", SECTION_SENSOR, SHAPE_TEXT, false},
    [SENSOR_TIMEOUT] = {"timeout", AS_READ "timeout", SECTION_SENSOR, SHAPE_TEXT, false},
    [SENSOR_RETRIES] = {"retries", AS_READ "retries", SECTION_SENSOR, SHAPE_TEXT, false},
    [SENSOR_VALUE] = {"value", AS_READ "value", SECTION_SENSOR, SHAPE_TEXT, false},
    [SENSOR_PROBES] = {"probes", AS_READ "probes", SECTION_SENSOR, SHAPE_TEXT, false},
    [SENSOR_FIRST_REGISTER] = {"first-register", AS_READ "first-register", SECTION_SENSOR, SHAPE_TEXT, false},
    [SENSOR_WINDOW] = {"window", AS_READ "window", SECTION_SENSOR, SHAPE_TEXT, false},
    [SENSOR_MEANS] = {"means", AS_READ "means, or a map of the same", SECTION_SENSOR, SHAPE_PAIRS, false},
    [SENSOR_TEMPERATURE] = {"temperature", AS_READ "temperature: its s", SECTION_SENSOR, SHAPE_TEXT, false},
    [SENSOR_MEDIAN] = {"median", AS_READ "median", SECTION_SENSOR, SHAPE_TEXT, false},
    [SENSOR_GATE] = {"gate", AS_READ "gate", SECTION_SENSOR, SHAPE_TEXT, false},
    [SENSOR_LEVEL] = {"level", AS_READ "level, or a map of the same", SECTION_SENSOR, SHAPE_PAIRS, false},
    [SENSOR_ALARM] = {"alarm", AS_READ "alarm, or a map of the same, its threshold as when:", SECTION_SENSOR,
                      SHAPE_PAIRS, false},
};

static const char *const section_names[SECTIONS] = {
    [SECTION_TOP] = "",         [SECTION_BROKER] = "broker:", [SECTION_TLS] = "tls:",
    [SECTION_QUEUE] = "queue:", [SECTION_LINE] = "lines:",    [SECTION_SENSOR] = "sensors:",
};

const char *config_section_name(section_t section) { return section_names[section]; }

const char *port_key_takes(port_key_t key)
{
    static char text[OPTION_TAKES];
    option_takes(key < KEY_TRIGGER ? &serial_keys[key] : &chip_keys[key - KEY_TRIGGER], text);
    return text;
}

/* ---- the nearest known key ---- */

/* How many letters have to be changed, added or left out to make one of the other: by a row of the table at a time. */
static unsigned distance_of(const char *one, const char *other)
{
    enum { LONGEST = 32 };
    unsigned row[LONGEST + 1];
    const size_t length = strlen(other);
    if (strlen(one) > LONGEST || length > LONGEST) return LONGEST;
    for (unsigned j = 0; j <= length; j++) row[j] = j;
    for (unsigned i = 1; one[i - 1] != '\0'; i++) {
        unsigned diagonal = row[0];
        row[0] = i;
        for (unsigned j = 1; j <= length; j++) {
            const unsigned replaced = diagonal + (one[i - 1] != other[j - 1] ? 1 : 0);
            const unsigned least = (row[j] < row[j - 1] ? row[j] : row[j - 1]) + 1;
            diagonal = row[j];
            row[j] = replaced < least ? replaced : least;
        }
    }
    return row[length];
}

typedef struct {
    const char *key; /* as the file has it */
    const char *name;
    unsigned distance;
} nearest_key_t;

static void compare(nearest_key_t *nearest, const char *name)
{
    const unsigned this_distance = distance_of(nearest->key, name);
    if (nearest->name != NULL && this_distance >= nearest->distance) return;
    nearest->name = name;
    nearest->distance = this_distance;
}

/* Has the port keys too: a key of both kinds of ports stands there twice. */
static bool is_second(size_t key)
{
    for (size_t before = 0; before != key; before++)
        if (strcmp(port_key_name((port_key_t)before), port_key_name((port_key_t)key)) == 0) return true;
    return false;
}

static bool no_key(const char *command, section_t section, const char *key)
{
    char known[256] = "";
    nearest_key_t nearest = {.key = key};
    for (size_t i = 0; i != CONFIG_KEYS; i++) {
        if (config_rows[i].section != section) continue;
        compare(&nearest, config_rows[i].name);
        list_add(known, sizeof known, config_rows[i].name);
    }
    for (size_t i = 0; section == SECTION_LINE && i != PORT_KEYS; i++) {
        if (is_second(i)) continue;
        compare(&nearest, port_key_name((port_key_t)i));
        list_add(known, sizeof known, port_key_name((port_key_t)i));
    }
    if (section == SECTION_BROKER && strcmp(key, "password") == 0)
        (void)usage_error(command,
                          "no password stands in this file; write it into one that only this user can read, "
                          "and its path here: password-file: /etc/fathom/password");
    else
        (void)usage_error(command, "%s: is no key%s%s; did you mean %s: ? There are %s", key,
                          section == SECTION_TOP ? "" : " of ", section_names[section], nearest.name, known);
    return false;
}

/* ---- a map ---- */

static const char *shape_name(const yaml_node_t *node)
{
    if (node->type == YAML_SEQUENCE_NODE) return "a list";
    return node->type == YAML_MAPPING_NODE ? "a map" : "a text";
}

static bool is_empty(const yaml_node_t *node)
{
    return node->type == YAML_SCALAR_NODE && node->data.scalar.length == 0 &&
           node->data.scalar.style == YAML_PLAIN_SCALAR_STYLE;
}

static bool has_shape(const yaml_node_t *node, shape_t shape)
{
    const bool is_text = node->type == YAML_SCALAR_NODE && !is_empty(node) && config_file_text(node) != NULL;
    if (shape == SHAPE_MAP) return node->type == YAML_MAPPING_NODE;
    if (shape == SHAPE_LIST) return node->type == YAML_SEQUENCE_NODE;
    return is_text || (shape == SHAPE_PAIRS && node->type == YAML_MAPPING_NODE);
}

static bool check_shape(const char *command, const char *name, const char *takes, shape_t shape,
                        const yaml_node_t *node)
{
    if (has_shape(node, shape)) return true;
    (void)usage_error(command, "%s: takes %s, not %s", name, takes,
                      is_empty(node) ? "nothing" : shape_name(node));
    return false;
}

static bool put(const char *command, const char *name, const yaml_node_t **place, const yaml_node_t *value)
{
    if (*place == NULL) {
        *place = value;
        return true;
    }
    (void)usage_error(command, "%s: stands there twice, in line %u too; leave one of them out", name,
                      config_file_line(*place));
    return false;
}

static bool take_port_key(const char *command, const char *key, const yaml_node_t *value,
                          config_values_t *values, bool *is_one)
{
    for (size_t i = 0; i != PORT_KEYS; i++) {
        if (strcmp(port_key_name((port_key_t)i), key) != 0) continue;
        *is_one = true;
        return check_shape(command, key, port_key_takes((port_key_t)i), SHAPE_TEXT, value) &&
               put(command, key, &values->port_keys[i], value);
    }
    return true;
}

static bool take_pair(const char *command, section_t section, const char *key, const yaml_node_t *value,
                      config_values_t *values)
{
    bool is_port_key = false;
    for (size_t i = 0; i != CONFIG_KEYS; i++) {
        const config_row_t *const row = &config_rows[i];
        if (row->section != section || strcmp(row->name, key) != 0) continue;
        return check_shape(command, key, row->takes, row->shape, value) &&
               put(command, key, &values->at[i], value);
    }
    if (section == SECTION_LINE && !take_port_key(command, key, value, values, &is_port_key)) return false;
    return is_port_key || no_key(command, section, key);
}

bool config_take(config_file_t *file, const char *command, const yaml_node_t *map, section_t section,
                 config_values_t *values)
{
    memset(values, 0, sizeof *values);
    config_file_at(file, map);
    if (map->type != YAML_MAPPING_NODE) {
        (void)usage_error(command, "%s%shere stands a map, with a line for each key, such as %s: ..., not %s",
                          section_names[section], section == SECTION_TOP ? "" : " ",
                          section == SECTION_SENSOR ? "name" : (section == SECTION_LINE ? "port" : "site"),
                          shape_name(map));
        return false;
    }
    for (const yaml_node_pair_t *pair = map->data.mapping.pairs.start; pair != map->data.mapping.pairs.top;
         pair++) {
        const yaml_node_t *const key = config_file_node(file, pair->key);
        const char *const text = config_file_text(key);
        config_file_at(file, key);
        if (text == NULL) {
            (void)usage_error(command, "a key is a word, such as %s:, not %s", config_rows[CONFIG_SITE].name,
                              shape_name(key));
            return false;
        }
        if (!take_pair(command, section, text, config_file_node(file, pair->value), values)) return false;
    }
    config_file_at(file, map);
    for (size_t i = 0; i != CONFIG_KEYS; i++) {
        const config_row_t *const row = &config_rows[i];
        if (row->section != section || !row->is_needed || values->at[i] != NULL) continue;
        (void)usage_error(command, "%s%s%s: is missing; it takes %s", section_names[section],
                          section == SECTION_TOP ? "" : " ", row->name, row->takes);
        return false;
    }
    return true;
}

void config_keys_help(FILE *to)
{
    for (section_t section = 0; section != SECTIONS; section++) {
        if (section != SECTION_TOP) (void)fprintf(to, "  %s\n", section_names[section]);
        const char *const indent = section == SECTION_TOP ? "" : "  ";
        for (size_t i = 0; i != CONFIG_KEYS; i++)
            if (config_rows[i].section == section)
                (void)fprintf(to, "  %s%-20s %s\n", indent, config_rows[i].name, config_rows[i].takes);
        for (size_t i = 0; section == SECTION_LINE && i != PORT_KEYS; i++)
            (void)fprintf(to, "  %s%-20s %s\n", indent, port_key_name((port_key_t)i),
                          port_key_takes((port_key_t)i));
    }
}
