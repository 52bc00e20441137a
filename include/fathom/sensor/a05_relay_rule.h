/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_A05_RELAY_RULE_H
#define FATHOM_A05_RELAY_RULE_H

#include "fathom/engine/debounce.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * The rule of the A05's relay (A05 4) in software, over the four distances of an A05 in any other mode: the relay
 * closes when at least one probe has something nearer than the threshold, and each state lasts at least 1 s.
 *
 *   if (fathom_poll(&bumper, &sample) == FATHOM_READY && fathom_a05_relay_rule_sample(&rule, &sample))
 *       stop_or_go(rule.debounce.level);
 *   if (fathom_debounce_time(&rule.debounce, clock.now_us(clock.ctx))) stop();
 *
 * All samples of one sequence number are one measurement:
 *  - it is nearer as soon as one fitted probe is, without waiting for the others;
 *  - it is farther when every fitted probe has given a sample and all of them are;
 *  - it is equal, and the level holds, when none is nearer and some stand at the threshold;
 *  - it is nothing, and the level holds until it becomes unknown (debounce.h), when a probe's sample is missing
 *    (refused, not read), unknown or a fault, and none of the others is nearer: what stands before that one is not
 *    known.
 * So one probe that is near closes the relay, whatever the others say. Probes that are not fitted count for nothing:
 * their values are not defined. What else counts as what stands in debounce.h. One sensor a rule.
 */

/* The threshold's range and its factory setting, mm, and how long a state lasts at least (A05 4). */
enum { FATHOM_A05_RELAY_MIN_MM = 250, FATHOM_A05_RELAY_MAX_MM = 4500, FATHOM_A05_RELAY_DEFAULT_MM = 1000 };
#define FATHOM_A05_RELAY_HOLD_US 1000000uL

/* Read by init only. Members that are 0 mean their defaults. */
typedef struct {
    /* Each state lasts at least so long: "pull-in and cut-off time will be maintained for 1 second" (A05 4(1)) is read
     * so. 0: 1 s; 1: as good as none. */
    uint32_t hold_us;
    uint32_t unknown_us;   /* so long after the last measurement that counted the level is unknown; 0: 5 s */
    uint16_t threshold_mm; /* 250..4500; 0: 1000 mm */
    uint8_t probes;        /* bit probe - 1: fitted, and read by the sensor's driver; 0: all four */
    uint8_t equal;         /* fathom_equal_t */
} fathom_a05_relay_rule_config_t;

typedef struct {
    /* debounce.level may be read: FATHOM_NEAR is closed; FATHOM_UNKNOWN is an error, and 0 not known yet, which a relay
     * without power shows as open. */
    fathom_debounce_t debounce;
    uint16_t sequence; /* of the measurement under way */
    uint8_t probes;
    uint8_t missing; /* bit probe - 1: has not been seen in it */
    uint8_t verdict; /* on it so far */
} fathom_a05_relay_rule_t;

/* FATHOM_READY, or FATHOM_ERR_ARGUMENT: a threshold out of range, a probe over 4, or no such `equal`. */
fathom_status_t fathom_a05_relay_rule_init(fathom_a05_relay_rule_t *rule,
                                           const fathom_a05_relay_rule_config_t *config);

/* The sensor's next sample. True: the level has changed (also from none to the first one). Its time is the
 * sample's. */
bool fathom_a05_relay_rule_sample(fathom_a05_relay_rule_t *rule, const fathom_sample_t *sample);

#ifdef __cplusplus
}
#endif

#endif
