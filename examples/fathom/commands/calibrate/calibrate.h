/* SPDX-License-Identifier: MIT */
#ifndef CALIBRATE_H
#define CALIBRATE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/*
 * What a calibration measures and writes next, and what it may claim at the end. These functions do no I/O.
 *
 * The sensor keeps the distance offset (#12) in flash and does not report it. The datasheet does not state whether a new
 * offset REPLACES the old one or is ADDED to it. A fixed target at a known distance K shows enough:
 *
 *   1. Measure m0. If |K - m0| <= T, the sensor is right and nothing is written.
 *   2. Write d = K - m0 and measure m1.
 *        m1 = K         the sensor is right: #12 adds, or there was no old offset
 *        m1 = m0        the write had no effect. Stop: another write could add up at the next power-on
 *        anything else  #12 has replaced an old offset. K - m1 is missing
 *   3. Only after a replaced offset: write d + K - m1, which does not depend on the old one, and measure again.
 *
 * So flash is written at most twice. No write is repeated. After a write without an acknowledgement, the second one is
 * made only if the measurement shows that the first one was accepted.
 *
 * T is half the largest spread (maximum - minimum) of the samples, rounded up, and at least 2 mm. "=" above means within
 * T. If a measurement is within T of two results that exclude each other, the calibration stops and reports that.
 */
enum { CALIBRATE_WRITES = 2, CALIBRATE_MEASUREMENTS = CALIBRATE_WRITES + 1, CALIBRATE_OFFSETS = 4 };

/* The next step: a write, or the end and its reason. */
typedef enum {
    CALIBRATE_WRITE,        /* write offset_mm, then measure */
    CALIBRATE_RIGHT,        /* the last measurement came after the last write and is within T of known_mm */
    CALIBRATE_REFUSED,      /* a write was refused, or never sent */
    CALIBRATE_NOT_MEASURED, /* a measurement failed */
    CALIBRATE_NOT_MOVED,    /* the write was acknowledged and had no effect */
    CALIBRATE_NOT_SEEN,     /* the write was not acknowledged and had no effect */
    CALIBRATE_UNCLEAR,      /* a measurement is within T of two results that exclude each other */
    CALIBRATE_UNEXPECTED,   /* a measurement is within T of no possible result */
    CALIBRATE_TOO_LARGE     /* the offset does not fit into #12 */
} calibrate_next_t;

/* Start with {.known_mm = K}. */
typedef struct {
    int known_mm;
    int spread_mm;                           /* the largest one */
    int measured_mm[CALIBRATE_MEASUREMENTS]; /* the medians */
    int written_mm[CALIBRATE_WRITES];        /* offsets that were sent and not refused */
    int offset_mm;                           /* with CALIBRATE_WRITE: the offset to write */
    size_t measurements;
    size_t writes;
    bool is_certain; /* the sensor has accepted the last write. It has accepted an earlier one in any case */
    bool replaces;   /* a measurement has shown that #12 replaces the old offset */
} calibration_t;

/* An offset that the sensor may have. */
typedef struct {
    int mm;
    bool is_added; /* to the old offset, which is unknown */
} calibrate_offset_t;

/* Adds a measurement: the median and the spread. Returns the next step. */
calibrate_next_t calibrate_measured(calibration_t *run, int median_mm, int spread_mm);

/* Adds a write of offset_mm, which the sensor may have accepted even if it did not acknowledge it. */
void calibrate_wrote(calibration_t *run, bool is_acknowledged);

/* Stores the offsets that the sensor may have and returns their number. {0, true} is the old offset. */
size_t calibrate_offsets(const calibration_t *run, calibrate_offset_t offsets[CALIBRATE_OFFSETS]);

/* Returns the tolerance T for a spread. */
int calibrate_tolerance_mm(int spread_mm);

#endif
