/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_CONTACT_H
#define FATHOM_CONTACT_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/engine/sensor.h"
#include "fathom/hal.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * A level that a sensor drives: what a16_switch.h and a05_relay.h are built on, and what reads any other switch.
 *
 * Each poll reads the pin once, which is a look; what the level does between two looks is not seen. A level counts
 * when it was the same at every look for settle_us; then, if it is new, there is a sample. Between two looks less than
 * 71 minutes pass.
 */

/* Zero-valued members of the timing mean these. */
#define FATHOM_CONTACT_DEFAULT_SETTLE_US   20000u
#define FATHOM_CONTACT_DEFAULT_INTERVAL_US 10000u
#define FATHOM_CONTACT_DEFAULT_STALE_US    2000000u

/* After the last byte of a line on the same pin. More than a character at 9600 baud, which a look could hit. Where the
 * guard is not clear, the next look is due in as long. */
#define FATHOM_CONTACT_QUIET_US 5000u

/* Members that are 0 mean their defaults. */
typedef struct {
    /* How long a level stands before it counts: longer than a contact bounces, and than a response on the pin takes.
     * 0: 20 ms; 1: two looks are enough. */
    uint32_t settle_us;
    /* A sample that repeats the level, so long after the last one. 0: changes alone. */
    uint32_t period_us;
    /* The longest that due_us advises between looks; FATHOM_NO_DEADLINE where an interrupt of the pin wakes the
     * program. 0: 10 ms. */
    uint32_t interval_us;
    /* FATHOM_ERR_STALE when no level has counted for so long. 0: 2 s. */
    uint32_t stale_us;
} fathom_contact_timing_t;

/* What else uses the pin, and when its level means nothing; line_pins.h makes one of a line. Outlives the contact. */
typedef struct {
    /* Before each look; FATHOM_PENDING, or the error that the contact's poll returns where it has nothing else. */
    fathom_status_t (*poll)(void *ctx);
    bool (*is_clear)(void *ctx, uint32_t now_us); /* does the level mean anything now? */
    uint32_t (*due_us)(void *ctx);                /* until poll has something to do, as fathom_due_us */
    void *ctx;
} fathom_contact_guard_t;

typedef struct {
    /* Set by the caller before init, which keeps the pointers. */
    const fathom_pin_t *pin; /* an input */
    const fathom_clock_t *clock;
    const fathom_contact_guard_t *guard; /* NULL: nothing else stands on the pin */
    bool near_is_high;                   /* what a high level means: FATHOM_NEAR, or FATHOM_FAR */
    uint8_t model;                       /* of the samples; fathom_model_t */
    uint8_t address;                     /* of the samples */

    /* The engine's. */
    fathom_contact_timing_t timing;
    uint32_t sampled_us;
    uint32_t since_us;  /* the first look at which the present level stood */
    uint32_t settle_us; /* until it counts */
    uint32_t period_us; /* until the next sample */
    uint32_t stale_us;  /* until it is stale */
    uint16_t sequence;
    uint8_t last_kind; /* kind of the last sample; 0: none yet */
    bool is_high;      /* the level at the last look */
    bool is_clear;     /* the guard was clear then */
    bool is_held;
} fathom_contact_t;

/* FATHOM_READY, or FATHOM_ERR_ARGUMENT: no clock, or no pin that can be read. It reads the pin once, and copies
 * timing. */
fathom_status_t fathom_contact_init(fathom_contact_t *contact, const fathom_contact_timing_t *timing);

/* What a high level means from now on. The level settles anew; without a new meaning there is no sample. */
void fathom_contact_set_near_is_high(fathom_contact_t *contact, bool near_is_high);

/* While it is held (true) the level does not count: it is about to mean something else. Then it settles anew. */
void fathom_contact_hold(fathom_contact_t *contact, bool hold);

/*
 * For fathom_poll. Each poll is one look, and one poll of the guard.
 * FATHOM_READY       a sample: the first level that counts, a new one, or the period is over. raw is the level, 1
 *                    for high; time_us is the look at which it was first seen, or the present one when it repeats
 * FATHOM_PENDING     nothing new; the level may be settling, or the guard at work
 * FATHOM_ERR_STALE   no level has counted for stale_us: it never stands still, the guard is never clear, or it is
 *                    held; returned once every stale_us
 * FATHOM_ERR_PORT    the port of the guard's line is broken; returned by every poll that has nothing else
 * A cut wire is no error: it reads as the level that the board pulls it to. fathom_due_us says when the next look
 * makes sense: in interval_us at the latest, sooner while a level settles.
 */
fathom_sensor_t fathom_contact_sensor(fathom_contact_t *contact);

#ifdef __cplusplus
}
#endif

#endif
