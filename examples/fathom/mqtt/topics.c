/* SPDX-License-Identifier: MIT */
#include "mqtt/topics.h"

#include <stdio.h>

static const char *const words[TOPICS] = {
    [TOPIC_STATE] = "state",
    [TOPIC_LEVEL] = "level",
    [TOPIC_ALARM] = "alarm",
};

void topic_of_site(const publish_settings_t *settings, const char *word, char text[TOPIC])
{
    (void)snprintf(text, TOPIC, "%s/%s/%s", settings->prefix, settings->site, word);
}

void topic_of_sensor(const publish_settings_t *settings, const sensor_t *sensor, const char *word,
                     char text[TOPIC])
{
    (void)snprintf(text, TOPIC, "%s/%s/%.31s/%s", settings->prefix, settings->site, sensor->name, word);
}

void topic_of_probe(const publish_settings_t *settings, const sensor_t *sensor, uint8_t probe, topic_t topic,
                    char text[TOPIC])
{
    if (topic_has_probes(sensor))
        (void)snprintf(text, TOPIC, "%s/%s/%.31s/%u/%s", settings->prefix, settings->site, sensor->name,
                       probe, words[topic]);
    else
        topic_of_sensor(settings, sensor, words[topic], text);
}

bool topic_has_probes(const sensor_t *sensor)
{
    return sensor->model->probes > 1 && !sensor_is_contact(sensor);
}

bool topic_is_there(const sensor_t *sensor, topic_t topic)
{
    if (topic == TOPIC_LEVEL) return sensor->processing.has_level;
    if (topic == TOPIC_ALARM) return sensor->processing.has_alarm;
    return true;
}
