/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): gethostname */
#include "cli/config.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/config_file.h"
#include "cli/publish_rows.h"

enum { PORT = 1883, PORT_WITH_TLS = 8883, KEEP_ALIVE_S = 30, MESSAGES = 10000, BYTES = 4194304 };
enum { INTERVAL_US = 1000000, SENSOR_TEXT = 2048 };

/* A sensor of the file. */
typedef struct {
    publish_sensor_t settings;
    char text
        [SENSOR_TEXT]; /* everything that the file has for it: two sensors with the same text are the same */
} entry_t;

typedef struct {
    config_file_t file;
    publish_top_t top;
    entry_t *entries; /* MAX_SENSORS of each */
    sensor_word_t *words;
    int count;
} config_t;

/* ---- the broker ---- */

/* systemd passes credentials as files in a folder. */
static bool set_credential(const config_t *config, broker_settings_t *broker, const origin_t *origin)
{
    const char *const name = config->top.broker.credential;
    const char *const folder =
        getenv("CREDENTIALS_DIRECTORY"); /* NOLINT(concurrency-mt-unsafe): one thread */
    if (name[0] == '\0') return true;
    if (broker->password_file[0] != '\0')
        return reject(origin,
                      "password-credential and password-file name two passwords. Leave one of them out.");
    if (folder == NULL)
        return reject(origin,
                      "password-credential: CREDENTIALS_DIRECTORY is not set. The unit needs a line "
                      "LoadCredential=%s:/path/to/the/password.",
                      name);
    if (snprintf(broker->password_file, SETTINGS_PATH, "%s/%s", folder, name) < SETTINGS_PATH &&
        access(broker->password_file, R_OK) == 0)
        return true;
    return reject(origin,
                  "password-credential: cannot read %s: %s. The unit needs a line "
                  "LoadCredential=%s:/path/to/the/password.",
                  broker->password_file, strerror(errno), name);
}

/* A broker knows a client by its id: of two with the same id, each would end the connection of the other. */
static void set_client_id(const publish_settings_t *settings, char id[SETTINGS_NAME])
{
    (void)snprintf(id, SETTINGS_NAME, "%.49s-%.49s", settings->prefix, settings->site);
    for (char *at = id; *at != '\0'; at++)
        if (*at == '/' || *at == '.') *at = '-';
}

/* The line of the first of two keys that is there. */
static unsigned line_of(config_t *config, const yaml_node_t *map, const char *key, const char *other)
{
    const yaml_node_t *const node = config_file_find(&config->file, map, key);
    const yaml_node_t *const second = config_file_find(&config->file, map, other);
    if (node == NULL && second == NULL) return config_file_at(&config->file, map).line;
    return config_file_at(&config->file, node != NULL ? node : second).line;
}

static bool set_broker(config_t *config, publish_settings_t *settings)
{
    const yaml_node_t *const map = config_file_find(&config->file, config_file_top(&config->file), "broker");
    const yaml_node_t *const tls = config_file_find(&config->file, map, "tls");
    broker_settings_t *const broker = &settings->broker;
    *broker = config->top.broker.settings;
    broker->line = line_of(config, map, "user", "host");
    if (tls != NULL) broker->tls_line = line_of(config, tls, "ca-file", "ca-file");
    if (broker->port == 0) broker->port = broker->has_tls ? PORT_WITH_TLS : PORT;
    if (broker->keep_alive_s == 0) broker->keep_alive_s = KEEP_ALIVE_S;
    if (broker->client_id[0] == '\0') set_client_id(settings, broker->client_id);
    origin_t origin = config->file.origin;
    origin.line = line_of(config, map, "password-credential", "password-file");
    if (!set_credential(config, broker, &origin)) return false;
    return broker->password_file[0] == '\0' || broker->user[0] != '\0' ||
           reject(&origin, "there is a password, but no user beside it.");
}

/* ---- names ---- */

static bool set_site(config_t *config, char site[SETTINGS_NAME])
{
    char host[SETTINGS_NAME] = "";
    memcpy(site, config->top.site, SETTINGS_NAME);
    if (site[0] != '\0') return true;
    if (gethostname(host, sizeof host - 1) == 0 && topic_name_is_good(host, true)) {
        memcpy(site, host, SETTINGS_NAME);
        return true;
    }
    return reject(&config->file.origin, "site is missing, and the host's name '%s' cannot be used.", host);
}

static bool set_names(config_t *config, publish_settings_t *settings)
{
    const publish_top_t *const top = &config->top;
    (void)snprintf(settings->prefix, SETTINGS_NAME, "%s", top->prefix[0] != '\0' ? top->prefix : "fathom");
    (void)snprintf(settings->discovery, SETTINGS_NAME, "%s",
                   top->discovery[0] != '\0' ? top->discovery : "homeassistant");
    if (strcmp(settings->discovery, "off") == 0) settings->discovery[0] = '\0';
    settings->queue_messages = top->queue_messages != 0 ? top->queue_messages : MESSAGES;
    settings->queue_bytes = top->queue_bytes != 0 ? top->queue_bytes : BYTES;
    return set_site(config, settings->site);
}

/* ---- lines and sensors ---- */

/* Everything that the file has for a sensor: of its line, of itself, and of all sensors. */
static bool print_entry(config_t *config, entry_t *entry, const yaml_node_t *line, const yaml_node_t *map)
{
    const reader_settings_t *const reader = &entry->settings.reader;
    const origin_t origin = config_file_at(&config->file, map);
    (void)snprintf(entry->text, sizeof entry->text, "%u %u %u ", (unsigned)reader->period_us,
                   (unsigned)reader->timeout_us, reader->retries);
    return (config_file_print(&config->file, line, entry->text, sizeof entry->text - 1) &&
            config_file_print(&config->file, map, entry->text, sizeof entry->text - 1)) ||
           reject(&origin, "this sensor has more than %d characters.", SENSOR_TEXT);
}

static bool read_sensor(config_t *config, const publish_line_t *line, const yaml_node_t *line_map,
                        const yaml_node_t *map)
{
    origin_t origin = config_file_at(&config->file, map);
    if (config->count == MAX_SENSORS)
        return reject(&origin, "this is sensor %d. At most %d can be named.", MAX_SENSORS + 1, MAX_SENSORS);
    entry_t *const entry = &config->entries[config->count];
    publish_sensor_t *const sensor = &entry->settings;
    sensor_word_t *const word = &config->words[config->count];
    sensor->reader = config->top.reader;
    sensor->results.has_readings = true;
    if (!print_entry(config, entry, line_map, map) ||
        !config_file_read(&config->file, map, publish_sensor_tables, sensor, "sensors", &sensor->given))
        return false;
    origin = config_file_at(&config->file, config_file_find(&config->file, map, "sensor"));
    config->count++;
    if (strpbrk(sensor->sensor, "@=") != NULL)
        return reject(&origin, "sensor is '%s'. Write its name and its port in keys of their own.",
                      sensor->sensor);
    if (!sensor_word_parse(word, sensor->sensor, &origin)) return false;
    word->port = line->port;
    word->keys = line->keys;
    if (sensor_name_is_good(sensor->name, strlen(sensor->name))) {
        (void)snprintf(word->name, sizeof word->name, "%s", sensor->name);
        return true;
    }
    origin = config_file_at(&config->file, config_file_find(&config->file, map, "name"));
    return reject(&origin,
                  "name is '%s'. It takes at most %d letters, digits, '-', '_' and '.', the first a "
                  "letter or a digit.",
                  sensor->name, SENSOR_NAME_SIZE - 1);
}

static bool read_line(config_t *config, const yaml_node_t *map)
{
    const yaml_node_t *const node = config_file_find(&config->file, map, "port");
    const char *const port =
        node != NULL && node->type == YAML_SCALAR_NODE ? (const char *)node->data.scalar.value : "";
    static const option_t none[] = {{.name = NULL}};
    const option_table_t tables[] = {
        {publish_line_keys, 0},
        {port_path_has_gateway(port) ? none : (port_path_has_pins(port) ? chip_keys : serial_keys),
         offsetof(publish_line_t, keys)},
        {NULL, 0}};
    publish_line_t line = {.port = NULL};
    option_given_t given = {{0}};
    if (!config_file_read(&config->file, map, tables, &line, "lines", &given)) return false;
    if (strchr(line.port, ',') != NULL) {
        const origin_t origin = config_file_at(&config->file, node);
        return reject(&origin, "port is '%s'. Write keys in lines of their own, such as baud: 9600.",
                      line.port);
    }
    const yaml_node_t *const list = line.sensors;
    for (const int *item = list->data.sequence.items.start; item != list->data.sequence.items.top; item++)
        if (!read_sensor(config, &line, map, config_file_node(&config->file, *item))) return false;
    return true;
}

/* Fills the site's sensors with what the file has for each. */
static bool fill_sensors(const config_t *config, site_t *site)
{
    for (size_t i = 0; i != site->sensor_count; i++) {
        sensor_t *const sensor = site->sensors[i];
        publish_sensor_t *const from = &config->entries[i].settings;
        line_t *line = site->lines;
        sensor->settings = from->reader;
        if (!options_suit(publish_sensor_tables, &from->given, &sensor, 1, true, &config->words[i].origin) ||
            !results_finish(&from->results, from->reader.period_us, &config->words[i].origin))
            return false;
        results_config_copy(&sensor->processing, &from->results);
        while (&line->settings != sensor->port) line = line->next;
        if (!line_add_text(line, config->entries[i].text) || !line_add_text(line, "\n"))
            return reject(&config->words[i].origin, "no memory is left.");
    }
    site->reconnect = true;
    site->persists = true;
    return true;
}

static bool read_sensors(config_t *config, site_t *site)
{
    static const sensor_defaults_t none;
    const yaml_node_t *const list = config->top.lines;
    for (const int *item = list->data.sequence.items.start; item != list->data.sequence.items.top; item++)
        if (!read_line(config, config_file_node(&config->file, *item))) return false;
    const origin_t origin = config_file_at(&config->file, list);
    if (config->count == 0) return reject(&origin, "lines names no sensor.");
    return sensors_add(site, &none, config->words, config->count) && fill_sensors(config, site);
}

/* ---- all of it ---- */

static bool read_file(config_t *config, publish_settings_t *settings, site_t *site)
{
    const yaml_node_t *const top = config_file_top(&config->file);
    option_given_t given = {{0}};
    if (top == NULL)
        return reject(&config->file.origin, "the file is empty. It takes at least broker and lines.");
    config->top.reader.period_us = INTERVAL_US;
    return config_file_read(&config->file, top, publish_top_tables, &config->top, NULL, &given) &&
           set_names(config, settings) && set_broker(config, settings) && read_sensors(config, site);
}

bool config_load(publish_settings_t *settings, site_t *site, const char *command, const char *path)
{
    const origin_t origin = {.command = command};
    bool is_good = false;
    memset(settings, 0, sizeof *settings);
    if (strlen(path) >= sizeof settings->path) return reject(&origin, "the path of the file is too long.");
    memcpy(settings->path, path, strlen(path) + 1);
    config_t *const config = calloc(1, sizeof *config);
    if (config == NULL) return reject(&origin, "no memory is left.");
    config->entries = calloc(MAX_SENSORS, sizeof *config->entries);
    config->words = calloc(MAX_SENSORS, sizeof *config->words);
    if (config->entries == NULL || config->words == NULL) {
        (void)reject(&origin, "no memory is left.");
    } else if (config_file_load(&config->file, command, settings->path)) {
        is_good = read_file(config, settings, site);
        config_file_free(&config->file);
    }
    if (!is_good) site_free(site);
    free(config->entries);
    free(config->words);
    free(config);
    return is_good;
}
