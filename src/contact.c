/* SPDX-License-Identifier: MIT */
#include "fathom/contact.h"

static uint32_t now_us(const fathom_contact_t *contact)
{
    const fathom_clock_t *const clock = contact->clock;
    return clock->now_us(clock->ctx);
}

static bool is_high_now(const fathom_contact_t *contact)
{
    const fathom_pin_t *const pin = contact->pin;
    return pin->get(pin->ctx);
}

static void settle(fathom_contact_t *contact)
{
    contact->since_us = contact->looked_us;
    contact->settle_us = contact->timing.settle_us;
}

static uint32_t or_else(uint32_t us, uint32_t default_us) { return us != 0 ? us : default_us; }

fathom_status_t fathom_contact_init(fathom_contact_t *contact, const fathom_contact_timing_t *timing)
{
    fathom_contact_timing_t *const own = &contact->timing;
    if (contact->pin == NULL || contact->pin->get == NULL || contact->clock == NULL)
        return FATHOM_ERR_ARGUMENT;
    own->settle_us = or_else(timing->settle_us, FATHOM_CONTACT_DEFAULT_SETTLE_US);
    own->period_us = timing->period_us;
    own->look_us = or_else(timing->look_us, FATHOM_CONTACT_DEFAULT_LOOK_US);
    own->stale_us = or_else(timing->stale_us, FATHOM_CONTACT_DEFAULT_STALE_US);
    contact->looked_us = now_us(contact);
    contact->is_high = is_high_now(contact);
    contact->is_clear = contact->line == NULL;
    contact->is_held = false;
    contact->period_us = own->period_us;
    contact->stale_us = own->stale_us;
    contact->sequence = 0;
    contact->said = 0;
    settle(contact);
    return FATHOM_READY;
}

void fathom_contact_set_near_is_high(fathom_contact_t *contact, bool near_is_high)
{
    contact->near_is_high = near_is_high;
    settle(contact);
}

void fathom_contact_hold(fathom_contact_t *contact, bool hold) { contact->is_held = hold; }

/* Does the level mean what it should, as far as the line on the same pin is concerned, if there is one? */
static bool is_clear(const fathom_contact_t *contact)
{
    const fathom_line_t *const line = contact->line;
    if (contact->is_held) return false;
    return line == NULL ||
           (fathom_line_is_idle(line) &&
            fathom_elapsed_us(contact->looked_us, fathom_line_heard_us(line)) >= FATHOM_CONTACT_QUIET_US);
}

/* Does the level count? */
static bool look(fathom_contact_t *contact, uint32_t passed_us)
{
    const bool was_clear = contact->is_clear;
    const bool was_high = contact->is_high;
    contact->is_clear = is_clear(contact);
    contact->is_high = is_high_now(contact);
    if (was_clear && contact->is_clear && contact->is_high == was_high)
        return fathom_run_down(&contact->settle_us, passed_us);
    settle(contact);
    return false;
}

static void say(fathom_contact_t *contact, uint8_t kind, fathom_sample_t *sample)
{
    sample->time_us = kind == contact->said ? contact->looked_us : contact->since_us;
    sample->magnitude = 0;
    sample->raw = contact->is_high;
    sample->sequence = ++contact->sequence;
    sample->distance_mm = 0;
    sample->precision = 0;
    sample->kind = kind;
    sample->model = contact->model;
    sample->unit = contact->unit;
    sample->probe = 1;
    sample->ambient = 0;
    sample->interference = false;
    contact->said = kind;
    contact->period_us = contact->timing.period_us;
}

static fathom_status_t poll(void *ctx, fathom_sample_t *sample)
{
    fathom_contact_t *const contact = ctx;
    const fathom_contact_timing_t *const timing = &contact->timing;
    const fathom_status_t port = contact->line != NULL ? fathom_line_poll(contact->line) : FATHOM_PENDING;
    const uint32_t now = now_us(contact);
    const uint32_t passed_us = fathom_elapsed_us(now, contact->looked_us);
    /* Until the look before this one all was well, and how long ago it ceased to be nobody knows. */
    const bool counted = contact->settle_us == 0;
    const bool repeats = fathom_run_down(&contact->period_us, passed_us) && timing->period_us != 0;
    contact->looked_us = now;
    if (counted) contact->stale_us = timing->stale_us;
    if (look(contact, passed_us)) {
        const uint8_t kind = contact->is_high == contact->near_is_high ? FATHOM_NEAR : FATHOM_FAR;
        if (kind != contact->said || repeats) {
            say(contact, kind, sample);
            return FATHOM_READY;
        }
    } else if (!counted && fathom_run_down(&contact->stale_us, passed_us)) {
        contact->stale_us = timing->stale_us;
        return FATHOM_ERR_STALE;
    }
    return port;
}

static uint32_t least(uint32_t a, uint32_t b) { return a < b ? a : b; }

static uint32_t due_us(void *ctx)
{
    const fathom_contact_t *const contact = ctx;
    const fathom_contact_timing_t *const timing = &contact->timing;
    uint32_t us = timing->look_us;
    if (!contact->is_clear)
        us = least(us, FATHOM_CONTACT_QUIET_US);
    else if (contact->settle_us != 0)
        us = least(us, contact->settle_us);
    else if (timing->period_us != 0)
        us = least(us, contact->period_us);
    if (us != FATHOM_NO_DEADLINE) {
        const uint32_t passed_us = fathom_elapsed_us(now_us(contact), contact->looked_us);
        us = us > passed_us ? us - passed_us : 0;
    }
    return contact->line != NULL ? least(us, fathom_line_due_us(contact->line)) : us;
}

fathom_sensor_t fathom_contact_sensor(fathom_contact_t *contact)
{
    fathom_sensor_t handle;
    handle.poll = poll;
    handle.due_us = due_us;
    handle.ctx = contact;
    return handle;
}
