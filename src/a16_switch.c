/* SPDX-License-Identifier: MIT */
#include "fathom/a16_switch.h"

fathom_status_t fathom_a16_switch_init(fathom_a16_switch_t *sensor, const fathom_a16_switch_config_t *config)
{
    fathom_contact_config_t *const base = &sensor->base.config;
    base->pin = config->pin;
    base->clock = config->clock;
    base->line = config->line;
    base->settle_us = config->settle_us;
    base->period_us = config->period_us;
    base->look_us = config->look_us;
    base->stale_us = config->stale_us;
    base->near_is_high = config->polarity != FATHOM_A16_SWITCH_NEGATIVE;
    base->model = FATHOM_A16;
    base->unit = config->address;
    if (config->polarity > FATHOM_A16_SWITCH_NEGATIVE) return FATHOM_ERR_ARGUMENT;
    return fathom_contact_init(&sensor->base);
}

fathom_status_t fathom_a16_switch_set_polarity(fathom_a16_switch_t *sensor, uint8_t polarity)
{
    if (polarity != FATHOM_A16_SWITCH_POSITIVE && polarity != FATHOM_A16_SWITCH_NEGATIVE)
        return FATHOM_ERR_ARGUMENT;
    fathom_contact_set_near_is_high(&sensor->base, polarity == FATHOM_A16_SWITCH_POSITIVE);
    return FATHOM_READY;
}

fathom_sensor_t fathom_a16_switch_sensor(fathom_a16_switch_t *sensor)
{
    return fathom_contact_sensor(&sensor->base);
}
