/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): fmemopen */
#include "mqtt/discovery.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "fathom/version.h"
#include "output/record.h"

enum { ID = 320 };

#define DEGREES "\xC2\xB0\x43" /* the sign for degrees in UTF-8, and C */

/* template: of the JSON at the topic. If it is null, the value is unknown. */
static const struct {
    const char *component;
    const char *name;
    topic_t topic;
    const char *device_class; /* NULL: none fits */
    const char *unit;
    const char *template;
} entities[ENTITIES] = {
    [ENTITY_DISTANCE] = {"sensor", "distance", TOPIC_STATE, "distance", "mm", "{{ value_json.distance_mm }}"},
    [ENTITY_TEMPERATURE] = {"sensor", "temperature", TOPIC_STATE, "temperature", DEGREES,
                            "{{ value_json.temperature_degc }}"},
    [ENTITY_LEVEL] = {"sensor", "level", TOPIC_LEVEL, "distance", "mm", "{{ value_json.level_mm }}"},
    [ENTITY_FILLED] =
        {"sensor", "filled", TOPIC_LEVEL, NULL, "%",
         "{{ value_json.level_per_mille / 10 if value_json.level_per_mille is number else 'None' }}"},
    [ENTITY_ALARM] = {"binary_sensor", "alarm", TOPIC_ALARM, "problem", NULL,
                      "{{ 'ON' if value_json.is_on else 'OFF' }}"},
};

static uint8_t probe_of(unsigned bit) { return (uint8_t)(bit / ENTITIES + 1); }

static bool has_entity(const sensor_t *sensor, entity_t entity)
{
    if (entity == ENTITY_TEMPERATURE && sensor->settings.temperature_us == 0) return false;
    return topic_is_there(sensor, entities[entity].topic);
}

uint32_t discovery_all(const publish_settings_t *settings, const sensor_t *sensor)
{
    uint32_t bits = 0;
    for (unsigned bit = 0; bit != DISCOVERY_BITS && settings->discovery[0] != '\0'; bit++)
        if (sensor_has_probe(sensor, probe_of(bit)) && has_entity(sensor, bit % ENTITIES))
            bits |= UINT32_C(1) << bit;
    return bits;
}

/* ---- identifiers ---- */

/* Home Assistant allows letters, digits, - and _. */
static void add_id(char id[ID], const char *word)
{
    const size_t before = strlen(id);
    (void)snprintf(id + before, ID - before, "%s%s", before != 0 ? "_" : "", word);
    for (char *at = id + before; *at != '\0'; at++)
        if (*at == '/' || *at == '.') *at = '_';
}

static void device_id(const publish_settings_t *settings, const sensor_t *sensor, char id[ID])
{
    id[0] = '\0';
    add_id(id, settings->prefix);
    add_id(id, settings->site);
    add_id(id, sensor->name);
}

static void entity_id(const publish_settings_t *settings, const sensor_t *sensor, unsigned bit, char id[ID])
{
    char number[4];
    (void)snprintf(number, sizeof number, "%u", probe_of(bit));
    device_id(settings, sensor, id);
    if (topic_has_probes(sensor)) add_id(id, number);
    add_id(id, entities[bit % ENTITIES].name);
}

void discovery_topic(const publish_settings_t *settings, const sensor_t *sensor, unsigned bit,
                     char text[DISCOVERY_TOPIC])
{
    char id[ID];
    entity_id(settings, sensor, bit, id);
    (void)snprintf(text, DISCOVERY_TOPIC, "%s/%s/%s/config", settings->discovery,
                   entities[bit % ENTITIES].component, id);
}

/* ---- messages ---- */

/* A value expires after three intervals and the pause before a port is opened again. */
static uint32_t expire_s(const sensor_t *sensor)
{
    enum { INTERVALS = 3, AWAY_S = 30 };
    return (uint32_t)((uint64_t)INTERVALS * sensor->settings.period_us / 1000000u) + AWAY_S;
}

static void add_availability(const publish_settings_t *settings, const sensor_t *sensor, json_t *json)
{
    char site[TOPIC];
    char availability[TOPIC];
    topic_of_site(settings, "status", site);
    topic_of_sensor(settings, sensor, "availability", availability);
    const char *const topics[] = {site, availability};
    json_begin(json, "availability", '[');
    for (size_t i = 0; i != sizeof topics / sizeof topics[0]; i++) {
        json_begin(json, NULL, '{');
        json_string(json, "topic", topics[i]);
        json_end(json, '}');
    }
    json_end(json, ']');
    json_string(json, "availability_mode", "all");
}

static void add_device(const publish_settings_t *settings, const sensor_t *sensor, json_t *json)
{
    char id[ID];
    char name[TOPIC];
    device_id(settings, sensor, id);
    (void)snprintf(name, sizeof name, "%s %s", settings->site, sensor->name);
    json_begin(json, "device", '{');
    json_begin(json, "identifiers", '[');
    json_string(json, NULL, id);
    json_end(json, ']');
    json_string(json, "name", name);
    json_string(json, "model", sensor->model->name);
    json_end(json, '}');
    json_begin(json, "origin", '{');
    json_string(json, "name", "fathom");
    json_string(json, "sw_version", FATHOM_VERSION_STRING);
    json_end(json, '}');
}

/* A contact reports near or far as words. */
static void add_value(const sensor_t *sensor, entity_t entity, json_t *json)
{
    if (entity == ENTITY_DISTANCE && sensor_is_contact(sensor)) {
        json_string(json, "value_template", "{{ value_json.status }}");
        return;
    }
    json_string(json, "value_template", entities[entity].template);
    if (entities[entity].device_class != NULL)
        json_string(json, "device_class", entities[entity].device_class);
    if (entities[entity].unit == NULL) return;
    json_string(json, "unit_of_measurement", entities[entity].unit);
    json_string(json, "state_class", "measurement");
}

void discovery_payload(const publish_settings_t *settings, const sensor_t *sensor, unsigned bit,
                       char text[DISCOVERY_TEXT])
{
    const entity_t entity = bit % ENTITIES;
    const bool is_word = entity == ENTITY_DISTANCE && sensor_is_contact(sensor);
    char id[ID];
    char topic[TOPIC];
    char name[ID];
    json_t json = {.to = fmemopen(text, DISCOVERY_TEXT, "w")};
    text[0] = '\0';
    if (json.to == NULL) return;
    entity_id(settings, sensor, bit, id);
    topic_of_probe(settings, sensor, probe_of(bit), entities[entity].topic, topic);
    (void)snprintf(name, sizeof name, topic_has_probes(sensor) ? "%s %u" : "%s",
                   is_word ? "contact" : entities[entity].name, probe_of(bit));
    json_begin(&json, NULL, '{');
    json_string(&json, "name", name);
    json_string(&json, "unique_id", id);
    json_string(&json, "state_topic", topic);
    json_value(&json, "qos", "1");
    add_value(sensor, entity, &json);
    /* Only the changes of an alarm are published. */
    if (entity != ENTITY_ALARM) json_value(&json, "expire_after", "%" PRIu32, expire_s(sensor));
    add_availability(settings, sensor, &json);
    add_device(settings, sensor, &json);
    json_end(&json, '}');
    (void)fclose(json.to);
}
