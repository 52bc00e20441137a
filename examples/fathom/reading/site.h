/* SPDX-License-Identifier: MIT */
#ifndef SITE_H
#define SITE_H

#include "diagnosis/advice.h"
#include "fathom/processing/alarm.h"
#include "fathom/processing/level.h"
#include "fathom/processing/median.h"
#include "fathom_loop.h"
#include "output/record.h"
#include "ports/port.h"
#include "sensors/models.h"

/* All sensors that a command reads, and the lines that they share. */

/* A serial line has 32 unit loads. */
enum { MAX_SENSORS = 256, MAX_SENSORS_ON_A_LINE = 32, FULL_NAME_SIZE = 80, RESULTS_POINTS = 32 };

/* ---- what is computed from the samples of each probe ---- */

/* What the user wants for all probes of a sensor. All zeros: each sample is reported as it was received. */
typedef struct {
    fathom_level_config_t tank; /* tank.points: `points` of this structure, or NULL */
    fathom_level_point_t points[RESULTS_POINTS];
    fathom_alarm_config_t alarm;
    uint32_t unknown_us; /* fathom_median_config_t.unknown_us */
    uint16_t gate_mm;
    uint8_t median; /* of N samples; 0: none */
    bool has_level;
    bool has_alarm;    /* its changes are reported, and no readings, ... */
    bool has_readings; /* ... unless this is set too */
} results_config_t;

void results_config_copy(results_config_t *to, const results_config_t *from);

/* A reading, or the change of an alarm. */
typedef struct {
    /* As received, or with the kind and the distance of the median. If a change was not caused by a sample: the time,
     * the probe, and FATHOM_UNKNOWN. */
    fathom_sample_t sample;
    fathom_level_t level;
    bool has_level; /* there is a distance to compute it from */
    uint8_t alarm;  /* the new fathom_alarm_state_t; 0: the result is a reading */
    bool is_on;     /* the alarm, in that state */
} result_t;

/* The state of a probe. */
typedef struct {
    fathom_median_t median;
    uint16_t window[FATHOM_MEDIAN_MAX_COUNT];
    uint64_t dropped; /* spikes */
    fathom_alarm_t alarm;
    uint32_t began_us;
    bool is_known; /* a state of the alarm was reported */
} result_probe_t;

/* How exact pulses are measured on this board, since the last print: the widths of those that were distances, and what
 * was rejected. It belongs to the board while the target stands still. */
typedef struct {
    int64_t distances, min_us, max_us;
    int64_t no_targets;
    int64_t faults;       /* longer than any of the sensor, or without an end */
    int64_t noises;       /* shorter */
    int64_t missed_edges; /* of which no event came */
    int64_t lost_events;  /* that found no place in the kernel's queue */
    double mean_us;
    double squares;                                 /* the sum of squared differences from the mean */
    int64_t mean_dus, deviation_dus, deviation_dmm; /* in tenths, when they are printed */
} pulses_t;

/* ---- sensors and lines ---- */

typedef struct sensor sensor_t;
typedef struct line line_t;

struct sensor {
    /* What the user wants. */
    const model_t *model;
    const model_mode_t *mode;
    fathom_line_settings_t line; /* of the requests to the sensor */
    port_options_t *port;        /* of its line */
    reader_settings_t settings;  /* without line, backoff_us and address */
    results_config_t processing;
    uint8_t address;
    bool has_own_name; /* the user chose the name */
    bool is_named;     /* messages name the sensor: there are others, or the user chose the name */
    /* "tank"; or "a16:1", "a16" without an address, "a16:1@ttyUSB0" if others have the same */
    char name[FULL_NAME_SIZE];
    size_t number;  /* in site_t.sensors */
    sensor_t *next; /* on the same line */

    /* How it is read. */
    reader_t *reader; /* NULL until it was opened */
    counters_t counters;
    reported_t reported; /* its failures that were printed */
    pulses_t pulses;
    uint32_t noises; /* pulses of the present attempt that were too short */
    result_probe_t probes[FATHOM_DYP_PROBES];
    listener_t *own_listener; /* if several sensors share the line: for this sensor's requests */
    listener_t *listener;     /* the line's or its own */
    uint64_t next_us;         /* the start of the present attempt */
    bool skipping;            /* the present response came before next_us */
    bool answering;           /* the present attempt has delivered a part of a response */
    bool has_failed;          /* a part of the present attempt failed */
    bool has_good;            /* there was a reading other than FATHOM_UNKNOWN */
    bool has_raise_notice;    /* the user knows that the interval is longer than the chosen one */
};

/* A line waits while its port is lost, or was never there; then it connects or is read at once. It ends when all attempts
 * were made. A port that cannot be used or is lost permanently ends it as well. */
typedef enum {
    LINE_NEW,        /* not part of the loop yet */
    LINE_WAITING,    /* the loop opens the port again after a pause */
    LINE_CONNECTING, /* the connection is not established yet */
    LINE_READING,
    LINE_ENDING, /* the sensors leave their devices as they were before */
    LINE_LEFT    /* closed, and not opened again */
} line_state_t;

/* A port and the sensors on it. */
struct line {
    fathom_loop_source_t source; /* first: the loop passes it to loop.c */
    port_options_t settings;
    sensor_t *sensors; /* the first one; sensor_t.next has the others */
    line_t *next;
    /* How the user describes this line: a reload leaves a line with the same text alone. NULL: unknown */
    char *text;
    struct loop *loop;
    port_t port;
    line_state_t state;
    bool was_open;
    uint32_t holder; /* the program of holder_t that was reported newest */
    bool is_lost;    /* the port, since it was open; or it was never there */
    char path[];     /* of the port */
};

typedef struct {
    sensor_t **sensors; /* in the order in which the user named them */
    size_t sensor_count;
    line_t *lines;
    size_t line_count;
    uint32_t count;       /* attempts of each sensor; 0: no limit */
    uint64_t duration_us; /* 0: no limit */
    bool asks_all;        /* without a MODE each sensor gets requests, also one that is alone on its line */
    bool reconnect;       /* wait for a port that is lost */
    bool persists;        /* with reconnect: also for a port that exists and cannot be opened */
} site_t;

/* Adds a sensor of zeros. */
sensor_t *site_add_sensor(site_t *site);

/* Adds a line for the port at `path`, which is copied. */
line_t *site_add_line(site_t *site, const char *path);

/* Puts a sensor on a line, behind the sensors that are there. */
void line_add(line_t *line, sensor_t *sensor);

/* Appends to line->text. */
void line_add_text(line_t *line, const char *text);

/* Frees all sensors and lines; the site is empty then. */
void site_free(site_t *site);

/* Swaps what has not changed: lines of both sites that have the same text, and their sensors. */
void site_keep(site_t *site, site_t *old);

/* Gives the sensor a name made of its model and its address, unless the user chose one. */
void sensor_set_name(sensor_t *sensor);

/* Writes `sensor`, `model` and `mode` as members of the open object. */
void sensor_json(json_t *json, const sensor_t *sensor);

/* Returns true if probe 1 to 4 exists and is wanted. A relay contact has one for all probes. */
bool sensor_has_probe(const sensor_t *sensor, uint8_t probe);

/* Returns true for a switch or a relay contact, which has no distance. */
bool sensor_is_contact(const sensor_t *sensor);

#endif
