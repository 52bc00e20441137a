/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_MEDIAN_H
#define FATHOM_MEDIAN_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/sample.h"
#include "fathom/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * The median of the last 3 to 15 samples of one probe, and before it a gate that drops spikes: for any sensor in any
 * mode.
 *
 *   static uint16_t window[5];
 *   fathom_median_t median;
 *   fathom_median_init(&median, &(fathom_median_config_t){.window = window, .count = 5, .gate_mm = 300});
 *   if (fathom_poll(&sensor, &sample) == FATHOM_READY && fathom_median_sample(&median, &sample, &steady))
 *       use(&steady);
 *   if (fathom_median_time(&median, clock.now_us(clock.ctx))) warn();
 *
 * What counts as what:
 *   a distance                     its millimetres
 *   FATHOM_NO_TARGET, FATHOM_FAR   farther than every distance. So the median is FATHOM_NO_TARGET when most are
 *   FATHOM_NEAR                    nearer than every distance: 0 mm. So the median may be FATHOM_NEAR
 *   FATHOM_UNKNOWN, FATHOM_FAULT   nothing, as an error of the line, of which there is no sample: the window and a row
 *                                  of spikes stay as they are, but not for ever:
 *
 * More than unknown_us after the last sample that counted, a spike or not, the window is emptied: by the next one that
 * counts, or by fathom_median_time, which tells so. There is a median when the window is full, and then with each
 * sample that counts and is no spike. Of an even number it is the nearer of the two in the middle: the median is always
 * a value that was measured.
 *
 * The gate: a sample that is more than gate_mm nearer or farther than the median is a spike. It is dropped and counted.
 * After gate_row spikes in a row, wherever each of them was, something has moved: the next one is not dropped, but
 * empties the window and is the first one of a new window. From and to "farther than every distance" is always more
 * than gate_mm. While the window is not full nothing is a spike.
 *
 * (A distance of 0 mm comes out as FATHOM_NEAR, and one of 65535 mm as FATHOM_NO_TARGET: no sensor here has either.)
 *
 * It needs no clock but the times of the samples, may be called from anywhere, and does no I/O.
 */

enum { FATHOM_MEDIAN_MIN_COUNT = 3, FATHOM_MEDIAN_MAX_COUNT = 15 };

/* A config's gate_row and unknown_us of 0 mean these. */
enum { FATHOM_MEDIAN_DEFAULT_GATE_ROW = 2 };
#define FATHOM_MEDIAN_DEFAULT_UNKNOWN_US 5000000uL

/* Read by init only. */
typedef struct {
    uint16_t *window; /* `count` of them, the caller's, which outlive the median */
    /* After more than this without a sample that counts the window is emptied: longer than it takes from one to the
     * next. 0: 5 s; up to 35 minutes; FATHOM_NO_DEADLINE: never. */
    uint32_t unknown_us;
    uint16_t gate_mm; /* 0: no gate */
    uint8_t gate_row; /* at most so many spikes in a row are dropped; 0: 2 */
    uint8_t count;    /* 3..15 */
} fathom_median_config_t;

typedef struct {
    fathom_median_config_t config;
    uint32_t fed_us;  /* the last sample that counted, a spike too */
    uint16_t value;   /* the median, while the window is full */
    uint16_t dropped; /* spikes so far; stops at 65535. May be read and set to 0 */
    uint8_t have;     /* of the window */
    uint8_t next;     /* the place of the next one; of a full window the oldest one's */
    uint8_t row;      /* of spikes */
} fathom_median_t;

/* An empty window. FATHOM_READY, or FATHOM_ERR_ARGUMENT: no window, or a count that is not 3..15. */
fathom_status_t fathom_median_init(fathom_median_t *median, const fathom_median_config_t *config);

/* The probe's next sample. True: *out is this sample with the kind and the distance of the median, and without its mark
 * of interference if that is another kind; `out` may be `sample`. False: there is no median with this sample, and *out
 * is untouched. */
bool fathom_median_sample(fathom_median_t *median, const fathom_sample_t *sample, fathom_sample_t *out);

/* It is now_us, and no sample has come with that. True: the window has been emptied, and was not empty before. To be
 * called so often that the time between, and unknown_us, are together less than 35 minutes; a time a little before that
 * of the last sample does no harm. */
bool fathom_median_time(fathom_median_t *median, uint32_t now_us);

#ifdef __cplusplus
}
#endif

#endif
