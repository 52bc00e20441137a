/* SPDX-License-Identifier: MIT */
#ifndef TOPICS_H
#define TOPICS_H

#include "mqtt/settings.h"
#include "reading/site.h"

/* The topics: PREFIX/SITE/status and publisher, and PREFIX/SITE/NAME/state or, of a sensor with several probes,
 * PREFIX/SITE/NAME/PROBE/state. */

enum { TOPIC = 256 };

/* What a topic has of a probe. */
typedef enum { TOPIC_STATE, TOPIC_LEVEL, TOPIC_ALARM, TOPICS } topic_t;

/* PREFIX/SITE/word */
void topic_of_site(const publish_settings_t *settings, const char *word, char text[TOPIC]);

/* Of a sensor as a whole: its availability. */
void topic_of_sensor(const publish_settings_t *settings, const sensor_t *sensor, const char *word,
                     char text[TOPIC]);

/* Of one of its probes, from 1. */
void topic_of_probe(const publish_settings_t *settings, const sensor_t *sensor, uint8_t probe, topic_t topic,
                    char text[TOPIC]);

/* Returns true if each probe has its own topics. A single probe, and a relay of all probes, has one set. */
bool topic_has_probes(const sensor_t *sensor);

/* Returns true if the sensor has this topic. */
bool topic_is_there(const sensor_t *sensor, topic_t topic);

#endif
