/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): strdup */
#include <stdlib.h>
#include <string.h>

#include "cli/command.h"
#include "cli/config.h"
#include "cli/options.h"

/* The sensors of a configuration file. Each becomes the word and the options that `fathom read` would take it by, and is
 * read by the same functions. */

enum { WORD = 640, PAIRS = 1024 };

typedef struct {
    site_t *site;
    config_file_t *file;
    const char *command;
    const config_values_t *top;
    config_values_t line; /* the present one */
    size_t word_count;
    char *words[MAX_SENSORS];
    unsigned lines[MAX_SENSORS];
    config_values_t *values; /* of each sensor */
} sensors_t;

/* ---- the word ---- */

static bool add_port_keys(sensors_t *sensors, char *word, size_t capacity)
{
    const char *const port = config_file_text(sensors->line.at[LINE_PORT]);
    const option_t *const rows = port_path_has_pins(port) ? chip_keys : serial_keys;
    for (size_t i = 0; i != PORT_KEYS; i++) {
        const yaml_node_t *const node = sensors->line.port_keys[i];
        port_keys_t keys = {{0}, {false}};
        char pair[WORD / 8];
        if (node == NULL) continue;
        config_file_at(sensors->file, node);
        const int length =
            snprintf(pair, sizeof pair, "%s=%s", port_key_name((port_key_t)i), config_file_text(node));
        if (length >= (int)sizeof pair || strchr(pair, ',') != NULL) {
            (void)usage_error(sensors->command, "%s: takes %s", port_key_name((port_key_t)i),
                              port_key_takes((port_key_t)i));
            return false;
        }
        /* Here it stands in its own line. */
        char copy[WORD / 8];
        const origin_t origin = usage_origin(sensors->command, 0);
        memcpy(copy, pair, sizeof copy);
        if (port_path_has_gateway(port))
            return reject(&origin, "%s has no keys, for it is a port over TCP. Set the line in the gateway.",
                          port);
        if (!option_set_keys(rows, copy, &keys, &origin)) return false;
        const size_t before = strlen(word);
        (void)snprintf(word + before, capacity - before, ",%s", pair);
    }
    return true;
}

static bool check_port(const sensors_t *sensors)
{
    const yaml_node_t *const node = sensors->line.at[LINE_PORT];
    const char *const port = config_file_text(node);
    config_file_at(sensors->file, node);
    if (port_path_has_keys(port))
        (void)usage_error(sensors->command, "port: keys stand in lines of their own, such as baud: 9600");
    else if (strchr(port, ',') != NULL || strlen(port) > WORD / 2)
        (void)usage_error(sensors->command, "port: takes a path of up to %d bytes without a comma", WORD / 2);
    else
        return true;
    return false;
}

static bool check_word(const sensors_t *sensors, const config_values_t *values)
{
    const char *const sensor = config_file_text(values->at[SENSOR_SENSOR]);
    const char *const name = config_file_text(values->at[SENSOR_NAME]);
    config_file_at(sensors->file, values->at[SENSOR_SENSOR]);
    if (strpbrk(sensor, "@=") != NULL || strlen(sensor) > WORD / 8) {
        (void)usage_error(sensors->command, "sensor: takes %s; its name and its port have keys of their own",
                          config_rows[SENSOR_SENSOR].takes);
        return false;
    }
    config_file_at(sensors->file, values->at[SENSOR_NAME]);
    if (sensor_name_is_good(name, strlen(name))) return true;
    (void)usage_error(sensors->command, "name: takes %s, the first a letter or digit; not '%.60s'",
                      config_rows[SENSOR_NAME].takes, name);
    return false;
}

/* NAME=SENSOR@PORT,key=value */
static bool add_word(sensors_t *sensors, const config_values_t *values)
{
    if (!check_word(sensors, values)) return false;
    char *const word = malloc(WORD);
    if (word == NULL) {
        (void)usage_error(sensors->command, "there is no memory left");
        return false;
    }
    const size_t number = sensors->word_count++;
    sensors->words[number] = word;
    sensors->lines[number] = config_file_line(values->at[SENSOR_SENSOR]);
    sensors->values[number] = *values;
    (void)snprintf(word, WORD, "%s=%s@%s", config_file_text(values->at[SENSOR_NAME]),
                   config_file_text(values->at[SENSOR_SENSOR]),
                   config_file_text(sensors->line.at[LINE_PORT]));
    return add_port_keys(sensors, word, WORD);
}

static bool add_sensor(sensors_t *sensors, const yaml_node_t *map)
{
    config_values_t values;
    if (!config_take(sensors->file, sensors->command, map, SECTION_SENSOR, &values)) return false;
    if (sensors->word_count != MAX_SENSORS) return add_word(sensors, &values);
    config_file_at(sensors->file, map);
    (void)usage_error(sensors->command, "up to %d sensors may be named; this is one more", MAX_SENSORS);
    return false;
}

static bool add_line(sensors_t *sensors, const yaml_node_t *map)
{
    if (!config_take(sensors->file, sensors->command, map, SECTION_LINE, &sensors->line)) return false;
    if (!check_port(sensors)) return false;
    const yaml_node_t *const list = sensors->line.at[LINE_SENSORS];
    for (const int *item = list->data.sequence.items.start; item != list->data.sequence.items.top; item++)
        if (!add_sensor(sensors, config_file_node(sensors->file, *item))) return false;
    return true;
}

/* ---- its options ---- */

/* Which key says which option; of those that go for all, where it stands for them. */
static const struct {
    config_key_t key;
    config_key_t of_all;
    int option; /* -1: --temperature, which is in no common table */
    const char *otherwise;
} options[] = {
    {SENSOR_INTERVAL, CONFIG_INTERVAL, OPTION_INTERVAL, "1000"},
    {SENSOR_TIMEOUT, CONFIG_TIMEOUT, OPTION_TIMEOUT, NULL},
    {SENSOR_RETRIES, CONFIG_RETRIES, OPTION_RETRIES, NULL},
    {SENSOR_VALUE, CONFIG_KEYS, OPTION_VALUE, NULL},
    {SENSOR_PROBES, CONFIG_KEYS, OPTION_PROBES, NULL},
    {SENSOR_FIRST_REGISTER, CONFIG_KEYS, OPTION_FIRST_REGISTER, NULL},
    {SENSOR_WINDOW, CONFIG_KEYS, OPTION_WINDOW, NULL},
    {SENSOR_MEANS, CONFIG_KEYS, OPTION_MEANS, NULL},
    {SENSOR_TEMPERATURE, CONFIG_KEYS, -1, NULL},
    {SENSOR_MEDIAN, CONFIG_KEYS, OPTION_MEDIAN, NULL},
    {SENSOR_GATE, CONFIG_KEYS, OPTION_GATE, NULL},
    {SENSOR_LEVEL, CONFIG_KEYS, OPTION_LEVEL, NULL},
    {SENSOR_ALARM, CONFIG_KEYS, OPTION_ALARM, NULL},
};
enum { OPTIONS = sizeof options / sizeof options[0] };

/* "key=value,key=value" of a map; the threshold of an alarm comes first, without its key. False after a usage error. */
static bool join(const sensors_t *sensors, const yaml_node_t *map, const char *name, char text[PAIRS])
{
    char rest[PAIRS] = "";
    text[0] = '\0';
    for (const yaml_node_pair_t *pair = map->data.mapping.pairs.start; pair != map->data.mapping.pairs.top;
         pair++) {
        const yaml_node_t *const key_node = config_file_node(sensors->file, pair->key);
        const char *const key = config_file_text(key_node);
        const char *const value = config_file_text(config_file_node(sensors->file, pair->value));
        const size_t length = strlen(rest);
        config_file_at(sensors->file, key_node);
        if (key == NULL || value == NULL || strpbrk(value, ",=") != NULL || strpbrk(key, ",=") != NULL ||
            length + strlen(key) + strlen(value) + 3 > PAIRS) {
            (void)usage_error(sensors->command, "%s: takes a key and a text in each line, such as %s", name,
                              strcmp(name, "alarm") == 0 ? "when: near<500/600" : "height: 2000");
            return false;
        }
        if (strcmp(name, "alarm") == 0 && strcmp(key, "when") == 0)
            (void)snprintf(text, PAIRS, "%s", value);
        else
            (void)snprintf(rest + length, PAIRS - length, ",%s=%s", key, value);
    }
    const size_t length = strlen(text);
    (void)snprintf(text + length, PAIRS - length, "%s", rest + (length == 0 && rest[0] == ',' ? 1 : 0));
    config_file_at(sensors->file, map);
    return true;
}

/* What the file says of an option for this sensor; NULL: nothing. */
static const yaml_node_t *node_of(const sensors_t *sensors, const config_values_t *own, size_t option)
{
    const config_key_t of_all = options[option].of_all;
    const yaml_node_t *const node = own->at[options[option].key];
    return node == NULL && of_all != CONFIG_KEYS ? sensors->top->at[of_all] : node;
}

typedef struct {
    const sensors_t *sensors;
    const config_values_t *own;
} place_t;

static unsigned line_of(const void *ctx, const char *option, size_t length)
{
    const place_t *const place = ctx;
    for (size_t i = 0; i != OPTIONS; i++) {
        const char *const name = config_rows[options[i].key].name;
        const yaml_node_t *const node = node_of(place->sensors, place->own, i);
        if (node != NULL && strlen(name) == length && strncmp(name, option, length) == 0)
            return config_file_line(node);
    }
    return 0;
}

static bool take_text(const sensors_t *sensors, const char *name, const yaml_node_t *node, char text[PAIRS])
{
    config_file_at(sensors->file, node);
    if (node->type == YAML_MAPPING_NODE) return join(sensors, node, name, text);
    if (snprintf(text, PAIRS, "%s", config_file_text(node)) < PAIRS) return true;
    (void)usage_error(sensors->command, "%s: takes %d characters at most", name, PAIRS - 1);
    return false;
}

/* Two lines with the same text are the same: what a sensor is, and every value that the file has for it. */
static bool add_line_text(const sensors_t *sensors, sensor_t *sensor, const char *name, const char *text)
{
    line_t *line = sensors->site->lines;
    while (&line->settings != sensor->port) line = line->next;
    if (line_add_text(line, name) && line_add_text(line, "=") && line_add_text(line, text) &&
        line_add_text(line, "\n"))
        return true;
    (void)usage_error(sensors->command, "there is no memory left");
    return false;
}

static bool take_options(const sensors_t *sensors, size_t number)
{
    static char texts[OPTIONS][PAIRS]; /* too large for a small stack */
    const char *values[RESULT_OPTIONS] = {NULL};
    const char *temperature = NULL;
    sensor_t *const *const station = &sensors->site->sensors[number];
    results_config_t *const results = &(*station)->processing;
    const place_t place = {sensors, &sensors->values[number]};
    const usage_place_t lines = {sensors->file->path, sensors->lines[number], NULL, line_of, &place};
    for (size_t i = 0; i != OPTIONS; i++) {
        const yaml_node_t *const node = node_of(sensors, place.own, i);
        const char **const value = options[i].option >= 0 ? &values[options[i].option] : &temperature;
        *value = node != NULL ? texts[i] : options[i].otherwise;
        if (node != NULL && !take_text(sensors, config_rows[options[i].key].name, node, texts[i]))
            return false;
        if (*value != NULL && !add_line_text(sensors, *station, config_rows[options[i].key].name, *value))
            return false;
    }
    usage_at(&lines);
    results->has_readings = true;
    return station_options(station, 1, sensors->command, values) &&
           reading_options(station, 1, sensors->command, values) &&
           temperature_option(station, 1, sensors->command, temperature) &&
           result_options(results, (*station)->settings.period_us, sensors->command, values);
}

/* The word of each sensor, as it is before sensor_options() cuts it, and its options. */
static bool describe_lines(const sensors_t *sensors, char *const *texts)
{
    for (size_t i = 0; i != sensors->word_count; i++)
        if (!add_line_text(sensors, sensors->site->sensors[i], "sensor", texts[i]) ||
            !take_options(sensors, i))
            return false;
    return true;
}

static bool take_sensors(sensors_t *sensors)
{
    static const char *const none[SENSOR_OPTIONS];
    site_t *const site = sensors->site;
    const usage_place_t lines = {.file = sensors->file->path, .lines = sensors->lines};
    char *texts[MAX_SENSORS];
    bool is_good = true;
    for (size_t i = 0; i != sensors->word_count; i++) {
        texts[i] = strdup(sensors->words[i]);
        if (texts[i] == NULL) is_good = false;
    }
    usage_at(&lines);
    is_good =
        is_good &&
        sensor_options(site, sensors->command, sensors->words, (int)sensors->word_count, none, NULL, NULL) &&
        describe_lines(sensors, texts);
    for (size_t i = 0; i != sensors->word_count; i++) free(texts[i]);
    site->reconnect = true;
    site->persists = true;
    return is_good;
}

bool config_sensors(site_t *site, config_file_t *file, const char *command, const config_values_t *top)
{
    sensors_t sensors = {.site = site, .file = file, .command = command, .top = top};
    const yaml_node_t *const list = top->at[CONFIG_LINES];
    sensors.values = calloc(MAX_SENSORS, sizeof *sensors.values);
    bool is_good = sensors.values != NULL;
    for (const int *item = list->data.sequence.items.start; is_good && item != list->data.sequence.items.top;
         item++)
        is_good = add_line(&sensors, config_file_node(file, *item));
    if (is_good && sensors.word_count == 0) {
        config_file_at(file, list);
        (void)usage_error(command, "lines: no sensor is named here; it takes %s",
                          config_rows[CONFIG_LINES].takes);
        is_good = false;
    }
    is_good = is_good && take_sensors(&sensors);
    for (size_t i = 0; i != sensors.word_count; i++) free(sensors.words[i]);
    free(sensors.values);
    return is_good;
}
