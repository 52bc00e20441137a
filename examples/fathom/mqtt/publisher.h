/* SPDX-License-Identifier: MIT */
#ifndef PUBLISHER_H
#define PUBLISHER_H

#include "mqtt/broker.h"
#include "mqtt/topics.h"
#include "reading/loop.h"

/*
 * What is sent to the broker, and in which order. First what is retained and due, of which only the last message counts.
 * Then the readings, which wait in a queue while the broker is away.
 *
 * After a connect the broker can have retained anything that an earlier run of this site sent. So the publisher subscribes
 * to that, and sends counters and availability. When the first of them comes back, all that was retained is there; what no
 * sensor has is deleted before entities are named. The status is online when no message waits that is older than the connect:
 * none sees an old alarm, or an old reading, of what is available. For the same reason a sensor is available behind its reading.
 */

/* Everything that is published under one topic since the start of the program. A topic stays until the end, also while no
 * sensor has it: a sensor that is named again goes on with its numbers. */
typedef struct topic {
    struct topic *next;
    topic_kind_t kind;
    sensor_t *sensor; /* while is_wanted; NULL: of the publisher */
    uint8_t probe;    /* 0: of the sensor */
    uint64_t seq;     /* of the last reading; 0: none yet */
    uint64_t dropped; /* messages */
    uint64_t after;   /* it is not sent before this number of messages left the queue */
    /* The newest message that left the queue, if it is retained: it is sent again after each connect, and is not lost if the
     * queue was full. NULL: none. */
    struct message *kept;
    bool is_wanted;        /* a sensor has the topic, or the publisher */
    bool is_due;           /* the broker does not know the present state */
    bool is_known;         /* the broker may have a retained message */
    bool has_other_sensor; /* than before the sensors were named */
    char name[];
} topic_t;

/* A reading that waits: members of a JSON object. Its date, its age, and the number of messages of its topic that were
 * dropped before it, are added when it is sent. So a clock that is set while it waits makes its date right. */
typedef struct message {
    struct message *next;
    topic_t *topic;
    uint64_t time_us; /* of the reading, by the host's clock */
    uint64_t seq;
    size_t size; /* of the message with its text */
    bool is_sent;
    char text[];
} message_t;

/* The oldest message first. If one more exceeds the bounds of the settings, the oldest ones are dropped. */
typedef struct {
    message_t *first;
    message_t *last;
    size_t bytes;
    uint32_t count;
    uint64_t dropped; /* since the start */
    uint64_t left;    /* messages that left it since the start */
} queue_t;

typedef enum { SENSOR_NEW, SENSOR_AVAILABLE, SENSOR_AWAY } presence_t;

/* What the publisher knows of a sensor. */
typedef struct {
    sensor_t *sensor;
    topic_t *topics[FATHOM_DYP_PROBES][TOPICS - TOPIC_STATE]; /* of its readings; NULL: not published */
    uint8_t failures;                                         /* in a row */
    presence_t presence;
} publisher_sensor_t;

typedef struct {
    const publish_settings_t *settings;
    const host_t *host;
    uint64_t start_us;
    broker_t broker;
    queue_t queue;
    topic_t *topics;             /* in the order in which they were named */
    char boot[17];               /* a random number for each start of the program, in hexadecimal digits */
    publisher_sensor_t *sensors; /* by sensor_t.number */
    size_t sensor_count;
    /* A stream in memory for payloads. It is kept, since to open one takes longer than to write a payload. */
    FILE *to;
    char *payload;
    size_t payload_size;
    uint32_t greetings;    /* of the broker, as far as the publisher repeated all that is retained */
    uint64_t greeted_us;   /* time of the last one */
    bool is_subscribed;    /* to what an earlier run can have left */
    bool is_heard;         /* its own message came back since then, or the publisher waits no longer */
    bool is_deaf_reported; /* that none came back */
    uint64_t sent_dropped; /* in the last message about the publisher, ... */
    uint64_t sent_us;      /* ... and when it was sent */
    uint64_t counted_us;   /* when the counters of the sensors became due */
    bool has_due;          /* a retained message may be due */
    bool is_ending;
} publisher_t;

/* *settings must stay valid. `loop` is needed from the first publisher_tick() on, which connects. start_us: of the program. */
void publisher_init(publisher_t *publisher, const host_t *host, fathom_loop_t *loop,
                    const publish_settings_t *settings, const site_t *site, uint64_t start_us);

/* The sensors are those of this site from now on, and *settings changed. Retained topics that are not used any more are
 * deleted. */
void publisher_change(publisher_t *publisher, const site_t *site, bool has_other_broker);

/* Publishes what the loop reports. Returns true if the sensor was not away before this failure. */
bool publisher_reading(publisher_t *publisher, const reading_t *reading);

/* Call it before each sleep, outside of a step of the loop. Returns the longest time to sleep in us. */
uint32_t publisher_tick(publisher_t *publisher);

/* The state of the publisher in a line. */
void publisher_status(const publisher_t *publisher, char *text, size_t capacity);

/* Publishes what still waits and that the publisher is offline, if it can, and ends the connection. */
void publisher_end(publisher_t *publisher);
void publisher_deinit(publisher_t *publisher);

#endif
