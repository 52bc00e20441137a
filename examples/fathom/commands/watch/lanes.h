/* SPDX-License-Identifier: MIT */
#ifndef LANES_H
#define LANES_H

#include "reading/fields.h"

/* What `fathom watch` shows of each probe: the present value, and the last few hundred steps of time. */

/* What there is instead of a distance. Of several in one step the last in this list is shown. */
typedef enum {
    MARK_NONE = 0,
    MARK_NO_TARGET,
    MARK_INTERFERENCE,
    MARK_UNKNOWN,
    MARK_TOO_NEAR,
    MARK_FAR, /* of a contact, whose state lasts until the next one, as a distance does */
    MARK_NEAR,
    MARK_STALE,
    MARK_NO_RESPONSE,
    MARK_LINE_BUSY,
    MARK_OTHER_MASTER,
    MARK_BAD_RESPONSE, /* damaged, refused, or with an impossible value */
    MARK_FAULT,
    MARK_PORT,
    MARKS,
    MARK_WAITING = MARKS /* of a lane without an outcome; in no step */
} mark_t;

typedef struct {
    char character;
    bool is_loss; /* else the sensor reported it */
    bool is_rare; /* most sensors never have this mark */
    const char *name;
} mark_row_t;
extern const mark_row_t marks[MARKS + 1];

typedef struct {
    uint16_t distance_mm; /* the last one in this step, if has_distance */
    uint16_t readings;
    bool has_distance;
    bool
        is_held; /* nothing was received: the distance or the state of a contact is still that of the step before */
    uint8_t mark; /* mark_t */
} step_t;

enum { LANE_STEPS = 512, LANE_NAME = FULL_NAME_SIZE + 16 };
enum { LEAST_NAME = 13, MOST_NAME = 39 }; /* 31 characters and " probe 1"; a longer name is cut */

typedef struct {
    const sensor_t *sensor;
    uint8_t probe;
    char name[LANE_NAME];     /* "a16:1", "a05:2 probe 3" */
    step_t steps[LANE_STEPS]; /* a ring; step 0 is the first one after the start */
    mark_t mark;              /* the present outcome */
    uint16_t distance_mm;     /* with MARK_NONE */
    uint64_t heard_us;        /* the time of that outcome */
    uint64_t held_until;      /* the last step in which it is shown if nothing else is received */
    uint64_t outcomes;
    uint64_t lost; /* of these */
} lane_t;

typedef struct {
    lane_t *lane;
    int count;
    int name_width; /* of the longest name, from LEAST_NAME to MOST_NAME */
    uint64_t now_us;
    uint32_t seen; /* bit mark_t: it was there once */
    uint32_t step_us;
} lanes_t;

/* Allocates lanes->lane, which the caller frees. */
void lanes_init(lanes_t *lanes, const site_t *site);

/* Advances the time since the start. */
void lanes_pass(lanes_t *lanes, uint64_t now_us);

/* Adds what the loop reports. */
void lanes_add(lanes_t *lanes, const reading_t *reading);

/* Returns the step `ago` steps before the present one, less than LANE_STEPS. */
const step_t *lane_step(const lanes_t *lanes, const lane_t *lane, int ago);

/* Returns the value, "1.234 m", "no response" or "waiting", and the rate as a mean of the last few seconds, "9.5/s". */
enum { LANE_TEXT = 24 };
const char *lane_value(const lane_t *lane, char text[LANE_TEXT]);
const char *lane_rate(const lanes_t *lanes, const lane_t *lane, char text[LANE_TEXT]);

#endif
