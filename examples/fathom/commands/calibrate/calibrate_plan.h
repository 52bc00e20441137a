/* SPDX-License-Identifier: MIT */
#ifndef CALIBRATE_PLAN_H
#define CALIBRATE_PLAN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/*
 * Decides what a calibration measures and writes next, and what it may claim at the end. The plan does no I/O: the
 * command measures and writes, and reports the result to the plan.
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
enum {
    CALIBRATE_WRITES = 2,
    CALIBRATE_MEASUREMENTS = CALIBRATE_WRITES + 1,
    CALIBRATE_LEAST_TOLERANCE_MM = 2
};

/* The next step of the command. */
typedef enum { CALIBRATE_MEASURE, CALIBRATE_WRITE, CALIBRATE_END } calibrate_next_t;

/* The result of a write. */
typedef enum {
    CALIBRATE_ACKNOWLEDGED,
    CALIBRATE_UNANSWERED, /* sent; the sensor may have accepted it */
    CALIBRATE_NOT_WRITTEN /* refused, or never sent */
} calibrate_outcome_t;

/* The reason why the calibration ended. */
typedef enum {
    CALIBRATE_DONE,         /* the sensor is right */
    CALIBRATE_REFUSED,      /* a write was CALIBRATE_NOT_WRITTEN */
    CALIBRATE_NOT_MEASURED, /* a measurement failed */
    CALIBRATE_NOT_MOVED,    /* the write was acknowledged and had no effect */
    CALIBRATE_NOT_SEEN,     /* the write was not acknowledged and had no effect */
    CALIBRATE_UNCLEAR,      /* a measurement is within T of two results that exclude each other */
    CALIBRATE_UNEXPECTED,   /* a measurement is within T of no possible result */
    CALIBRATE_TOO_LARGE     /* the offset does not fit into #12 */
} calibrate_why_t;

/* An offset that the sensor may have. */
typedef struct {
    int32_t mm;
    bool is_added; /* to the old offset, which is unknown */
} calibrate_offset_t;

enum { CALIBRATE_OFFSETS = 4 };

typedef struct {
    calibrate_next_t next;
    int32_t write_mm; /* with CALIBRATE_WRITE: the offset to write */
    int32_t known_mm;
    int32_t tolerance_mm;                        /* T */
    int32_t measured_mm[CALIBRATE_MEASUREMENTS]; /* the medians */
    uint32_t spread_mm;                          /* the largest one */
    int32_t written_mm[CALIBRATE_WRITES];        /* offsets that were sent and not refused */
    size_t measurements;
    size_t writes;
    size_t
        certain_writes; /* number of writes that the sensor has certainly accepted; a later one is in doubt */
    bool is_acknowledged; /* the last write */
    bool replaces;        /* a measurement has shown that #12 replaces the old offset */

    /* ---- at the end ---- */

    calibrate_why_t why;
    bool is_right; /* the last measurement came after the last write and is within T of known_mm */
} calibrate_plan_t;

/* Starts a calibration. The member `next` is then the next step. */
void calibrate_start(calibrate_plan_t *plan, int32_t known_mm);

/* Reports the result of CALIBRATE_MEASURE to the plan: the median and the spread, or a failure. */
void calibrate_measured(calibrate_plan_t *plan, int32_t median_mm, uint32_t spread_mm);
void calibrate_not_measured(calibrate_plan_t *plan);

/* Reports the result of CALIBRATE_WRITE to the plan. */
void calibrate_wrote(calibrate_plan_t *plan, calibrate_outcome_t outcome);

/* Stores the offsets that the sensor may have at the end and returns their number. {0, true} is the old offset. */
size_t calibrate_offsets(const calibrate_plan_t *plan, calibrate_offset_t offsets[CALIBRATE_OFFSETS]);

/* Returns the tolerance T for a spread. */
int32_t calibrate_tolerance_mm(uint32_t spread_mm);

#endif
