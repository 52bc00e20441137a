/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_A05_RELAY_H
#define FATHOM_A05_RELAY_H

#include "fathom/engine/contact.h"
#include "fathom/engine/sensor.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * A05 with relay output (A05 4): its relay closes when any of its four probes has something nearer than the
 * threshold, 1 m from the factory, and each state lasts about 1 s. The threshold is taught on the board, with a
 * button and a flat target before probe 4 (A05 4(2)); nothing can be read or set from here. a05_relay_rule.h is
 * the same rule in software, for an A05 in any other mode.
 *
 * A sample for the first state and for each new one: FATHOM_NEAR or FATHOM_FAR, without a distance or a probe (the
 * relay does not tell which); time_us is when it was first seen, raw is the level of the pin. The errors of
 * fathom_poll:
 *   FATHOM_ERR_STALE  the contact has not stood still for settle_us in stale_us: noise, a worn or a loose contact
 *
 * A contact cannot say "no response". With the normally open one, a cut wire and a module without power look like
 * FATHOM_FAR. With the normally closed one a cut wire looks like FATHOM_NEAR; a module without power still looks
 * like FATHOM_FAR, since its relay has dropped. Choose by what must not happen.
 */

/* Which contact is wired. The common end goes to the other pole. */
typedef enum {
    FATHOM_A05_RELAY_NORMALLY_OPEN = 1,  /* conducts when something is near */
    FATHOM_A05_RELAY_NORMALLY_CLOSED = 2 /* conducts when nothing is */
} fathom_a05_relay_wiring_t;

/* The level of the pin while the contact conducts. */
typedef enum {
    FATHOM_A05_RELAY_CONDUCTS_LOW = 1, /* the contact goes to ground, a resistor pulls the pin up */
    FATHOM_A05_RELAY_CONDUCTS_HIGH = 2 /* the contact goes to the supply, a resistor pulls the pin down */
} fathom_a05_relay_level_t;

/* Read by init only; pin and clock outlive the sensor. Members that are 0 mean their defaults. */
typedef struct {
    const fathom_pin_t *pin;
    const fathom_clock_t *clock;
    fathom_contact_timing_t timing; /* contact.h: how long a level stands, and so on */
    uint8_t wiring;                 /* fathom_a05_relay_wiring_t; 0: normally open */
    uint8_t level;                  /* fathom_a05_relay_level_t; 0: low while it conducts */
} fathom_a05_relay_config_t;

typedef struct {
    fathom_contact_t base;
} fathom_a05_relay_t;

/* FATHOM_READY, or FATHOM_ERR_ARGUMENT: no clock, no pin that can be read, no such wiring or level. */
fathom_status_t fathom_a05_relay_init(fathom_a05_relay_t *sensor, const fathom_a05_relay_config_t *config);

/* For fathom_poll. There is nothing to undo: forget the sensor when it is no longer polled. */
fathom_sensor_t fathom_a05_relay_sensor(fathom_a05_relay_t *sensor);

#ifdef __cplusplus
}
#endif

#endif
