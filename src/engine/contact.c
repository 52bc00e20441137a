/* SPDX-License-Identifier: MIT */
#include "fathom/engine/contact.h"

#include "../common.h"

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

fathom_status_t fathom_contact_init(fathom_contact_t *contact, const fathom_contact_timing_t *timing)
{
    fathom_contact_timing_t *const own = &contact->timing;
    if ((contact->pin == NULL) || (contact->pin->get == NULL) || (contact->clock == NULL))
        return FATHOM_ERR_ARGUMENT;
    own->settle_us = or_default(timing->settle_us, FATHOM_CONTACT_DEFAULT_SETTLE_US);
    own->period_us = timing->period_us;
    own->interval_us = or_default(timing->interval_us, FATHOM_CONTACT_DEFAULT_INTERVAL_US);
    own->stale_us = or_default(timing->stale_us, FATHOM_CONTACT_DEFAULT_STALE_US);
    contact->sampled_us = clock_us(contact->clock);
    contact->is_high = is_high_now(contact);
    contact->is_clear = contact->guard == NULL;
    contact->is_held = false;
    contact->period_us = own->period_us;
    contact->stale_us = own->stale_us;
    contact->sequence = 0;
    contact->last_kind = 0;
    settle(contact);
    return FATHOM_READY;
}

void fathom_contact_set_near_is_high(fathom_contact_t *contact, bool near_is_high)
{
    contact->near_is_high = near_is_high;
    settle(contact);
}

void fathom_contact_hold(fathom_contact_t *contact, bool hold) { contact->is_held = hold; }

/* Does the level mean anything now? */
static bool is_clear(const fathom_contact_t *contact)
{
    const fathom_contact_guard_t *const guard = contact->guard;
    return !contact->is_held && ((guard == NULL) || guard->is_clear(guard->ctx, contact->sampled_us));
}

/* Does the level count? */
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

static void set_sample(fathom_contact_t *contact, uint8_t kind, fathom_sample_t *sample)
{
    sample->time_us = (kind == contact->last_kind) ? contact->sampled_us : contact->since_us;
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

static fathom_status_t poll(void *ctx, fathom_sample_t *sample)
{
    fathom_contact_t *const contact = ctx;
    const fathom_contact_timing_t *const timing = &contact->timing;
    const fathom_contact_guard_t *const guard = contact->guard;
    const fathom_status_t beside = (guard != NULL) ? guard->poll(guard->ctx) : FATHOM_PENDING;
    const uint32_t now_us = clock_us(contact->clock);
    const uint32_t passed_us = fathom_elapsed_us(now_us, contact->sampled_us);
    /* The level counted until the look before this one; when it ceased to is not known. */
    const bool counted = contact->settle_us == 0u;
    const bool repeats = fathom_count_down(&contact->period_us, passed_us) && (timing->period_us != 0u);
    contact->sampled_us = now_us;
    if (counted) contact->stale_us = timing->stale_us;
    if (look(contact, passed_us)) {
        const uint8_t kind = (contact->is_high == contact->near_is_high) ? FATHOM_NEAR : FATHOM_FAR;
        if ((kind != contact->last_kind) || repeats) {
            set_sample(contact, kind, sample);
            return FATHOM_READY;
        }
    } else if (!counted && fathom_count_down(&contact->stale_us, passed_us)) {
        contact->stale_us = timing->stale_us;
        return FATHOM_ERR_STALE;
    }
    return beside;
}

static uint32_t due_us(void *ctx)
{
    const fathom_contact_t *const contact = ctx;
    const fathom_contact_timing_t *const timing = &contact->timing;
    const fathom_contact_guard_t *const guard = contact->guard;
    uint32_t us = timing->interval_us;
    if (!contact->is_clear)
        us = least_us(us, FATHOM_CONTACT_QUIET_US);
    else if (contact->settle_us != 0u)
        us = least_us(us, contact->settle_us);
    else if (timing->period_us != 0u)
        us = least_us(us, contact->period_us);
    if (us != FATHOM_NO_DEADLINE)
        us = rest_us(us, fathom_elapsed_us(clock_us(contact->clock), contact->sampled_us));
    return (guard != NULL) ? least_us(us, guard->due_us(guard->ctx)) : us;
}

fathom_sensor_t fathom_contact_sensor(fathom_contact_t *contact) { return sensor_of(poll, due_us, contact); }
