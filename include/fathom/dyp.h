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
 * it; whoever uses those needs no more of this page than the window.
 *
 * The datasheets give no code for "nothing there". Of sister models it is known that 0xFFFD is no object and
 * 0xFFFE interference by another unit of the same frequency, and that older firmware sends 0 for no object.
 * Fathom reads them so. Any other value outside the plausible window is none that the sensor can mean.
 */
#define FATHOM_DYP_NO_OBJECT     0xFFFDu
#define FATHOM_DYP_INTERFERENCE  0xFFFEu
#define FATHOM_DYP_NO_OBJECT_OLD 0u

/* The distances that are believed, in mm, both included. In a driver's config 0 stands for its default. */
typedef struct {
    uint16_t min_mm;
    uint16_t max_mm;
    /* False: 0, 0xFFFD and 0xFFFE are read as above, since sister models send them. True, for modules of which it is
     * known that they do not: they are refused like any other value outside the window. */
    bool no_codes;
} fathom_dyp_window_t;

/* Member by member: of a whole struct of this size compilers make a call of memcpy. */
static inline void fathom_dyp_window_copy(fathom_dyp_window_t *to, const fathom_dyp_window_t *from)
{
    to->min_mm = from->min_mm;
    to->max_mm = from->max_mm;
    to->no_codes = from->no_codes;
}

/* The default windows. 16350 mm is the longest pulse of A16 1(3), 94 ms; 6000 mm leaves the A05 a third beyond
 * its range of 4.5 m. The near end is 1 mm. */
enum { FATHOM_A16_MAX_MM = 16350, FATHOM_A05_MAX_MM = 6000 };

/* One answer: a value for each of some probes, handed over as one sample a probe. */
typedef struct {
    uint16_t *values; /* of probe `first` and those after it */
    fathom_dyp_window_t window;
    uint32_t time_us;
    uint16_t sequence;
    uint16_t implausible; /* values that were refused; stops at 65535 */
    uint8_t model;        /* fathom_model_t */
    uint8_t unit;         /* 0 from a sensor that sends by itself */
    uint8_t first;        /* 1..4 */
    uint8_t left;         /* bit probe - 1: has not been handed over */
} fathom_dyp_answer_t;

/*
 * The next probe's sample. FATHOM_READY: written. FATHOM_ERR_MALFORMED: the value is not plausible; nothing
 * written, counted, the next call goes on with the next probe. FATHOM_PENDING: none is left.
 */
fathom_status_t fathom_dyp_next(fathom_dyp_answer_t *answer, fathom_sample_t *sample);

/* A new answer has come: its values are set, and these probes (bit probe - 1) wait to be handed over. */
void fathom_dyp_answer(fathom_dyp_answer_t *answer, uint8_t probes, uint32_t time_us);

/* Nothing has come yet. FATHOM_READY, or FATHOM_ERR_ARGUMENT: the window is upside down. Where the window's
 * members are 0 they become 1 and default_max_mm. */
fathom_status_t fathom_dyp_answer_init(fathom_dyp_answer_t *answer, uint16_t default_max_mm);

/* Could the sensor have meant this value? */
bool fathom_dyp_plausible(const fathom_dyp_window_t *window, uint16_t value);

#ifdef __cplusplus
}
#endif

#endif
