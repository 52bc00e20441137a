/* SPDX-License-Identifier: MIT */
/*
 * Judges a driver that listens to damaged frames: no reading that was not sent, no wrong error, and each damaged byte is
 * counted. The rig does the damage, so the judge knows each frame that the checksum cannot show as damaged.
 */
#ifndef SECOND_DAMAGE_H
#define SECOND_DAMAGE_H

#include "second_judge.h"

/* The state in which a frame arrived. */
typedef enum {
    FRAME_CLEAN,
    FRAME_DAMAGED,
    FRAME_UNSEEN /* damaged, and the checksum is right all the same */
} frame_state_t;

/* Returns the state of a frame, and copies the bytes that arrived if none is missing. */
frame_state_t damage_of(const second_event_t *frame, uint8_t bytes[SECOND_FRAME_MAX]);
/* Returns the value of a probe in a frame. */
uint16_t damage_value(const uint8_t *frame, unsigned probe);

/* Counts since damage_begin(). */
typedef struct {
    unsigned frames[FRAME_UNSEEN + 1]; /* by frame_state_t */
    unsigned
        countable; /* damaged frames without a missing or marked byte, and of an HPS-167S with a right head */
    unsigned readings, unseen_readings, damage_errors, stale_errors;
} damage_heard_t;
extern damage_heard_t damage_heard;

/* Starts to judge a driver with this `stale_us`; 0 if the driver has none and requests each frame by a trigger. */
void damage_begin(uint32_t stale_us);
/* Polls a sensor for `us` and judges each outcome. A driver with `stale_us` must have an outcome in this time. */
void damage_poll(const fathom_sensor_t *sensor, uint64_t us);
/* The counters of a driver: accepted frames, dropped bytes, damaged frames. */
typedef struct {
    unsigned frames, dropped_bytes, damaged;
} damage_counted_t;
/* Judges the counters of the driver at the end of its life. */
void damage_end(damage_counted_t counted);

#endif
