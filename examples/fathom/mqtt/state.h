/* SPDX-License-Identifier: MIT */
#ifndef STATE_H
#define STATE_H

#include "mqtt/queue.h"
#include "mqtt/topics.h"
#include "reading/loop.h"

/* What is published, as JSON. A message is written in two parts: the reading, when it is put into the queue; and the age
 * of the reading and the number of messages that were dropped before it, when it is sent. */

/* A random number of 16 hexadecimal digits for each start of the program. */
enum { BOOT = 17 };
void state_boot(char boot[BOOT]);

enum { STATE_TEXT = QUEUE_TEXT + 64 };

/* Writes the first part, without an end. */
void state_begin(const reading_t *reading, topic_t topic, const char *boot, uint64_t seq,
                 char text[QUEUE_TEXT]);

/* Adds the second part. */
void state_finish(char text[STATE_TEXT], uint64_t age_us, uint64_t dropped);

/* The counters of a sensor. */
enum { COUNTERS_TEXT = 2048 };
void state_of_counters(sensor_t *sensor, uint64_t utc_us, const char *boot, char text[COUNTERS_TEXT]);

/* The state of the publisher itself. */
typedef struct {
    const char *boot;
    uint64_t utc_us;
    uint64_t uptime_us;
    uint64_t dropped;
    uint32_t queued;
    size_t sensors;
} publisher_state_t;

void state_of_publisher(const publisher_state_t *state, char text[STATE_TEXT]);

#endif
