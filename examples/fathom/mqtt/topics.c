/* SPDX-License-Identifier: MIT */
#include "mqtt/topics.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "fathom/version.h"
#include "reading/fields.h"

enum { PATH = 256, ID = 4 * PATH };

#define DEGREES "\xC2\xB0\x43" /* the sign for degrees in UTF-8, and C */

typedef enum { OF_SITE, OF_SENSOR, OF_PROBE } scope_t;

/* The last members are of an entity: which topic has its value, and Home Assistant's words for it. If the value of the
 * template is null, it is unknown. */
static const struct {
    const char *word; /* the last level of the topic, or the name of the entity */
    scope_t scope;
    unsigned columns; /* of a reading */
    topic_kind_t value;
    const char *component; /* NULL: this is no entity */
    const char *device_class;
    const char *unit;
    const char *template;
} rows[TOPICS] = {
    [TOPIC_STATUS] = {.word = "status", .scope = OF_SITE},
    [TOPIC_PUBLISHER] = {.word = "publisher", .scope = OF_SITE},
    [TOPIC_AVAILABILITY] = {.word = "availability", .scope = OF_SENSOR},
    [TOPIC_COUNTERS] = {.word = "counters", .scope = OF_SENSOR},
    [TOPIC_STATE] = {"state", OF_PROBE, .columns = COLUMNS_READING | COLUMNS_DISTANCE | COLUMNS_TEMPERATURE},
    [TOPIC_LEVEL] = {"level", OF_PROBE, .columns = COLUMNS_READING | COLUMNS_LEVEL},
    [TOPIC_ALARM] = {"alarm", OF_PROBE, .columns = COLUMNS_ALARM | COLUMNS_DISTANCE},
    [ENTITY_DISTANCE] = {"distance", OF_PROBE, 0, TOPIC_STATE, "sensor", "distance", "mm",
                         "{{ value_json.distance_mm }}"},
    [ENTITY_TEMPERATURE] = {"temperature", OF_PROBE, 0, TOPIC_STATE, "sensor", "temperature", DEGREES,
                            "{{ value_json.temperature_degc }}"},
    [ENTITY_LEVEL] = {"level", OF_PROBE, 0, TOPIC_LEVEL, "sensor", "distance", "mm",
                      "{{ value_json.level_mm }}"},
    [ENTITY_FILLED] =
        {"filled", OF_PROBE, 0, TOPIC_LEVEL, "sensor", NULL, "%",
         "{{ value_json.level_per_mille / 10 if value_json.level_per_mille is number else 'None' }}"},
    [ENTITY_ALARM] = {"alarm", OF_PROBE, 0, TOPIC_ALARM, "binary_sensor", "problem", NULL,
                      "{{ 'ON' if value_json.is_on else 'OFF' }}"},
};

bool topic_is_entity(topic_kind_t kind) { return rows[kind].component != NULL; }

bool topic_is_retained(topic_kind_t kind) { return (rows[kind].columns & COLUMNS_READING) == 0; }

bool topic_has_probes(const sensor_t *sensor)
{
    return sensor->model->probes > 1 && !sensor_is_contact(sensor);
}

bool topic_is_there(const publish_settings_t *settings, topic_kind_t kind, const sensor_t *sensor,
                    uint8_t probe)
{
    const scope_t scope = sensor == NULL ? OF_SITE : probe == 0 ? OF_SENSOR : OF_PROBE;
    const topic_kind_t value = topic_is_entity(kind) ? rows[kind].value : kind;
    if (scope != rows[kind].scope || (scope == OF_PROBE && !sensor_has_probe(sensor, probe))) return false;
    if (topic_is_entity(kind) && settings->discovery[0] == '\0') return false;
    if (kind == ENTITY_TEMPERATURE) return sensor->settings.temperature_us != 0;
    if (value == TOPIC_LEVEL) return sensor->processing.has_level;
    return value != TOPIC_ALARM || sensor->processing.has_alarm;
}

unsigned topic_columns(topic_kind_t kind, const sensor_t *sensor)
{
    return rows[kind].columns & ~(sensor->settings.temperature_us == 0 ? COLUMNS_TEMPERATURE : 0u);
}

/* ---- names ---- */

/* The levels down to `word`, or to the sensor if it is NULL. */
static const char *print_path(char path[PATH], const publish_settings_t *settings, const sensor_t *sensor,
                              uint8_t probe, const char *word)
{
    int length = snprintf(path, PATH, "%s/%s", settings->prefix, settings->site);
    if (sensor != NULL) length += snprintf(path + length, PATH - (size_t)length, "/%s", sensor->name);
    if (probe != 0 && topic_has_probes(sensor))
        length += snprintf(path + length, PATH - (size_t)length, "/%u", probe);
    if (word != NULL) (void)snprintf(path + length, PATH - (size_t)length, "/%s", word);
    return path;
}

/* Makes an identifier of a path, of the characters that Home Assistant allows: letters, digits, - and _. Two paths have two
 * identifiers: / becomes _, and any other character two of _ and its hexadecimal number. No level of a path is empty, so __
 * stands for no other one, and of three of _ the first is a /. */
static const char *print_id(char id[ID], const publish_settings_t *settings, const sensor_t *sensor,
                            uint8_t probe, const char *word)
{
    char path[PATH];
    char *to = id;
    (void)print_path(path, settings, sensor, probe, word);
    for (const char *at = path; *at != '\0'; at++) {
        if (*at == '/')
            *to++ = '_';
        else if (*at != '_' && *at != '.')
            *to++ = *at;
        else
            to += snprintf(to, sizeof "__5f", "__%02x", (unsigned)*at);
    }
    *to = '\0';
    return id;
}

void topic_name(const publish_settings_t *settings, topic_kind_t kind, const sensor_t *sensor, uint8_t probe,
                char name[TOPIC_NAME])
{
    char path[ID];
    if (topic_is_entity(kind))
        (void)snprintf(name, TOPIC_NAME, "%s/%s/%s/config", settings->discovery, rows[kind].component,
                       print_id(path, settings, sensor, probe, rows[kind].word));
    else
        (void)snprintf(name, TOPIC_NAME, "%s", print_path(path, settings, sensor, probe, rows[kind].word));
}

/* ---- what an earlier run left ---- */

/* A discovery prefix of several levels has its own filters; those of one level share one. */
bool topic_filter(const publish_settings_t *settings, unsigned number, char name[TOPIC_NAME])
{
    enum { OWN = 4, ENTITIES = 2 };
    static const char *const filters[] = {"counters", "availability", "alarm",
                                          "+/alarm",  "sensor",       "binary_sensor"};
    const bool has_levels = strchr(settings->discovery, '/') != NULL;
    if (number < OWN)
        (void)snprintf(name, TOPIC_NAME, "%s/%s/+/%s", settings->prefix, settings->site, filters[number]);
    else
        (void)snprintf(name, TOPIC_NAME, "%s/%s/+/config",
                       number < OWN + ENTITIES ? "+" : settings->discovery, filters[OWN + number % ENTITIES]);
    return number < OWN + ENTITIES || (has_levels && number < OWN + 2 * ENTITIES);
}

/* An entity of this site has its status first. What stands behind it shows which program sent it. */
static bool is_entity_of_site(const publish_settings_t *settings, const char *payload)
{
    char path[PATH];
    char text[2 * PATH];
    (void)snprintf(text, sizeof text, "\"availability\":[{\"topic\":\"%s\"}",
                   print_path(path, settings, NULL, 0, rows[TOPIC_STATUS].word));
    return strstr(payload, text) != NULL && strstr(payload, "\"origin\":{\"name\":\"fathom\"") != NULL;
}

topic_kind_t topic_of_site(const publish_settings_t *settings, const char *name, const char *payload,
                           char counters[TOPIC_NAME])
{
    char path[PATH];
    const char *const word = strrchr(name, '/');
    const size_t site = strlen(print_path(path, settings, NULL, 0, NULL));
    if (word == NULL) return TOPICS;
    if (strcmp(word, "/config") == 0) return is_entity_of_site(settings, payload) ? ENTITY_DISTANCE : TOPICS;
    if (strncmp(name, path, site) != 0 || name[site] != '/') return TOPICS;
    const size_t sensor = site + 1 + strcspn(name + site + 1, "/");
    const bool is_of_sensor = word == name + sensor;
    const bool is_of_probe =
        word == name + sensor + 2 && name[sensor + 1] >= '1' && name[sensor + 1] <= '0' + FATHOM_DYP_PROBES;
    (void)snprintf(counters, TOPIC_NAME, "%.*s/%s", (int)sensor, name, rows[TOPIC_COUNTERS].word);
    if (is_of_sensor && strcmp(word, "/availability") == 0)
        return strcmp(payload, "online") == 0 || strcmp(payload, "offline") == 0 ? TOPIC_AVAILABILITY
                                                                                 : TOPICS;
    if (strstr(payload, "\"boot\":\"") == NULL) return TOPICS;
    if (is_of_sensor && strcmp(word, "/counters") == 0) return TOPIC_COUNTERS;
    return (is_of_sensor || is_of_probe) && strcmp(word, "/alarm") == 0 ? TOPIC_ALARM : TOPICS;
}

/* ---- discovery messages ---- */

/* A value expires after three intervals and the pause before a port is opened again. */
static uint32_t expire_s(const sensor_t *sensor)
{
    enum { INTERVALS = 3, AWAY_S = 30 };
    return (uint32_t)((uint64_t)INTERVALS * sensor->settings.period_us / 1000000u) + AWAY_S;
}

static void add_availability(json_t *json, const publish_settings_t *settings, const sensor_t *sensor)
{
    char path[PATH];
    json_begin(json, "availability", '[');
    json_begin(json, NULL, '{');
    json_string(json, "topic", print_path(path, settings, NULL, 0, rows[TOPIC_STATUS].word));
    json_end(json, '}');
    json_begin(json, NULL, '{');
    json_string(json, "topic", print_path(path, settings, sensor, 0, rows[TOPIC_AVAILABILITY].word));
    json_end(json, '}');
    json_end(json, ']');
    json_string(json, "availability_mode", "all");
}

static void add_device(json_t *json, const publish_settings_t *settings, const sensor_t *sensor)
{
    char text[ID];
    json_begin(json, "device", '{');
    json_begin(json, "identifiers", '[');
    json_string(json, NULL, print_id(text, settings, sensor, 0, NULL));
    json_end(json, ']');
    (void)snprintf(text, sizeof text, "%s %s", settings->site, sensor->name);
    json_string(json, "name", text);
    json_string(json, "model", sensor->model->name);
    json_end(json, '}');
    json_begin(json, "origin", '{');
    json_string(json, "name", "fathom");
    json_string(json, "sw_version", FATHOM_VERSION_STRING);
    json_end(json, '}');
}

void topic_json_entity(json_t *json, const publish_settings_t *settings, topic_kind_t kind,
                       const sensor_t *sensor, uint8_t probe)
{
    /* A contact reports near or far as words. */
    const bool is_word = kind == ENTITY_DISTANCE && sensor_is_contact(sensor);
    char text[ID];
    (void)snprintf(text, sizeof text, topic_has_probes(sensor) ? "%s %u" : "%s",
                   is_word ? "contact" : rows[kind].word, probe);
    json_string(json, "name", text);
    json_string(json, "unique_id", print_id(text, settings, sensor, probe, rows[kind].word));
    json_string(json, "state_topic", print_path(text, settings, sensor, probe, rows[rows[kind].value].word));
    json_value(json, "qos", "1");
    json_string(json, "value_template", is_word ? "{{ value_json.status }}" : rows[kind].template);
    if (rows[kind].device_class != NULL && !is_word)
        json_string(json, "device_class", rows[kind].device_class);
    if (rows[kind].unit != NULL && !is_word) {
        json_string(json, "unit_of_measurement", rows[kind].unit);
        json_string(json, "state_class", "measurement");
    }
    /* Only the changes of an alarm are published. */
    if (kind != ENTITY_ALARM) json_value(json, "expire_after", "%" PRIu32, expire_s(sensor));
    add_availability(json, settings, sensor);
    add_device(json, settings, sensor);
}
