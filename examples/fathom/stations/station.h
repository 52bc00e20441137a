/* SPDX-License-Identifier: MIT */
#ifndef STATION_H
#define STATION_H

#include "models/models.h"
#include "stations/counters.h"

/* One sensor on a line, as a command reads it. */
enum { STATION_NAME = 16 };

typedef struct {
    const model_t *model;
    const model_mode_t *mode;
    fathom_line_settings_t line; /* at which it is asked */
    size_t port;                 /* its row in sensor_options_t.ports */
    uint8_t address;
    char name[STATION_NAME]; /* "a16:1", as the user may write it; of one without an address "a16" */
    reader_t reader;
    counters_t counters;
    listener_t
        own_listener;     /* where several sensors are asked: what was heard while it was this one's turn */
    listener_t *listener; /* the line's or its own */
    uint64_t next_us;     /* when the present attempt began, or will */
    bool skipping;        /* the present response came before it */
    bool answering;       /* the present attempt has begun to hand over a response, ... */
    bool has_failed;      /* ... or a part of it was an error */
    bool has_good;        /* there has been a reading that is not unknown */
} station_t;

/*
 * Reads SENSOR[:ADDRESS[:MODE]]; an empty ADDRESS is the factory's. Without a MODE it is the sensor's first one; the
 * first in which it is asked if it has an ADDRESS or shares the line, for only then can it have or do that.
 * address, mode: what options have said of the same; NULL: nothing. False after a usage error.
 */
bool station_parse(station_t *station, const char *command, const char *text, const char *address,
                   const char *mode, bool is_shared);

/* Its name, by its model, mode and address. */
void station_name(station_t *station);

/* Can these be read on one line? has_settings: a line where each is asked at its own settings; not so behind a
 * gateway. False after a usage error. */
bool stations_check(const station_t *stations, size_t count, const char *command, bool has_settings);

/* Begins to read it through an open channel. False: its driver, or the port, does not take the settings, for which
 * station_refusal has the words. */
bool station_begin(station_t *station, channel_t *channel, const reader_settings_t *settings);
void station_refusal(const station_t *station, char *text, size_t capacity);

#endif
