/* SPDX-License-Identifier: MIT */
#ifndef DISCOVERY_H
#define DISCOVERY_H

#include "mqtt/topics.h"

/* Home Assistant's discovery messages: retained, one for each of its entities, which it finds by them.
 * https://www.home-assistant.io/integrations/mqtt/#mqtt-discovery */

/* What a probe is for Home Assistant; several may be told by one topic. */
typedef enum {
    ENTITY_DISTANCE,
    ENTITY_TEMPERATURE,
    ENTITY_LEVEL,
    ENTITY_FILLED,
    ENTITY_ALARM,
    ENTITIES
} entity_t;

enum { DISCOVERY_BITS = FATHOM_DYP_PROBES * ENTITIES, DISCOVERY_TOPIC = 512, DISCOVERY_TEXT = 3072 };

/* Which there are of this sensor: bits ENTITIES * (probe - 1) + entity; none where discovery is off. */
uint32_t discovery_all(const config_t *config, const station_t *station, const results_config_t *results);

/* Of one of these bits. */
void discovery_topic(const config_t *config, const station_t *station, unsigned bit,
                     char text[DISCOVERY_TOPIC]);
void discovery_payload(const config_t *config, const station_t *station, unsigned bit,
                       char text[DISCOVERY_TEXT]);

#endif
