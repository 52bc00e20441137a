/* SPDX-License-Identifier: MIT */
#include "fathom/engine/trigger.h"

#include "../common.h"

/*
 * The falling edges that trigger a sensor. A trigger keeps the low time, the period, and a limit on how long
 * its output may refuse.
 */

enum { AGAIN_US = 1000 };

/* Sets the output, and limits how long it may refuse. */
static fathom_status_t set_level(fathom_trigger_t *trigger, uint8_t level)
{
    const fathom_output_t *const output = &trigger->output;
    const fathom_status_t status = output->set(output->ctx, level);
    const bool was_refused = trigger->refused;
    trigger->refused = (status != FATHOM_OK) && (status != FATHOM_ERR_PORT);
    if (!trigger->refused) return status;
    const uint32_t now_us = clock_us(trigger->clock);
    if (was_refused && (time_since_us(now_us, trigger->refused_us) < FATHOM_TRIGGER_REFUSED_US))
        return FATHOM_PENDING;
    trigger->refused_us = now_us;
    return was_refused ? FATHOM_ERR_PORT : FATHOM_PENDING;
}

fathom_status_t fathom_trigger_init(fathom_trigger_t *trigger)
{
    const fathom_output_t *const output = &trigger->output;
    if (trigger->low_us == 0u) trigger->low_us = FATHOM_TRIGGER_DEFAULT_LOW_US;
    if ((output->set == NULL) || !is_clock(trigger->clock) || (trigger->low_us > FATHOM_TRIGGER_MAX_LOW_US) ||
        (trigger->period_us <= trigger->low_us) || (trigger->period_us > FATHOM_MAX_DURATION_US))
        return FATHOM_ERR_ARGUMENT;
    trigger->low = false;
    trigger->refused = false;
    trigger->polled_us = clock_us(trigger->clock);
    trigger->left_us = trigger->low_us;
    return output->set(output->ctx, FATHOM_OUTPUT_REST);
}

void fathom_trigger_update(fathom_trigger_t *trigger)
{
    const uint32_t now_us = clock_us(trigger->clock);
    (void)fathom_count_down(&trigger->left_us, time_since_us(now_us, trigger->polled_us));
    trigger->polled_us = now_us;
}

/* Time until the output may rise, at the last update. */
static uint32_t low_left_us(const fathom_trigger_t *trigger)
{
    return rest_us(trigger->left_us, trigger->period_us - trigger->low_us);
}

fathom_status_t fathom_trigger_drive(fathom_trigger_t *trigger, bool may_begin)
{
    const bool was_low = trigger->low;
    const bool is_due = was_low ? (low_left_us(trigger) == 0u) : (may_begin && (trigger->left_us == 0u));
    if (!is_due) return FATHOM_PENDING;
    const fathom_status_t status = set_level(trigger, was_low ? FATHOM_OUTPUT_HIGH : FATHOM_OUTPUT_LOW);
    if (status != FATHOM_OK) return status;
    trigger->low = !was_low;
    if (!was_low) {
        trigger->polled_us = clock_us(trigger->clock);
        trigger->left_us = trigger->period_us;
        return FATHOM_OK;
    }
    /* The sensor could miss the next falling edge without a high time in front of it. */
    if (trigger->left_us < trigger->low_us) trigger->left_us = trigger->low_us;
    return FATHOM_PENDING;
}

uint32_t fathom_trigger_due_us(const fathom_trigger_t *trigger, uint32_t until_us)
{
    if (trigger->low) until_us = least_us(until_us, low_left_us(trigger));
    if (until_us == 0u) until_us = AGAIN_US;
    return rest_us(until_us, time_since_us(clock_us(trigger->clock), trigger->polled_us));
}

fathom_status_t fathom_trigger_deinit(fathom_trigger_t *trigger)
{
    const fathom_status_t status = trigger->low ? set_level(trigger, FATHOM_OUTPUT_HIGH) : FATHOM_OK;
    if (status == FATHOM_OK) trigger->low = false;
    return status;
}
