/* SPDX-License-Identifier: MIT */
#include "mqtt/topics.h"

const char *const topic_words[TOPICS] = {
    [TOPIC_STATE] = "state",
    [TOPIC_LEVEL] = "level",
    [TOPIC_ALARM] = "alarm",
};

void topic_of_site(const config_t *config, const char *word, char text[TOPIC])
{
    (void)snprintf(text, TOPIC, "%s/%s/%s", config->prefix, config->site, word);
}

void topic_of_sensor(const config_t *config, const station_t *station, const char *word, char text[TOPIC])
{
    (void)snprintf(text, TOPIC, "%s/%s/%.31s/%s", config->prefix, config->site, station->name, word);
}

void topic_of_probe(const config_t *config, const station_t *station, uint8_t probe, topic_t topic,
                    char text[TOPIC])
{
    if (topic_has_probes(station))
        (void)snprintf(text, TOPIC, "%s/%s/%.31s/%u/%s", config->prefix, config->site, station->name, probe,
                       topic_words[topic]);
    else
        topic_of_sensor(config, station, topic_words[topic], text);
}

bool topic_has_probes(const station_t *station)
{
    return station->model->probes > 1 && !station->mode->is_contact;
}

bool topic_wants_probe(const station_t *station, uint8_t probe)
{
    const uint8_t wanted = station->settings.probes;
    if (!topic_has_probes(station)) return probe == 1;
    return probe <= station->model->probes && (wanted == 0 || (wanted >> (probe - 1) & 1) != 0);
}

bool topic_is_there(const results_config_t *results, topic_t topic)
{
    if (topic == TOPIC_LEVEL) return results->has_level;
    if (topic == TOPIC_ALARM) return results->has_alarm;
    return true;
}
