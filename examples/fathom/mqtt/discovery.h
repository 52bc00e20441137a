/* SPDX-License-Identifier: MIT */
#ifndef DISCOVERY_H
#define DISCOVERY_H

#include "mqtt/topics.h"

/* Home Assistant's discovery messages: one for each entity, retained.
 * https://www.home-assistant.io/integrations/mqtt/#mqtt-discovery */

/* What Home Assistant shows of a probe. Several of them may have one topic. */
typedef enum {
    ENTITY_DISTANCE,
    ENTITY_TEMPERATURE,
    ENTITY_LEVEL,
    ENTITY_FILLED,
    ENTITY_ALARM,
    ENTITIES
} entity_t;

enum { DISCOVERY_BITS = FATHOM_DYP_PROBES * ENTITIES, DISCOVERY_TOPIC = 512, DISCOVERY_TEXT = 3072 };

/* Returns the entities of this sensor: bits ENTITIES * (probe - 1) + entity; 0 if discovery is off. */
uint32_t discovery_all(const publish_settings_t *settings, const sensor_t *sensor);

/* The message of one of these bits. */
void discovery_topic(const publish_settings_t *settings, const sensor_t *sensor, unsigned bit,
                     char text[DISCOVERY_TOPIC]);
void discovery_payload(const publish_settings_t *settings, const sensor_t *sensor, unsigned bit,
                       char text[DISCOVERY_TEXT]);

#endif
