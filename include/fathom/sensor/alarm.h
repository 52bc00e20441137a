/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_ALARM_H
#define FATHOM_ALARM_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/sample.h"
#include "fathom/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * An alarm on the distance of one probe: two thresholds, hold times, and a side to which it goes when the distance is
 * not known. For any sensor in any mode, and behind a median too.
 *
 *   static const fathom_alarm_config_t bumper = {.when = FATHOM_NEAR, .on_mm = 500, .off_mm = 600,
 *       .if_unknown = FATHOM_ALARM_ON, .if_no_response = FATHOM_ALARM_ON};
 *   status = fathom_poll(&sensor, &sample);
 *   if (status == FATHOM_READY ? fathom_alarm_sample(&alarm, &sample)
 *                              : fathom_alarm_status(&alarm, status, clock.now_us(clock.ctx)))
 *       stop_or_go(fathom_alarm_is_on(&alarm));
 *
 * The state:
 *   FATHOM_ALARM_ON            something is nearer than on_mm (when: FATHOM_NEAR), or farther (FATHOM_FAR), and has
 *                              been for on_hold_us
 *   FATHOM_ALARM_OFF           something is farther than off_mm, or nearer, and has been for off_hold_us
 *   FATHOM_ALARM_UNKNOWN       for more than unknown_us no distance has come, and by what came last the device
 *                              responds: FATHOM_UNKNOWN, FATHOM_FAULT, a value that was refused, warming up. The state
 *                              from init on, too
 *   FATHOM_ALARM_NO_RESPONSE   likewise no distance, and by what came last the device does not respond, or nothing has
 *                              come since init. (From init on unknown_us begins with the first call.)
 * Between the thresholds, and at them, the state holds. The last two are states of their own, and whether the alarm is
 * on in them is for the user to say: there is no default, since a bumper, a tank and a pit differ. From them a distance
 * leads out after its hold time, until which they stay; one between the thresholds leads at once to the state before
 * them, or where there was none to FATHOM_ALARM_ON if that is what if_unknown says, else OFF.
 *
 * A hold time runs from the first sample beyond the threshold to the sample that ends it: time alone switches neither
 * on nor off. A distance that is not beyond the threshold begins it anew, and so does unknown_us without a distance; a
 * shorter time without one does not.
 *
 * FATHOM_NO_TARGET and FATHOM_FAR are farther than every threshold, FATHOM_NEAR is nearer; with no_target_is_unknown
 * FATHOM_NO_TARGET is no distance: an ultrasonic sensor may see nothing in foam, or too near.
 *
 * It needs no clock but the times that it is given, may be called from anywhere, and does no I/O. Not a safety function.
 */

typedef enum {
    FATHOM_ALARM_ON = 1,
    FATHOM_ALARM_OFF = 2,
    FATHOM_ALARM_UNKNOWN = 3,
    FATHOM_ALARM_NO_RESPONSE = 4
} fathom_alarm_state_t;

/* A config's unknown_us of 0 means this. */
#define FATHOM_ALARM_DEFAULT_UNKNOWN_US 5000000uL

/* Read by init only. */
typedef struct {
    /* So long something has to be beyond on_mm before the alarm is on; 0: with the first sample; up to 35 minutes */
    uint32_t on_hold_us;
    uint32_t off_hold_us; /* the same with off_mm and off */
    /* After more than this without a distance it is not known: longer than it takes from one to the next. 0: 5 s; up
     * to 35 minutes */
    uint32_t unknown_us;
    uint16_t on_mm;
    uint16_t off_mm;           /* FATHOM_NEAR: on_mm or more; FATHOM_FAR: on_mm or less */
    uint8_t when;              /* FATHOM_NEAR or FATHOM_FAR */
    uint8_t if_unknown;        /* FATHOM_ALARM_ON or FATHOM_ALARM_OFF: what fathom_alarm_is_on tells then */
    uint8_t if_no_response;    /* the same */
    bool no_target_is_unknown; /* false: it is farther than every threshold */
} fathom_alarm_config_t;

typedef struct {
    fathom_alarm_config_t config;
    uint32_t fed_us;   /* the last distance; before it the first call */
    uint32_t since_us; /* the first distance of those on this side */
    uint8_t state;     /* fathom_alarm_state_t. May be read */
    uint8_t was;       /* ON or OFF, the last of them */
    /* Of the last distance: ON or OFF, beyond that threshold; 0: neither; UNKNOWN: it is more than unknown_us ago */
    uint8_t side;
    bool is_fed;   /* there has been a time */
    bool responds; /* by what came last */
} fathom_alarm_t;

/* FATHOM_ALARM_UNKNOWN. FATHOM_READY, or FATHOM_ERR_ARGUMENT: `when`, `if_unknown` or `if_no_response` is none of its
 * two, or off_mm is on the wrong side of on_mm. */
fathom_status_t fathom_alarm_init(fathom_alarm_t *alarm, const fathom_alarm_config_t *config);

/*
 * True: the state has changed. Times may wrap; the time from one call to the next and unknown_us are together less
 * than 35 minutes. A now_us a little before the last sample does no harm.
 *
 * sample   any sample of the probe, at its time_us
 * status   what came instead of a sample, at now_us:
 *          FATHOM_PENDING                   nothing: time has passed
 *          FATHOM_ERR_MALFORMED,            the device responds, and tells no distance
 *          _EXCEPTION, _WARMING_UP
 *          FATHOM_READY                     likewise: a sample of another probe, or one of which there is no median
 *          other errors                     the device does not respond
 */
bool fathom_alarm_sample(fathom_alarm_t *alarm, const fathom_sample_t *sample);
bool fathom_alarm_status(fathom_alarm_t *alarm, fathom_status_t status, uint32_t now_us);

/* Is it on, by the state or by the side that the user chose for it? */
bool fathom_alarm_is_on(const fathom_alarm_t *alarm);

#ifdef __cplusplus
}
#endif

#endif
