/* SPDX-License-Identifier: MIT */
#ifndef PUBLISHER_H
#define PUBLISHER_H

#include "mqtt/broker.h"
#include "mqtt/state.h"

/*
 * What is sent to the broker, and in which order. First the retained messages, of which only the last one counts: that the
 * publisher is online, how Home Assistant finds the sensors, which of them are available, what they have counted, and how the publisher is.
 * Then the messages of the queue, one after another.
 */

/* What the publisher knows of a sensor. */
typedef struct {
    sensor_t *sensor;
    stream_t *streams[FATHOM_DYP_PROBES][TOPICS];
    stream_t *availability;
    uint8_t failures; /* in a row */
    bool is_available;
    bool is_away; /* because of a failure; before the first reading a sensor is neither away nor available */
    char name[FULL_NAME_SIZE];
} publisher_sensor_t;

typedef struct {
    const publish_settings_t *settings;
    const host_t *host;
    uint64_t start_us;
    broker_t broker;
    queue_t queue;
    streams_t streams;
    stream_t *status;
    stream_t *news; /* how the publisher is */
    char boot[BOOT];
    publisher_sensor_t *sensors; /* by sensor_t.number */
    size_t sensor_count;
    uint64_t sent_dropped;    /* in the last message about the publisher, ... */
    uint64_t sent_us;         /* ... and when it was sent */
    uint64_t printed_dropped; /* on the standard error */
    uint64_t counted_us;      /* when the counters of the sensors became due */
    bool has_facts;           /* a retained message may be due */
} publisher_t;

/* *settings must stay valid. What is measured waits in the queue until publisher_connect() was called. start_us: of the
 * loop. False: the user knows why. */
bool publisher_init(publisher_t *publisher, const host_t *host, const publish_settings_t *settings,
                    const site_t *site, uint64_t start_us);
bool publisher_connect(publisher_t *publisher, fathom_loop_t *loop);

/* The sensors are those of this site from now on, and *settings changed. Retained topics that are not used any more are
 * deleted. False: no memory left. */
bool publisher_change(publisher_t *publisher, const site_t *site, bool has_other_broker);

/* Publishes what the loop reports. Returns true if the sensor was not away before this failure. */
bool publisher_reading(publisher_t *publisher, const reading_t *reading);

/* Call it before each sleep, outside of a step of the loop. Returns the longest time to sleep in us. */
uint32_t publisher_tick(publisher_t *publisher);

/* The state of the publisher in a line. */
void publisher_status(const publisher_t *publisher, char *text, size_t capacity);

/* Publishes that the publisher is offline, if it can, and waits a little for that. */
void publisher_deinit(publisher_t *publisher);

#endif
