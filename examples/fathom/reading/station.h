/* SPDX-License-Identifier: MIT */
#ifndef STATION_H
#define STATION_H

#include "cli/place.h"
#include "diagnosis/counters.h"
#include "output/json.h"
#include "reading/pulses.h"
#include "sensors/models.h"

/* A line has 32 unit loads. */
enum { MAX_STATIONS = 256, MAX_STATIONS_ON_A_LINE = 32 };

/* One sensor at a port, as a command reads it. */
enum { STATION_NAME = 80, STATION_SLOTS = 2 * MAX_STATIONS };

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

/*
 * What the user has named; *station is all zeros before. An empty ADDRESS is the factory's. Without a MODE it is the
 * sensor's first one; the first in which it is asked if it has an ADDRESS or is_asked, for only then can it have or do
 * that. address, mode: what options have said of the same; NULL: nothing. False after a usage error.
 */
bool station_take(station_t *station, const char *command, const sensor_place_t *place, const char *address,
                  const char *mode, bool is_asked);

/* Can it be read in its mode at this port? False after a usage error. */
bool station_suits(const station_t *station, const port_options_t *port, const char *command);

/* "gpiochip0,in=5", a port for the mode on pins that the user has named. False: no such mode. */
enum { STATION_PORT = 80 };
bool station_port_example(const sensor_place_t *place, char text[STATION_PORT]);

/* Its name, by its model, mode and address, if the user has given none. */
void station_name(station_t *station);

/* Names that several have are told apart by the ports. False after a usage error: some are the same all the same. */
bool stations_name(station_t *const *stations, size_t count, const port_options_t *ports,
                   const char *command);

/* Writes `sensor`, `model` and `mode` as members of the open object. */
void station_json(json_t *json, const station_t *station);

/* Are both named and read in the same way? Their ports are not looked at. */
bool station_is_same(const station_t *one, const station_t *other);

/* Can they be read at their ports, those of a port together? False after a usage error. */
bool stations_check(station_t *const *stations, size_t count, const port_options_t *ports,
                    const char *command);

/* Begins to read it through an open channel. False: its driver, or the port, does not take the settings, for which
 * station_refusal has the words. */
bool station_begin(station_t *station, channel_t *channel, const reader_settings_t *settings);
void station_refusal(const station_t *station, char *text, size_t capacity);

/* Has its driver raised the interval that the user has given? Then *text says so, the first time. */
bool station_is_raised(station_t *station, char *text, size_t capacity);

#endif
