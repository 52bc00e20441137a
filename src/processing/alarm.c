/* SPDX-License-Identifier: MIT */
#include "fathom/processing/alarm.h"

#include "../common.h"

/*
 * An alarm on a distance. Each sample is on one side of the thresholds; this file keeps the hold times and
 * notices a time without a distance.
 */

/* A fourth value of `side`: the distance is between the thresholds, or at one of them. */
enum { BETWEEN = 0 };

static bool is_side(uint8_t state) { return (state == FATHOM_ALARM_ON) || (state == FATHOM_ALARM_OFF); }

/* Returns the nearer threshold. Which of the two switches on depends on `when`. */
static uint16_t nearer_mm(const fathom_alarm_config_t *config)
{
    return (config->when == FATHOM_NEAR) ? config->on_mm : config->off_mm;
}

static uint16_t farther_mm(const fathom_alarm_config_t *config)
{
    return (config->when == FATHOM_NEAR) ? config->off_mm : config->on_mm;
}

static bool is_configuration(const fathom_alarm_config_t *config)
{
    return ((config->when == FATHOM_NEAR) || (config->when == FATHOM_FAR)) && is_side(config->if_unknown) &&
           is_side(config->if_no_response) && (nearer_mm(config) <= farther_mm(config)) &&
           (config->on_hold_us <= FATHOM_MAX_DURATION_US) &&
           (config->off_hold_us <= FATHOM_MAX_DURATION_US) && (config->unknown_us <= FATHOM_MAX_DURATION_US);
}

fathom_status_t fathom_alarm_init(fathom_alarm_t *alarm, const fathom_alarm_config_t *config)
{
    clear(alarm, sizeof *alarm);
    if (!is_configuration(config)) return FATHOM_ERR_ARGUMENT;
    copy(&alarm->config, config, sizeof alarm->config);
    alarm->config.unknown_us = or_default(config->unknown_us, FATHOM_ALARM_DEFAULT_UNKNOWN_US);
    alarm->state = FATHOM_ALARM_UNKNOWN;
    alarm->was = config->if_unknown;
    return FATHOM_OK;
}

static bool is_initialised(const fathom_alarm_t *alarm) { return alarm->state != 0u; }

/* Returns the side on which a sample is, or FATHOM_ALARM_UNKNOWN if the sample has no distance. */
static uint8_t side_of(const fathom_alarm_config_t *config, const fathom_sample_t *sample)
{
    uint8_t kind = sample->kind;
    if ((kind == FATHOM_NO_TARGET) && !config->no_target_is_unknown) kind = FATHOM_FAR;
    if (kind == FATHOM_TARGET) {
        if (sample->distance_mm < nearer_mm(config))
            kind = FATHOM_NEAR;
        else if (sample->distance_mm > farther_mm(config))
            kind = FATHOM_FAR;
        else
            return BETWEEN;
    }
    if ((kind != FATHOM_NEAR) && (kind != FATHOM_FAR)) return FATHOM_ALARM_UNKNOWN;
    return (kind == config->when) ? FATHOM_ALARM_ON : FATHOM_ALARM_OFF;
}

/* Returns true if the last distance is more than unknown_us ago. */
static bool is_too_long(fathom_alarm_t *alarm, uint32_t now_us)
{
    if (alarm->side == FATHOM_ALARM_UNKNOWN) return true; /* No distance has arrived since. */
    if (!alarm->is_fed) alarm->fed_us = now_us;
    alarm->is_fed = true;
    const uint32_t passed_us = fathom_elapsed_us(now_us, alarm->fed_us);
    /* A difference above half of what the clock counts is a time before the distance. */
    return (passed_us > alarm->config.unknown_us) && (passed_us <= (UINT32_MAX / 2u));
}

static void look_at_time(fathom_alarm_t *alarm, uint32_t now_us)
{
    if (!is_too_long(alarm, now_us)) return;
    alarm->side = FATHOM_ALARM_UNKNOWN;
    alarm->state = alarm->responds ? FATHOM_ALARM_UNKNOWN : FATHOM_ALARM_NO_RESPONSE;
}

bool fathom_alarm_add_status(fathom_alarm_t *alarm, fathom_status_t status, uint32_t now_us)
{
    const uint8_t before = alarm->state;
    if (!is_initialised(alarm)) return false;
    /* A busy line and another master prove nothing about the device, and neither does time that passes. */
    const bool is_of_device =
        (status != FATHOM_PENDING) && (status != FATHOM_ERR_LINE_BUSY) && (status != FATHOM_ERR_OTHER_MASTER);
    if (is_of_device)
        alarm->responds = (status == FATHOM_OK) || (status == FATHOM_ERR_MALFORMED) ||
                          (status == FATHOM_ERR_EXCEPTION) || (status == FATHOM_ERR_WARMING_UP);
    look_at_time(alarm, now_us);
    return alarm->state != before;
}

bool fathom_alarm_add_sample(fathom_alarm_t *alarm, const fathom_sample_t *sample)
{
    const uint32_t now_us = sample->time_us;
    const uint8_t before = alarm->state;
    const uint8_t side = side_of(&alarm->config, sample);
    if (!is_initialised(alarm)) return false;
    if (side == FATHOM_ALARM_UNKNOWN) return fathom_alarm_add_status(alarm, FATHOM_OK, now_us);
    look_at_time(alarm, now_us); /* uses the samples before this one */
    alarm->fed_us = now_us;
    alarm->responds = true;
    if (alarm->side != side) alarm->since_us = now_us;
    alarm->side = side;
    const uint32_t hold_us = (side == FATHOM_ALARM_ON) ? alarm->config.on_hold_us : alarm->config.off_hold_us;
    if (side == BETWEEN) {
        alarm->state = alarm->was;
    } else if (time_since_us(now_us, alarm->since_us) >= hold_us) {
        alarm->was = side;
        alarm->state = side;
    }
    return alarm->state != before;
}

bool fathom_alarm_is_on(const fathom_alarm_t *alarm)
{
    uint8_t state = alarm->state;
    if (state == FATHOM_ALARM_UNKNOWN) state = alarm->config.if_unknown;
    if (state == FATHOM_ALARM_NO_RESPONSE) state = alarm->config.if_no_response;
    return state == FATHOM_ALARM_ON;
}
