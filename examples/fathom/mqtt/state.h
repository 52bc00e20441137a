/* SPDX-License-Identifier: MIT */
#ifndef STATE_H
#define STATE_H

#include "mqtt/queue.h"
#include "mqtt/topics.h"

/* What is published, as JSON. A message is written in two parts: what was measured, when it is put into the queue; and how old
 * that is and how many were dropped before it, when it leaves. */

/* The program's start, as 16 hexadecimal digits; drawn at random. */
enum { BOOT = 17 };
void state_boot(char boot[BOOT]);

/* A reading, a change of an alarm, or an attempt that has failed, of one probe. */
typedef struct {
    const station_t *station;
    const result_t *result;
    const char *failure; /* a word of status_word.h; NULL: it has not failed */
    uint64_t utc_us;     /* when */
    const char *boot;
    uint64_t seq;
} state_t;

enum { STATE_TEXT = QUEUE_TEXT + 64 };

/* The first part, without an end. Its length. */
uint32_t state_begin(const state_t *state, topic_t topic, char text[QUEUE_TEXT]);

/* Adds the second part. */
void state_finish(char text[STATE_TEXT], uint64_t age_us, uint64_t dropped);

/* All that is told of the publisher itself. */
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
