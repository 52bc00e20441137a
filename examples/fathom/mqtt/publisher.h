/* SPDX-License-Identifier: MIT */
#ifndef PUBLISHER_H
#define PUBLISHER_H

#include "mqtt/broker.h"
#include "mqtt/retained.h"
#include "mqtt/state.h"

/*
 * What goes to the broker, and in which order. First what is retained, of which only the last word counts: that the publisher
 * is online, how the sensors are found, which of them are available, and the publisher's counters. Then the messages of the
 * queue, one after another.
 */

/* What is known of a sensor, by its station's slot. */
typedef struct {
    stream_t *streams[FATHOM_DYP_PROBES][TOPICS];
    const station_t *station; /* NULL: none is read there */
    uint32_t discovered;      /* bits of discovery.h: what Home Assistant knows or gets to know, ... */
    uint32_t undiscovered;    /* ... and is still to be told */
    uint8_t failures;         /* in a row */
    bool is_available;
    bool is_away;  /* by a failure; before the first reading it is neither */
    bool has_news; /* that it is available, or is not */
} publisher_sensor_t;

typedef struct {
    const config_t *config;
    results_config_t *results; /* by slot */
    const host_t *host;
    uint64_t start_us;
    broker_t broker;
    queue_t queue;
    streams_t streams;
    char boot[BOOT];
    publisher_sensor_t sensors[STATION_SLOTS];
    retained_t *gone;      /* topics at which nothing is retained any more */
    uint64_t told_dropped; /* in what was told of the publisher last, ... */
    uint64_t told_us;      /* ... and when */
    uint64_t said_dropped; /* on the standard error */
    bool has_status;       /* "online" is still to be told */
    bool has_facts;        /* there may be something before the queue */
} publisher_t;

/* config stays where it is. What is measured waits in the queue until publisher_connect was called. False after saying why. */
bool publisher_begin(publisher_t *publisher, const host_t *host, const config_t *config,
                     config_results_t results);
bool publisher_connect(publisher_t *publisher, fathom_loop_t *loop);

/* For each station that is read. False: there is no memory left. */
bool publisher_add(publisher_t *publisher, const station_t *station);

/*
 * The config is about to be another one: to be called with the one before, then with the other, of which all stations that are
 * read have been added, and removed what are not read any more. What is retained and told no more is deleted.
 */
bool publisher_begin_change(publisher_t *publisher);
void publisher_remove(publisher_t *publisher, size_t slot);
void publisher_end_change(publisher_t *publisher, bool is_other_broker);

/* A reading, or a change of an alarm. True: its sensor was away, and is not any more. */
bool publisher_result(publisher_t *publisher, const station_t *station, const result_t *result,
                      uint64_t time_us);

/* An attempt that has failed, or is not even made since the port is away. word: of status_word.h; probe: 0: it is not of one
 * alone. is_grave: the sensor is not available any more; else it is not after a few in a row. True: it was not away before. */
bool publisher_failure(publisher_t *publisher, const station_t *station, const char *word, uint8_t probe,
                       bool is_grave);

/* From outside of the loop's steps, before each sleep. Returns how long that may take. */
uint32_t publisher_tick(publisher_t *publisher);

/* How things are, in a line. */
void publisher_status(const publisher_t *publisher, char *text, size_t capacity);

/* Tells that it goes offline, if it can, and waits a little for that. */
void publisher_end(publisher_t *publisher);

#endif
