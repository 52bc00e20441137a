/* SPDX-License-Identifier: MIT */
#ifndef PROCESSING_H
#define PROCESSING_H

#include <stdbool.h>

#include "fathom/processing/alarm.h"
#include "fathom/processing/level.h"
#include "fathom/processing/median.h"

/* What is computed from the samples of each probe before they are reported: a median, then a level or an alarm. */

enum { RESULTS_POINTS = 32 };

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

#endif
