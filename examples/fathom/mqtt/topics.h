/* SPDX-License-Identifier: MIT */
#ifndef TOPICS_H
#define TOPICS_H

#include "mqtt/settings.h"
#include "output/record.h"
#include "reading/site.h"

/*
 * What `fathom publish` publishes, as one table: topics, and the discovery messages by which Home Assistant finds
 * entities (https://www.home-assistant.io/integrations/mqtt/#mqtt-discovery). A topic is PREFIX/SITE/WORD,
 * PREFIX/SITE/SENSOR/WORD or, of a sensor with several probes, PREFIX/SITE/SENSOR/PROBE/WORD.
 */

typedef enum {
    TOPIC_STATUS,    /* of the publisher: online or offline */
    TOPIC_PUBLISHER, /* how the publisher is */
    ENTITY_DISTANCE,
    ENTITY_TEMPERATURE,
    ENTITY_LEVEL,
    ENTITY_FILLED,
    ENTITY_ALARM,
    TOPIC_AVAILABILITY, /* of a sensor */
    TOPIC_COUNTERS,     /* of a sensor */
    TOPIC_STATE,        /* the readings of a probe, each of which is sent: */
    TOPIC_LEVEL,
    TOPIC_ALARM,
    TOPICS
} topic_kind_t;

enum { TOPIC_NAME = 1152 };

bool topic_is_entity(topic_kind_t kind);
bool topic_is_retained(topic_kind_t kind);

/* Returns true if each probe has its own topics. A single probe, and a relay of all probes, has one set. */
bool topic_has_probes(const sensor_t *sensor);

/* Returns true if this is published. sensor: NULL for the publisher; probe: from 1, or 0 for all of the sensor. */
bool topic_is_there(const publish_settings_t *settings, topic_kind_t kind, const sensor_t *sensor,
                    uint8_t probe);

/* Writes the topic of what is there. */
void topic_name(const publish_settings_t *settings, topic_kind_t kind, const sensor_t *sensor, uint8_t probe,
                char name[TOPIC_NAME]);

/* Writes the filter `number`, from 0, of the topics under which an earlier run can have left messages. False: there are no
 * more. */
bool topic_filter(const publish_settings_t *settings, unsigned number, char name[TOPIC_NAME]);

/* Returns the kind of a message that a run of this site has sent and that a broker retained, and writes the topic of the
 * counters of its sensor; ENTITY_DISTANCE: of any entity. TOPICS: the message is another site's or another program's. */
topic_kind_t topic_of_site(const publish_settings_t *settings, const char *name, const char *payload,
                           char counters[TOPIC_NAME]);

/* Returns the columns of a reading under TOPIC_STATE, TOPIC_LEVEL or TOPIC_ALARM. */
unsigned topic_columns(topic_kind_t kind, const sensor_t *sensor);

/* Writes a discovery message as members of the open object. */
void topic_json_entity(json_t *json, const publish_settings_t *settings, topic_kind_t kind,
                       const sensor_t *sensor, uint8_t probe);

#endif
