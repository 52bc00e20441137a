/* SPDX-License-Identifier: MIT */
#ifndef DISCOVERY_H
#define DISCOVERY_H

#include "publish/topics.h"

/* Home Assistant's discovery messages: one for each topic of each probe, retained, by which it finds an entity.
 * https://www.home-assistant.io/integrations/mqtt/#mqtt-discovery */

enum { DISCOVERY_TOPIC = 512, DISCOVERY_TEXT = 3072 };

/* All that are to be told of this sensor: bits TOPICS * (probe - 1) + topic; none where discovery is off. */
uint16_t discovery_all(const config_t *config, const station_t *station, const results_config_t *results);

void discovery_topic(const config_t *config, const station_t *station, uint8_t probe, topic_t topic,
                     char text[DISCOVERY_TOPIC]);
void discovery_payload(const config_t *config, const station_t *station, const results_config_t *results,
                       uint8_t probe, topic_t topic, char text[DISCOVERY_TEXT]);

#endif
