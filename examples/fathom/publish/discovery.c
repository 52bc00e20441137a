/* SPDX-License-Identifier: MIT */
#include "publish/discovery.h"

#include <inttypes.h>
#include <string.h>

#include "fathom/version.h"
#include "publish/text.h"

uint16_t discovery_all(const config_t *config, const station_t *station, const results_config_t *results)
{
    uint16_t bits = 0;
    for (unsigned bit = 0; bit != FATHOM_DYP_PROBES * TOPICS && config->discovery[0] != '\0'; bit++)
        if (topic_wants_probe(station, (uint8_t)(bit / TOPICS + 1)) && topic_is_there(results, bit % TOPICS))
            bits |= (uint16_t)(1u << bit);
    return bits;
}

/* Of letters, digits, - and _ alone, as Home Assistant wants it. */
static void add_id(char *text, size_t capacity, const char *word)
{
    const size_t before = strlen(text);
    text_add(text, capacity, "%s%s", before != 0 ? "_" : "", word);
    for (char *at = text + before; *at != '\0'; at++)
        if (*at == '/' || *at == '.') *at = '_';
}

enum { ID = 320 };

static void device_id(const config_t *config, const station_t *station, char id[ID])
{
    id[0] = '\0';
    add_id(id, ID, config->prefix);
    add_id(id, ID, config->site);
    add_id(id, ID, station->name);
}

static void entity_id(const config_t *config, const station_t *station, uint8_t probe, topic_t topic,
                      char id[ID])
{
    char number[4];
    (void)snprintf(number, sizeof number, "%u", probe);
    device_id(config, station, id);
    if (topic_has_probes(station)) add_id(id, ID, number);
    add_id(id, ID, topic_words[topic]);
}

void discovery_topic(const config_t *config, const station_t *station, uint8_t probe, topic_t topic,
                     char text[DISCOVERY_TOPIC])
{
    char id[ID];
    entity_id(config, station, probe, topic, id);
    (void)snprintf(text, DISCOVERY_TOPIC, "%s/%s/%s/config", config->discovery,
                   topic == TOPIC_ALARM ? "binary_sensor" : "sensor", id);
}

/* ---- the payload ---- */

#define ADD(text, ...) text_add(text, DISCOVERY_TEXT, __VA_ARGS__)

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

static void add_kind(const station_t *station, topic_t topic, char *text)
{
    if (topic == TOPIC_ALARM) {
        ADD(text,
            ",\"device_class\":\"problem\",\"value_template\":\"{{ 'ON' if value_json.is_on else 'OFF' }}\"");
        return;
    }
    const bool is_contact = (station->mode->pins & MODEL_PIN_IN) != 0;
    if (is_contact)
        ADD(text, ",\"value_template\":\"{{ value_json.status }}\"");
    else
        ADD(text,
            ",\"device_class\":\"distance\",\"state_class\":\"measurement\",\"unit_of_measurement\":\"mm\""
            ",\"value_template\":\"{{ value_json.%s }}\"",
            topic == TOPIC_LEVEL ? "level_mm" : "distance_mm");
    ADD(text, ",\"expire_after\":%" PRIu32, expire_s(station));
}

void discovery_payload(const config_t *config, const station_t *station, const results_config_t *results,
                       uint8_t probe, topic_t topic, char text[DISCOVERY_TEXT])
{
    static const char *const names[TOPICS] = {
        [TOPIC_STATE] = "distance", [TOPIC_LEVEL] = "level", [TOPIC_ALARM] = "alarm"};
    char id[ID];
    char state[TOPIC];
    char number[16] = "";
    (void)results;
    entity_id(config, station, probe, topic, id);
    topic_of_probe(config, station, probe, topic, state);
    if (topic_has_probes(station)) (void)snprintf(number, sizeof number, " %u", probe);
    text[0] = '\0';
    ADD(text,
        "{\"name\":\"%s%s\",\"unique_id\":\"%s\",\"object_id\":\"%s\",\"state_topic\":\"%s\",\"json_"
        "attributes_topic\":"
        "\"%s\",\"qos\":1",
        names[topic], number, id, id, state, state);
    add_kind(station, topic, text);
    add_availability(config, station, text);
    add_device(config, station, text);
    ADD(text, "}");
}
