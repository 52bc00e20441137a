/* SPDX-License-Identifier: MIT */
#ifndef TOPICS_H
#define TOPICS_H

#include "cli/config.h"

/* The topics: PREFIX/SITE/status and the like, and PREFIX/SITE/NAME/state or, of a sensor with several probes,
 * PREFIX/SITE/NAME/PROBE/state. */

enum { TOPIC = 256 };

/* What a topic tells of a probe. */
typedef enum { TOPIC_STATE, TOPIC_LEVEL, TOPIC_ALARM, TOPICS } topic_t;

extern const char *const topic_words[TOPICS];

/* PREFIX/SITE/word */
void topic_of_site(const config_t *config, const char *word, char text[TOPIC]);

/* Of a sensor as a whole: its availability. */
void topic_of_sensor(const config_t *config, const station_t *station, const char *word, char text[TOPIC]);

/* Of one of its probes, from 1. */
void topic_of_probe(const config_t *config, const station_t *station, uint8_t probe, topic_t topic,
                    char text[TOPIC]);

/* Does it tell each of its probes? One, or a relay, which is all of them, has one set of topics. And has the user asked for
 * this probe? */
bool topic_has_probes(const station_t *station);
bool topic_wants_probe(const station_t *station, uint8_t probe);

/* Has it this topic? */
bool topic_is_there(const results_config_t *results, topic_t topic);

#endif
