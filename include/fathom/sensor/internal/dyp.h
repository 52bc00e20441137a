/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_DYP_H
#define FATHOM_DYP_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/sample.h"
#include "fathom/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * What the ultrasonic sensors A16 and A05 have in common: what their 16 bits mean. Their drivers are built on
 * it; their users need no more of this page than the window and the meanings.
 *
 * The datasheets print distances and no other value. Of sister models it is known that 0xFFFD is no object and
 * 0xFFFE interference by another unit of the same frequency. 0 has been seen with nothing in range and with a hand
 * on the probe, so it is unknown until the config gives it a meaning. Any other value outside the window is refused.
 */

/* Which of its distances a sensor is to give, wherever one can choose. */
typedef enum {
    FATHOM_PROCESSED = 0, /* steady, and slow to follow */
    FATHOM_REAL_TIME = 1  /* the last measurement */
} fathom_dyp_value_t;

/* What a value that is no distance means: the kind of its sample. */
typedef enum {
    FATHOM_MEANS_DEFAULT = 0,
    FATHOM_MEANS_UNKNOWN = FATHOM_UNKNOWN,
    FATHOM_MEANS_NO_TARGET = FATHOM_NO_TARGET,
    FATHOM_MEANS_TOO_NEAR = FATHOM_NEAR, /* something is nearer than the probe can measure */
    FATHOM_MEANS_FAULT = FATHOM_FAULT,
    FATHOM_MEANS_INTERFERENCE = 7, /* FATHOM_NO_TARGET with the mark of interference */
    FATHOM_MEANS_REFUSED = 8       /* no sample: FATHOM_ERR_MALFORMED */
} fathom_meaning_t;

/* The distances that are believed, in mm, both included, and what each of the four values is that may be no distance;
 * those are never distances, whatever the window. In a driver's config 0 stands for a member's default. */
/* Ranges: min_mm 0 to max_mm; max_mm 0 to 65535, of which 65533 to 65535 are never distances; the others are a
 * fathom_meaning_t, 0 or one of its values. 1 (FATHOM_TARGET), 5 (FATHOM_FAR) and values above 8 are FATHOM_ERR_ARGUMENT. */
typedef struct {
    uint16_t min_mm;
    uint16_t max_mm;
    uint8_t value_fffd; /* fathom_meaning_t; 0: FATHOM_MEANS_NO_TARGET */
    uint8_t value_fffe; /* 0: FATHOM_MEANS_INTERFERENCE */
    uint8_t value_ffff; /* 0: FATHOM_MEANS_REFUSED */
    uint8_t value_0;    /* 0: FATHOM_MEANS_UNKNOWN. The last of the four: in the order of value + 3 */
} fathom_dyp_window_t;

/* The default windows. 16350 mm is the longest pulse of A16 1(3), 94 ms; 6000 mm leaves the A05 a third beyond
 * its range of 4.5 m. The near end is 1 mm. */
enum { FATHOM_A16_MAX_MM = 16350, FATHOM_A05_MAX_MM = 6000 };

/* One response: a value for each of some probes, handed over as one sample a probe. */
typedef struct {
    uint8_t model;   /* fathom_model_t */
    uint8_t address; /* 0 from a sensor that sends by itself */
    uint8_t first;   /* 1..4 */
    uint8_t left;    /* bit probe - 1: has not been handed over */
    /* The last value that was refused, and its probe; 0: none yet. They belong to the last FATHOM_ERR_MALFORMED, if
     * that made `implausible` grow. */
    uint8_t refused_probe;
    uint16_t refused_raw;
    uint16_t sequence;
    uint16_t implausible; /* values that were refused; stops at 65535 */
    fathom_dyp_window_t window;
    uint16_t *values; /* of probe `first` and those after it */
    uint32_t time_us;
} fathom_dyp_measurement_t;

/*
 * The next probe's sample. FATHOM_OK: written. FATHOM_ERR_MALFORMED: the value is refused, and kept in
 * refused_probe and refused_raw; nothing written, counted, the next call goes on with the next probe.
 * FATHOM_PENDING: none is left.
 */
fathom_status_t fathom_dyp_measurement_next(fathom_dyp_measurement_t *measurement, fathom_sample_t *sample);

/* A new response has come: its values are set, and these probes (bit probe - 1) wait to be handed over. */
static inline void fathom_dyp_measurement_set(fathom_dyp_measurement_t *measurement, uint8_t probes,
                                              uint32_t time_us)
{
    measurement->sequence++;
    measurement->time_us = time_us;
    measurement->left = probes;
}

/* Byte by byte: of a struct of this size compilers make a call of memcpy. */
void fathom_dyp_window_copy(fathom_dyp_window_t *to, const fathom_dyp_window_t *from);

/* Nothing has come yet. FATHOM_OK, or FATHOM_ERR_ARGUMENT: min_mm > max_mm. max_mm 0: default_max_mm. */
fathom_status_t fathom_dyp_measurement_init(fathom_dyp_measurement_t *measurement, uint16_t default_max_mm);

/* What a value is: FATHOM_TARGET, a distance of at most the window's max_mm; or a fathom_meaning_t. */
uint8_t fathom_dyp_meaning(const fathom_dyp_window_t *window, uint16_t value);

#ifdef __cplusplus
}
#endif

#endif
