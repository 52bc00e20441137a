/* SPDX-License-Identifier: MIT */
#include "fathom/engine/contact.h"

#include "../common.h"

/*
 * A level that a sensor drives, as samples. One poll is one look at the pin:
 *
 *   level   ______|~|_|~~~~~~~~~~~~~~~~~~~~~~~~~~~
 *   looks    .  .  .  .  .  .  .  .  .  .  .  .  .
 *                     |<-settle_us->|               since_us is the first of these looks
 *                                   sample          the level counts
 *                                   |<-period_us->|
 *                                                 sample (the same level again)
 *
 * A level counts while it was equal at every look for settle_us, and no guard or hold forbade one of the looks. Two
 * limits end every wait: period_us while the level counts, and stale_us while it does not.
 */

static bool is_high_now(const fathom_contact_t *contact)
{
    const fathom_pin_t *const pin = contact->pin;
    return pin->get(pin->ctx);
}

static void settle(fathom_contact_t *contact)
{
    contact->since_us = contact->sampled_us;
    contact->settle_us = contact->timing.settle_us;
}

static bool is_initialised(const fathom_contact_t *contact) { return contact->timing.interval_us != 0u; }

static bool can_be_read(const fathom_contact_t *contact)
{
    const fathom_pin_t *const pin = contact->pin;
    const fathom_contact_guard_t *const guard = contact->guard;
    return (pin != NULL) && (pin->get != NULL) && is_clock(contact->clock) &&
           ((guard == NULL) ||
            ((guard->poll != NULL) && (guard->is_clear != NULL) && (guard->due_us != NULL)));
}

/* Copies the timing. Returns true if each member is inside its range. */
static bool configure(fathom_contact_timing_t *own, const fathom_contact_timing_t *timing)
{
    own->settle_us = or_default(timing->settle_us, FATHOM_CONTACT_DEFAULT_SETTLE_US);
    own->period_us = or_default(timing->period_us, FATHOM_CONTACT_DEFAULT_PERIOD_US);
    own->interval_us = or_default(timing->interval_us, FATHOM_CONTACT_DEFAULT_INTERVAL_US);
    own->stale_us = or_default(timing->stale_us, FATHOM_CONTACT_DEFAULT_STALE_US);
    return (own->settle_us < own->stale_us) && (own->period_us <= FATHOM_MAX_DURATION_US) &&
           (own->stale_us <= FATHOM_MAX_DURATION_US) &&
           ((own->interval_us <= FATHOM_MAX_DURATION_US) || (own->interval_us == FATHOM_NO_DEADLINE));
}

fathom_status_t fathom_contact_init(fathom_contact_t *contact, const fathom_contact_timing_t *timing)
{
    if (!can_be_read(contact) || !configure(&contact->timing, timing)) {
        clear(contact, sizeof *contact);
        return FATHOM_ERR_ARGUMENT;
    }
    contact->sampled_us = clock_us(contact->clock);
    contact->is_high = is_high_now(contact);
    contact->is_clear = contact->guard == NULL;
    contact->is_held = false;
    contact->period_us = contact->timing.period_us;
    contact->stale_us = contact->timing.stale_us;
    contact->sequence = 0;
    contact->last_kind = 0;
    settle(contact);
    return FATHOM_OK;
}

void fathom_contact_set_near_is_high(fathom_contact_t *contact, bool near_is_high)
{
    contact->near_is_high = near_is_high;
    settle(contact);
}

void fathom_contact_set_hold(fathom_contact_t *contact, bool hold) { contact->is_held = hold; }

/* Returns true if the level at this look has a meaning. */
static bool is_clear(const fathom_contact_t *contact)
{
    const fathom_contact_guard_t *const guard = contact->guard;
    return !contact->is_held && ((guard == NULL) || guard->is_clear(guard->ctx, contact->sampled_us));
}

/* Reads the pin. Returns true if the level counts. */
static bool look(fathom_contact_t *contact, uint32_t passed_us)
{
    const bool was_clear = contact->is_clear;
    const bool was_high = contact->is_high;
    contact->is_clear = is_clear(contact);
    contact->is_high = is_high_now(contact);
    if (was_clear && contact->is_clear && (contact->is_high == was_high))
        return fathom_count_down(&contact->settle_us, passed_us);
    settle(contact);
    return false;
}

/* The time at which this level was first seen, unless that is too long ago or the level was reported then. */
static uint32_t time_of(const fathom_contact_t *contact, uint8_t kind)
{
    const bool is_repeated = kind == contact->last_kind;
    const bool is_old = time_since_us(contact->sampled_us, contact->since_us) > contact->timing.stale_us;
    return (is_repeated || is_old) ? contact->sampled_us : contact->since_us;
}

static void set_sample(fathom_contact_t *contact, uint8_t kind, fathom_sample_t *sample)
{
    sample->time_us = time_of(contact, kind);
    sample->magnitude = 0;
    sample->raw = contact->is_high;
    contact->sequence++;
    sample->sequence = contact->sequence;
    sample->distance_mm = 0;
    sample->precision = 0;
    sample->kind = kind;
    sample->model = contact->model;
    sample->address = contact->address;
    sample->probe = 1;
    sample->ambient = 0;
    sample->interference = false;
    contact->last_kind = kind;
    contact->period_us = contact->timing.period_us;
}

fathom_status_t fathom_contact_sensor_poll(void *ctx, fathom_sample_t *sample)
{
    fathom_contact_t *const contact = ctx;
    const fathom_contact_guard_t *const guard = contact->guard;
    if (!is_initialised(contact)) return FATHOM_ERR_ARGUMENT;
    const fathom_status_t guarded = (guard != NULL) ? guard->poll(guard->ctx) : FATHOM_PENDING;
    const uint32_t now_us = clock_us(contact->clock);
    const uint32_t passed_us = time_since_us(now_us, contact->sampled_us);
    /* The level counted until the previous look. When it changed between the two looks is not known. */
    const bool counted = contact->settle_us == 0u;
    const bool is_period_over = fathom_count_down(&contact->period_us, passed_us);
    contact->sampled_us = now_us;
    if (counted) contact->stale_us = contact->timing.stale_us;
    if (look(contact, passed_us)) {
        const uint8_t kind = (contact->is_high == contact->near_is_high) ? FATHOM_NEAR : FATHOM_FAR;
        if ((kind != contact->last_kind) || is_period_over) {
            set_sample(contact, kind, sample);
            return FATHOM_OK;
        }
    } else if (!counted && fathom_count_down(&contact->stale_us, passed_us)) {
        contact->stale_us = contact->timing.stale_us;
        return FATHOM_ERR_STALE;
    }
    return guarded;
}

uint32_t fathom_contact_sensor_due_us(void *ctx)
{
    const fathom_contact_t *const contact = ctx;
    const fathom_contact_guard_t *const guard = contact->guard;
    uint32_t until_us = contact->timing.interval_us;
    if (!is_initialised(contact)) return 0;
    if (!contact->is_clear)
        until_us = least_us(until_us, FATHOM_CONTACT_QUIET_US);
    else if (contact->settle_us != 0u)
        until_us = least_us(until_us, contact->settle_us);
    else
        until_us = least_us(until_us, contact->period_us);
    until_us = rest_us(until_us, time_since_us(clock_us(contact->clock), contact->sampled_us));
    return (guard != NULL) ? least_us(until_us, guard->due_us(guard->ctx)) : until_us;
}
