/* SPDX-License-Identifier: MIT */
#include "mqtt/discovery.h"

#include <inttypes.h>
#include <string.h>

#include "fathom/version.h"
#include "mqtt/text.h"

#define ADD(text, ...) text_add(text, DISCOVERY_TEXT, __VA_ARGS__)

enum { ID = 320 };

#define DEGREES "\xC2\xB0\x43" /* the sign for degrees in UTF-8, and C */

/* template: of what the topic tells. Where it is null, Home Assistant knows no value. */
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

static bool is_contact(const station_t *station) { return (station->mode->pins & MODEL_PIN_IN) != 0; }

static bool has_entity(const station_t *station, const results_config_t *results, entity_t entity)
{
    if (entity == ENTITY_TEMPERATURE && station->settings.temperature_us == 0) return false;
    return topic_is_there(results, entities[entity].topic);
}

uint32_t discovery_all(const config_t *config, const station_t *station, const results_config_t *results)
{
    uint32_t bits = 0;
    for (unsigned bit = 0; bit != DISCOVERY_BITS && config->discovery[0] != '\0'; bit++)
        if (topic_wants_probe(station, probe_of(bit)) && has_entity(station, results, bit % ENTITIES))
            bits |= UINT32_C(1) << bit;
    return bits;
}

/* ---- what they are called ---- */

/* Of letters, digits, - and _ alone, as Home Assistant wants it. */
static void add_id(char id[ID], const char *word)
{
    const size_t before = strlen(id);
    text_add(id, ID, "%s%s", before != 0 ? "_" : "", word);
    for (char *at = id + before; *at != '\0'; at++)
        if (*at == '/' || *at == '.') *at = '_';
}

static void device_id(const config_t *config, const station_t *station, char id[ID])
{
    id[0] = '\0';
    add_id(id, config->prefix);
    add_id(id, config->site);
    add_id(id, station->name);
}

static void entity_id(const config_t *config, const station_t *station, unsigned bit, char id[ID])
{
    char number[4];
    (void)snprintf(number, sizeof number, "%u", probe_of(bit));
    device_id(config, station, id);
    if (topic_has_probes(station)) add_id(id, number);
    add_id(id, entities[bit % ENTITIES].name);
}

void discovery_topic(const config_t *config, const station_t *station, unsigned bit,
                     char text[DISCOVERY_TOPIC])
{
    char id[ID];
    entity_id(config, station, bit, id);
    (void)snprintf(text, DISCOVERY_TOPIC, "%s/%s/%s/config", config->discovery,
                   entities[bit % ENTITIES].component, id);
}

/* ---- what they are ---- */

/* A value that does not come for so long is none any more: three intervals, and the pause before a port is tried again. */
static uint32_t expire_s(const station_t *station)
{
    enum { INTERVALS = 3, AWAY_S = 30 };
    return (uint32_t)((uint64_t)INTERVALS * station->settings.period_us / 1000000u) + AWAY_S;
}

static void add_availability(const config_t *config, const station_t *station, char *text)
{
    char site[TOPIC];
    char sensor[TOPIC];
    topic_of_site(config, "status", site);
    topic_of_sensor(config, station, "availability", sensor);
    ADD(text, ",\"availability\":[{\"topic\":\"%s\"},{\"topic\":\"%s\"}],\"availability_mode\":\"all\"", site,
        sensor);
}

static void add_device(const config_t *config, const station_t *station, char *text)
{
    char id[ID];
    device_id(config, station, id);
    ADD(text, ",\"device\":{\"identifiers\":[\"%s\"],\"name\":\"%s %s\",\"model\":\"%s\"}", id, config->site,
        station->name, station->model->name);
    ADD(text, ",\"origin\":{\"name\":\"fathom\",\"sw_version\":\"" FATHOM_VERSION_STRING "\"}");
}

/* A contact says near or far in words. */
static void add_value(const station_t *station, entity_t entity, char *text)
{
    if (entity == ENTITY_DISTANCE && is_contact(station)) {
        ADD(text, ",\"value_template\":\"{{ value_json.status }}\"");
        return;
    }
    ADD(text, ",\"value_template\":\"%s\"", entities[entity].template);
    if (entities[entity].device_class != NULL)
        ADD(text, ",\"device_class\":\"%s\"", entities[entity].device_class);
    if (entities[entity].unit != NULL)
        ADD(text, ",\"unit_of_measurement\":\"%s\",\"state_class\":\"measurement\"", entities[entity].unit);
}

void discovery_payload(const config_t *config, const station_t *station, unsigned bit,
                       char text[DISCOVERY_TEXT])
{
    const entity_t entity = bit % ENTITIES;
    char id[ID];
    char topic[TOPIC];
    char probe[16] = "";
    entity_id(config, station, bit, id);
    topic_of_probe(config, station, probe_of(bit), entities[entity].topic, topic);
    if (topic_has_probes(station)) (void)snprintf(probe, sizeof probe, " %u", probe_of(bit));
    const bool is_word = entity == ENTITY_DISTANCE && is_contact(station);
    text[0] = '\0';
    ADD(text, "{\"name\":\"%s%s\",\"unique_id\":\"%s\",\"state_topic\":\"%s\",\"qos\":1",
        is_word ? "contact" : entities[entity].name, probe, id, topic);
    add_value(station, entity, text);
    /* Of an alarm only the changes are told. */
    if (entity != ENTITY_ALARM) ADD(text, ",\"expire_after\":%" PRIu32, expire_s(station));
    add_availability(config, station, text);
    add_device(config, station, text);
    ADD(text, "}");
}
