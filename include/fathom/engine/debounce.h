/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_DEBOUNCE_H
#define FATHOM_DEBOUNCE_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/sample.h"
#include "fathom/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * A switch made of distances: the rule of the A16's switch output (A16 4(2)), for any sensor in any mode. So many
 * measurements in a row nearer than the threshold make the level FATHOM_NEAR, so many farther make it FATHOM_FAR;
 * on request a level also lasts for a least time, as that of the A05's relay does (A05 4(1)).
 *
 *   fathom_debounce_t gate;
 *   fathom_debounce_init(&gate, &(fathom_debounce_config_t){.threshold_mm = 800});
 *   if (fathom_poll(&sensor, &sample) == FATHOM_READY && fathom_debounce_sample(&gate, &sample))
 *       open_or_close(gate.level);
 *   if (fathom_debounce_time(&gate, clock.now_us(clock.ctx))) warn();
 *
 * What counts as what:
 *   farther   a distance over the threshold, and FATHOM_NO_TARGET, with the mark of interference too
 *   nearer    a distance under it
 *   equal     neither: the level holds, and both rows are broken, since "3 times in a row is less" (A16 4(2)) is
 *             then no longer so
 *   nothing   FATHOM_UNKNOWN, FATHOM_FAULT, and an error of the line, of which there is no sample: the level
 *             holds, and a row goes on behind it, but not for ever:
 *
 * unknown_us after the last measurement that counted, the level becomes FATHOM_UNKNOWN. That is an error: treat it as
 * a broken wire. A new level then needs a whole row, and does not wait for hold_us. Where nothing comes any more, only
 * the loop knows the time: let it call fathom_debounce_time.
 *
 * Otherwise the level changes with a measurement only. One that is held back because the level before has not yet
 * lasted hold_us changes with the first measurement after that, if its row is still unbroken.
 *
 * It needs no clock but the times that it is given, may be polled from anywhere, and does no I/O.
 */

/* A config's unknown_us of 0 means this: twice the A16's 5 measurements of 500 ms (A16 4(2)). */
#define FATHOM_DEBOUNCE_DEFAULT_UNKNOWN_US 5000000uL

/* Zero-valued members of the config mean these: the A16's from the factory (A16 4(2)). */
enum {
    FATHOM_DEBOUNCE_DEFAULT_THRESHOLD_MM = 1000,
    FATHOM_DEBOUNCE_DEFAULT_NEAR_COUNT = 3,
    FATHOM_DEBOUNCE_DEFAULT_FAR_COUNT = 5
};

/* What a distance that equals the threshold is. The datasheet speaks of less and greater, and leaves it open. */
typedef enum {
    FATHOM_EQUAL_HOLDS = 0, /* the default: a target that stands at the threshold moves nothing */
    FATHOM_EQUAL_IS_NEAR = 1,
    FATHOM_EQUAL_IS_FAR = 2
} fathom_equal_t;

/* Read by init only. Members that are 0 mean their defaults. */
typedef struct {
    uint32_t hold_us; /* a level lasts at least so long, by the times of the measurements; 0: no such time */
    /* So long after the last measurement that counted the level is unknown: longer than it takes from one to the next.
     * 0: 5 s; up to 35 minutes; FATHOM_NO_DEADLINE: never. */
    uint32_t unknown_us;
    uint16_t threshold_mm; /* 0: 1000 mm */
    uint8_t near_count;    /* so many nearer in a row; 0: 3 */
    uint8_t far_count;     /* so many farther in a row; 0: 5 */
    uint8_t equal;         /* fathom_equal_t */
} fathom_debounce_config_t;

typedef struct {
    fathom_debounce_config_t config;
    uint32_t fed_us;  /* the last measurement that counted */
    uint32_t left_us; /* of hold_us */
    /* FATHOM_NEAR, FATHOM_FAR or FATHOM_UNKNOWN; 0: no row has been long enough yet, which is to be treated as
     * unknown too. May be read */
    uint8_t level;
    uint8_t verdict; /* of the row */
    uint8_t row;     /* its length; stops at 255 */
    bool is_fed;     /* there has been a measurement */
} fathom_debounce_t;

/* No measurement yet, no level. FATHOM_READY, or FATHOM_ERR_ARGUMENT: `equal` is none of the three. The first level
 * that a row makes need not wait for hold_us. */
fathom_status_t fathom_debounce_init(fathom_debounce_t *debounce, const fathom_debounce_config_t *config);

/*
 * A measurement, made at now_us. True: the level has changed (also from none to the first one, or to unknown). Times
 * may wrap; from one measurement to the next less than 71 minutes pass, or 35 where one may make the level unknown.
 *
 * verdict   FATHOM_NEAR: nearer. FATHOM_FAR: farther. Anything else: equal, as FATHOM_EQUAL_HOLDS
 * distance  a distance, 0..65535 mm
 * sample    any sample, at its time_us. Those of a switch count as their kind
 */
bool fathom_debounce_verdict(fathom_debounce_t *debounce, uint8_t verdict, uint32_t now_us);
bool fathom_debounce_distance(fathom_debounce_t *debounce, uint16_t distance_mm, uint32_t now_us);
bool fathom_debounce_sample(fathom_debounce_t *debounce, const fathom_sample_t *sample);

/* It is now_us, and no measurement has come with that. True: the level has become FATHOM_UNKNOWN. To be called so often
 * that the time between, and unknown_us, are together less than 35 minutes; a time a little before that of the last
 * measurement does no harm. */
bool fathom_debounce_time(fathom_debounce_t *debounce, uint32_t now_us);

/* What the distance is to this threshold: FATHOM_NEAR, FATHOM_FAR, or 0 where it is equal and that holds. */
uint8_t fathom_debounce_compare(const fathom_debounce_t *debounce, uint16_t distance_mm);

#ifdef __cplusplus
}
#endif

#endif
