/* SPDX-License-Identifier: MIT */
#include "fathom/engine/trigger.h"

#include "../common.h"

enum { AGAIN_US = 1000 };

/* FATHOM_PENDING: not yet; for a second at a time, and then FATHOM_ERR_PORT. */
static fathom_status_t hold(fathom_trigger_t *trigger, bool low)
{
    const fathom_output_t *const output = &trigger->output;
    const fathom_status_t status = output->set(output->ctx, low ? FATHOM_OUTPUT_LOW : FATHOM_OUTPUT_HIGH);
    const bool was_refused = trigger->refused;
    trigger->refused = (status != FATHOM_READY) && (status != FATHOM_ERR_PORT);
    if (!trigger->refused) return status;
    const uint32_t now_us = clock_us(trigger->clock);
    if (was_refused && (fathom_elapsed_us(now_us, trigger->refused_us) < FATHOM_TRIGGER_REFUSED_US))
        return FATHOM_PENDING;
    trigger->refused_us = now_us;
    return was_refused ? FATHOM_ERR_PORT : FATHOM_PENDING;
}

fathom_status_t fathom_trigger_init(fathom_trigger_t *trigger)
{
    const fathom_output_t *const output = &trigger->output;
    if (output->set == NULL) return FATHOM_ERR_ARGUMENT;
    if (trigger->low_us == 0u) trigger->low_us = FATHOM_TRIGGER_DEFAULT_LOW_US;
    trigger->low = false;
    trigger->refused = false;
    trigger->polled_us = clock_us(trigger->clock);
    trigger->left_us = trigger->low_us;
    return output->set(output->ctx, FATHOM_OUTPUT_REST);
}

void fathom_trigger_look(fathom_trigger_t *trigger)
{
    const uint32_t now_us = clock_us(trigger->clock);
    (void)fathom_count_down(&trigger->left_us, fathom_elapsed_us(now_us, trigger->polled_us));
    trigger->polled_us = now_us;
}

/* Of the low time, at the last look. */
static uint32_t low_left_us(const fathom_trigger_t *trigger)
{
    return rest_us(trigger->left_us, trigger->period_us - trigger->low_us);
}

fathom_status_t fathom_trigger_drive(fathom_trigger_t *trigger, bool may_begin)
{
    const bool was_low = trigger->low;
    if (was_low ? (low_left_us(trigger) != 0u) : (!may_begin || (trigger->left_us != 0u)))
        return FATHOM_PENDING;
    const fathom_status_t status = hold(trigger, !was_low);
    if (status != FATHOM_READY) return status;
    trigger->low = !was_low;
    if (!was_low) {
        trigger->polled_us = clock_us(trigger->clock);
        trigger->left_us = trigger->period_us;
        return FATHOM_READY;
    }
    /* Some high time must follow, or the next falling edge could be missed. */
    if (trigger->left_us < trigger->low_us) trigger->left_us = trigger->low_us;
    return FATHOM_PENDING;
}

uint32_t fathom_trigger_due_us(const fathom_trigger_t *trigger, uint32_t until_us)
{
    if (trigger->low) until_us = least_us(until_us, low_left_us(trigger));
    if (until_us == 0u) until_us = AGAIN_US;
    return rest_us(until_us, fathom_elapsed_us(clock_us(trigger->clock), trigger->polled_us));
}

fathom_status_t fathom_trigger_deinit(fathom_trigger_t *trigger)
{
    const fathom_status_t status = trigger->low ? hold(trigger, false) : FATHOM_READY;
    if (status == FATHOM_READY) trigger->low = false;
    return status;
}
