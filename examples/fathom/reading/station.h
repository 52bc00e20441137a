/* SPDX-License-Identifier: MIT */
#ifndef STATION_H
#define STATION_H

#include "diagnosis/counters.h"
#include "output/json.h"
#include "ports/port_settings.h"
#include "reading/pulses.h"
#include "sensors/models.h"

/* A line has 32 unit loads. */
enum { MAX_STATIONS = 256, MAX_STATIONS_ON_A_LINE = 32 };

/* One sensor at a port, as a command reads it. */
enum { MAX_PORTS = MAX_STATIONS, STATION_NAME = 80, STATION_SLOTS = 2 * MAX_STATIONS };

typedef struct station station_t;
struct station {
    const model_t *model;
    const model_mode_t *mode;
    fathom_line_settings_t line; /* at which it is asked */
    size_t port;                 /* its row in sensor_options_t.ports */
    size_t slot;                 /* which station of the tool it is: less than STATION_SLOTS */
    /* What the user wants of it; line, backoff_us and address are set when it begins. */
    reader_settings_t settings;
    reader_t *reader; /* NULL until it is opened */
    counters_t counters;
    pulses_t pulses;
    listener_t
        own_listener;     /* where several sensors are asked: what was heard while it was this one's turn */
    listener_t *listener; /* the line's or its own */
    uint64_t next_us;     /* when the present attempt began, or will */
    station_t *next;      /* on the same port; the poll loop's */
    bool skipping;        /* the present response came before it */
    bool answering;       /* the present attempt has begun to hand over a response, ... */
    bool has_failed;      /* ... or a part of it was an error */
    bool is_raise_told;   /* by station_is_raised */
    bool has_good;        /* there has been a reading that is not unknown */
    bool has_own_name;    /* the user's */
    uint8_t address;
    /* The user's; else "a16:1", of one without an address "a16". Where others at other ports have the same: "a16:1@tty". */
    char name[STATION_NAME];
};

/* The sensors that a command reads, and their ports. */
typedef struct sensor_options {
    bool asks_all; /* a sensor without a MODE is read in one that sends requests; set before the others */
    /* Others whose stations are being read, and are left alone; set before. NULL: none. */
    const struct sensor_options *beside;
    station_t *stations[MAX_STATIONS]; /* in the order of the words */
    size_t station_count;
    port_options_t ports[MAX_PORTS];
    size_t port_count;
    uint32_t count;       /* attempts of each sensor; 0: endless */
    uint64_t duration_us; /* 0: endless */
    bool reconnect;
    bool persists; /* with reconnect: also if a port exists and cannot be opened now */
} sensor_options_t;

/* Its name, by its model, mode and address, if the user has given none. */
void station_name(station_t *station);

/* Writes `sensor`, `model` and `mode` as members of the open object. */
void station_json(json_t *json, const station_t *station);

/* Are both named and read in the same way? Their ports are not looked at. */
bool station_is_same(const station_t *one, const station_t *other);

/* Begins to read it through an open channel. False: its driver, or the port, does not take the settings, for which
 * station_refusal has the words. */
bool station_begin(station_t *station, channel_t *channel, const reader_settings_t *settings);
void station_refusal(const station_t *station, char *text, size_t capacity);

/* Has its driver raised the interval that the user has given? Then *text says so, the first time. */
bool station_is_raised(station_t *station, char *text, size_t capacity);

#endif
