/* SPDX-License-Identifier: MIT */
#ifndef CALIBRATE_PLAN_H
#define CALIBRATE_PLAN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/*
 * What a calibration measures and writes next, and what it may claim in the end. It does no I/O: the command measures
 * and writes, and says here what came of it.
 *
 * The distance offset of an HPS-167S (#12) is kept in flash and cannot be read; the datasheet does not say whether what
 * is written REPLACES the offset before or ADDS to it. A target that stands still at a known distance K tells:
 *
 *   1. m0 is measured. d = K - m0. |d| <= T: it is right, nothing is written.
 *   2. d is written, m1 measured. Where it adds, m1 = K; where it replaces an offset o, m1 = K - o.
 *        m1 = K         it adds, or there was no offset: 3 (or the end, where that need not be known)
 *        m1 = m0        it has not taken effect: the end. More writes could add up at the next power-on
 *        anything else  it replaces: K - m1 was missing, 4
 *   3. 0 is written, m2 measured. m2 = m1: it adds, and 0 has changed nothing. m2 = m1 - d: it replaces: 4
 *   4. What is right without an offset before is written, and measured: = K, or the end.
 *
 * So there are three writes at most. None is ever repeated, and after one without an acknowledgement the next is made
 * only if the measurement shows that it was taken.
 *
 * T is half the largest spread (most - least) of the samples of a measurement, rounded up, and 2 mm at least, as whole
 * millimetres are: a median of several samples lies well within half the spread of the true one. "=" above is within T.
 * Where a measurement is within T of two things that have to be told apart (which can be for |d| <= 2 T), that is said,
 * and the calibration ends.
 */

enum {
    CALIBRATE_WRITES = 3,
    CALIBRATE_MEASUREMENTS = CALIBRATE_WRITES + 1,
    CALIBRATE_LEAST_TOLERANCE_MM = 2
};

/* What the command has to do. */
typedef enum { CALIBRATE_MEASURE, CALIBRATE_WRITE, CALIBRATE_END } calibrate_next_t;

/* What became of a write. */
typedef enum {
    CALIBRATE_ACKNOWLEDGED,
    CALIBRATE_UNANSWERED, /* it was sent: taken or not */
    CALIBRATE_NOT_WRITTEN /* refused, or never sent */
} calibrate_outcome_t;

/* What #12 does to the offset before, as far as it is known. */
typedef enum { CALIBRATE_UNSETTLED, CALIBRATE_ADDS, CALIBRATE_REPLACES } calibrate_rule_t;

/* Why it has ended. */
typedef enum {
    CALIBRATE_DONE,         /* nothing was wrong */
    CALIBRATE_REFUSED,      /* a write was CALIBRATE_NOT_WRITTEN */
    CALIBRATE_NOT_MEASURED, /* the command could not measure */
    CALIBRATE_NOT_MOVED,    /* acknowledged, and it measures as before */
    CALIBRATE_NOT_SEEN,     /* not acknowledged, and it measures as before */
    CALIBRATE_UNCLEAR,      /* within T of two things that have to be told apart */
    CALIBRATE_UNEXPECTED,   /* within T of none */
    CALIBRATE_TOO_LARGE     /* an offset would be needed that #12 does not take */
} calibrate_why_t;

/* An offset that the device may have now; is_added: to the one before, which is not known. */
typedef struct {
    int32_t mm;
    bool is_added;
} calibrate_offset_t;

enum { CALIBRATE_OFFSETS = 4 };

/* To be read by the command. */
typedef struct {
    calibrate_next_t next;
    int32_t write_mm; /* of CALIBRATE_WRITE */

    int32_t known_mm;
    int32_t tolerance_mm;                        /* T */
    int32_t measured_mm[CALIBRATE_MEASUREMENTS]; /* the medians */
    uint32_t spread_mm;                          /* the largest */
    int32_t written_mm[CALIBRATE_WRITES]; /* sent and not refused: what flash may have been written with */
    size_t measurements;
    size_t writes;

    /* ---- at the end ---- */

    calibrate_why_t why;
    bool is_right; /* the last measurement is within T of known_mm, and it came after the last write */
    calibrate_rule_t rule;

    /* inside */
    uint8_t step;
    bool settles;
    bool is_acknowledged; /* the last write */
    size_t surely;        /* writes that were surely taken: a later one may have been */
} calibrate_plan_t;

/* settles: also finds out whether #12 adds or replaces, where it is right without. Then what `next` says: */
void calibrate_begin(calibrate_plan_t *plan, int32_t known_mm, bool settles);

/* CALIBRATE_MEASURE: the median of the samples and their spread, once two measurements have agreed; or it failed. */
void calibrate_measured(calibrate_plan_t *plan, int32_t median_mm, uint32_t spread_mm);
void calibrate_not_measured(calibrate_plan_t *plan);

/* CALIBRATE_WRITE: plan->write_mm was written once. */
void calibrate_wrote(calibrate_plan_t *plan, calibrate_outcome_t outcome);

/* The offsets that are possible at the end; returns how many. With the one before: {0, true}. */
size_t calibrate_offsets(const calibrate_plan_t *plan, calibrate_offset_t offsets[CALIBRATE_OFFSETS]);

/* The tolerance that goes with a spread. */
int32_t calibrate_tolerance_mm(uint32_t spread_mm);

#endif
