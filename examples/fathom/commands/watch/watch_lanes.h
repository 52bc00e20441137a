/* SPDX-License-Identifier: MIT */
#ifndef WATCH_LANES_H
#define WATCH_LANES_H

#include "reading/loop.h"

/* What `fathom watch` knows of each probe: the last few hundred steps of time, and how it is now. */

/* What came instead of a distance; of several in one step the last of this list is kept. */
typedef enum {
    MARK_NONE = 0,
    MARK_NO_TARGET,
    MARK_INTERFERENCE,
    MARK_UNKNOWN,  /* a value without a meaning */
    MARK_TOO_NEAR, /* ... to be measured */
    MARK_FAR,      /* of a switch or a contact, whose states stand until the next one, as distances do */
    MARK_NEAR,
    MARK_STALE,
    MARK_NO_RESPONSE,
    MARK_LINE_BUSY,
    MARK_OTHER_MASTER,
    MARK_BAD_RESPONSE, /* damaged, refused, or with a value that cannot be */
    MARK_FAULT,
    MARK_PORT, /* it is lost */
    MARKS
} mark_t;

/* For a mark: the character that stands for it and what it means. */
char mark_character(mark_t mark);
const char *mark_name(mark_t mark);

/* Is it a loss, and not something that the sensor has said? */
bool mark_is_loss(mark_t mark);

/* One step of time. */
typedef struct {
    uint16_t distance_mm; /* the last one in it, ... */
    bool has_distance;    /* ... if there was one */
    uint8_t mark;         /* mark_t */
    uint8_t hold;         /* for so many steps more it stands if nothing else comes */
    uint16_t readings;
} step_t;

enum { LANE_STEPS = 512, LANE_NAME = FULL_NAME_SIZE + 16 };

typedef struct {
    const sensor_t *sensor;
    uint8_t probe;
    char name[LANE_NAME];     /* "a16:1", "a05:2 probe 3" */
    step_t steps[LANE_STEPS]; /* number n, counted from the start, stands at n % LANE_STEPS */
    uint16_t distance_mm;     /* the last outcome: with mark MARK_NONE, ... */
    mark_t mark;
    bool has_outcome;  /* ... if there was one */
    uint64_t heard_us; /* when it came */
    uint64_t outcomes;
    uint64_t lost; /* of these */
} lane_t;

enum { LEAST_NAME = 13, MOST_NAME = 39 }; /* a NAME of 31 characters and " probe 1"; what is longer is cut */

typedef struct {
    lane_t *lane;
    size_t count;
    uint16_t name_width; /* the longest name's in characters, LEAST_NAME to MOST_NAME */
    uint64_t now_us;     /* since the start */
    uint32_t seen;       /* bit mark_t: it has come */
    uint32_t step_us;
} lanes_t;

/* False: no memory left. */
bool lanes_init(lanes_t *lanes, const site_t *site);
void lanes_free(lanes_t *lanes);

/* The time has come so far: steps in which nothing has happened yet are empty. */
void lanes_pass(lanes_t *lanes, uint64_t now_us);

/* Adds what the loop reports. */
void lanes_add(lanes_t *lanes, const reading_t *reading);

/* The step so many steps ago, 0: the present one, as it is to be shown: between two outcomes the distance stands.
 * ago: less than LANE_STEPS. */
step_t lane_step(const lanes_t *lanes, const lane_t *lane, uint32_t ago);

/* Readings in ten seconds, over the last few. */
uint32_t lane_rate_tenths(const lanes_t *lanes, const lane_t *lane);

/* "1.234 m", "no response", "waiting", in a buffer of the caller's. */
enum { LANE_VALUE = 24 };
const char *lane_value(const lane_t *lane, char text[LANE_VALUE]);

#endif
