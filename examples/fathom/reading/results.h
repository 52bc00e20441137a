/* SPDX-License-Identifier: MIT */
#ifndef RESULTS_H
#define RESULTS_H

#include "fathom/processing/alarm.h"
#include "fathom/processing/level.h"
#include "fathom/processing/median.h"
#include "reading/poll.h"

/* What is made of the samples of each probe before they are told: a median, then a level or an alarm. */

enum { RESULTS_POINTS = 32 };

/* What the user wants, for all probes of a sensor; nothing: each sample is told as it came. It stays where it is, since
 * `tank` points at `points`. */
typedef struct {
    fathom_level_config_t tank;
    fathom_level_point_t points[RESULTS_POINTS];
    fathom_alarm_config_t alarm;
    uint32_t unknown_us; /* fathom_median_config_t.unknown_us */
    uint16_t gate_mm;
    uint8_t median; /* of so many samples; 0: none */
    bool has_level;
    bool has_alarm;    /* its changes are told, and no readings, ... */
    bool has_readings; /* ... unless this is set too */
} results_config_t;

/* Do both want the same? And takes another one's place. */
bool results_config_is_same(const results_config_t *one, const results_config_t *other);
void results_config_copy(results_config_t *to, const results_config_t *from);

/* A reading, or the change of an alarm. */
typedef struct {
    /* As it came, or with the kind and the distance of the median. A change that no sample has brought: its time and its
     * probe, and FATHOM_UNKNOWN. */
    fathom_sample_t sample;
    fathom_level_t level;
    bool has_level; /* there is a distance to have one from */
    uint8_t alarm;  /* the new fathom_alarm_state_t; 0: it is a reading */
    bool is_on;     /* the alarm, in that state */
} result_t;

/* False: it could not be told. */
typedef bool (*results_tell_t)(void *ctx, const station_t *station, const result_t *result);

typedef struct {
    fathom_median_t median;
    uint16_t window[FATHOM_MEDIAN_MAX_COUNT];
    uint64_t dropped; /* spikes */
    fathom_alarm_t alarm;
    uint32_t began_us;
    bool is_known; /* a state of the alarm has been told */
} result_probe_t;

typedef struct {
    poll_loop_t *loop;
    results_tell_t tell;
    void *ctx;
    const results_config_t *configs[STATION_SLOTS];
    result_probe_t probes[STATION_SLOTS][FATHOM_DYP_PROBES];
} results_t;

void results_begin(results_t *results, poll_loop_t *loop, results_tell_t tell, void *ctx);

/* From now on this is made of the samples of this station, from the beginning; several may have the same config. To be
 * called for each one before the first sample. */
void results_add(results_t *results, const station_t *station, const results_config_t *config);

/*
 * For poll_loop_user_t's reading, failure and tick, which returns how long it may be until it is called again. The first
 * state of an alarm is told when there is a distance to have it from, or unknown_us after the begin.
 */
bool results_sample(results_t *results, const station_t *station, const fathom_sample_t *sample);
void results_failure(results_t *results, const station_t *station, fathom_status_t status);
uint32_t results_tick(results_t *results);

/* Spikes that were dropped so far: of all probes, and a line for each that had some. */
uint64_t results_dropped(const results_t *results);
void results_print_dropped(const results_t *results, FILE *to);

#endif
