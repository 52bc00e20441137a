/* SPDX-License-Identifier: MIT */
#ifndef SITE_H
#define SITE_H

#include "diagnosis/counters.h"
#include "fathom_loop.h"
#include "output/record.h"
#include "ports/port.h"
#include "ports/port_settings.h"
#include "reading/processing.h"
#include "reading/pulses.h"
#include "sensors/models.h"

/* All sensors that a command reads, and the lines that they share. */

/* A serial line has 32 unit loads. */
enum { MAX_SENSORS = 256, MAX_SENSORS_ON_A_LINE = 32, FULL_NAME_SIZE = 80 };

typedef struct sensor sensor_t;
typedef struct line line_t;

struct sensor {
    /* What the user wants. */
    const model_t *model;
    const model_mode_t *mode;
    fathom_line_settings_t line; /* at which the sensor is asked */
    port_options_t *port;        /* of its line */
    reader_settings_t settings;  /* without line, backoff_us and address */
    results_config_t processing;
    uint8_t address;
    size_t number;     /* in site_t.sensors, while the loop reads it */
    bool has_own_name; /* the user chose the name */
    bool is_named;     /* messages name the sensor: there are others, or the user chose the name */
    char name
        [FULL_NAME_SIZE]; /* "tank"; or "a16:1", "a16" without an address, "a16:1@ttyUSB0" if others have the same */

    /* How it is read. */
    reader_t *reader; /* NULL until it was opened */
    counters_t counters;
    pulses_t pulses;
    result_probe_t probes[FATHOM_DYP_PROBES];
    listener_t *own_listener; /* if several sensors share the line: for this sensor's requests */
    listener_t *listener;     /* the line's or its own */
    uint64_t next_us;         /* the start of the present attempt */
    sensor_t *next;           /* on the same line */
    bool skipping;            /* the present response came before next_us */
    bool answering;           /* the present attempt has delivered a part of a response */
    bool has_failed;          /* a part of the present attempt failed */
    bool has_good;            /* there was a reading other than FATHOM_UNKNOWN */
    bool has_raise_notice;    /* the user knows that the interval is longer than the chosen one */
};

/* A port and the sensors on it. */
struct line {
    fathom_loop_source_t source; /* first: the loop passes it to line.c */
    port_options_t settings;
    sensor_t *sensors; /* the first one; sensor_t.next has the others */
    line_t *next;
    char *
        text; /* how the user describes this line: a reload leaves a line with the same text alone. NULL: unknown */
    struct loop *loop;
    port_t port;
    port_counts_t counts;
    bool is_connecting; /* the connection is not established yet */
    bool was_open;
    bool is_lost; /* or was never there */
    bool waits;   /* the loop tries to open the port again */
    bool is_done; /* nothing is left to read, or the port is lost for good */
    bool is_left; /* the loop may remove the line from its sources */
    char path[];  /* of the port */
};

typedef struct {
    sensor_t **sensors; /* in the order in which the user named them */
    size_t sensor_count;
    line_t *lines;
    size_t line_count;
    uint32_t count;       /* attempts of each sensor; 0: no limit */
    uint64_t duration_us; /* 0: no limit */
    bool asks_all;        /* without a MODE each sensor is asked, also one that is alone on its line */
    bool reconnect;       /* wait for a port that is lost */
    bool persists;        /* with reconnect: also for a port that exists and cannot be opened */
} site_t;

/* Adds a sensor of zeros. NULL: no memory left. */
sensor_t *site_add_sensor(site_t *site);

/* Adds a line for the port at `path`, which is copied. NULL: no memory left. */
line_t *site_add_line(site_t *site, const char *path);

/* Puts a sensor on a line, behind the sensors that are there. */
void line_add(line_t *line, sensor_t *sensor);

/* Appends to line->text. False: no memory left. */
bool line_add_text(line_t *line, const char *text);

/* Frees all sensors and lines; the site is empty then. */
void site_free(site_t *site);

/* Moves what has not changed: a line of `site` with the text of a line of `old` is replaced by that line, and its
 * sensors by the sensors there. `old` keeps the other lines and sensors. */
void site_keep(site_t *site, site_t *old);

/* Gives the sensor a name made of its model and its address, unless the user chose one. */
void sensor_set_name(sensor_t *sensor);

/* Writes `sensor`, `model` and `mode` as members of the open object. */
void sensor_json(json_t *json, const sensor_t *sensor);

/* Returns the name, or the model if the sensor need not be named. */
const char *sensor_label(const sensor_t *sensor);

/* Starts to read the sensor through an open port. False: sensor_refusal() has the reason. */
bool sensor_start(sensor_t *sensor, port_t *port, const reader_settings_t *settings);
void sensor_refusal(const sensor_t *sensor, char *text, size_t capacity);

/* Returns true, once, if the driver's interval is longer than the one that the user chose; *text says so. */
bool sensor_is_slower(sensor_t *sensor, char *text, size_t capacity);

/* Returns true if probe 1 to 4 exists and is wanted. A relay contact has one for all probes. */
bool sensor_has_probe(const sensor_t *sensor, uint8_t probe);

/* Returns true for a switch or a relay contact, which has no distance. */
bool sensor_is_contact(const sensor_t *sensor);

#endif
