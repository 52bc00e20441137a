/* SPDX-License-Identifier: MIT */
/*
 * The driver of an A05 with relay output. It computes from the wiring which level is "near"; contact.c does the rest.
 */
#include "fathom/sensor/a05_relay.h"

#include "../common.h"

fathom_status_t fathom_a05_relay_init(fathom_a05_relay_t *sensor, const fathom_pin_t *pin,
                                      const fathom_clock_t *clock, const fathom_a05_relay_config_t *config)
{
    fathom_contact_t *const base = &sensor->base;
    fathom_a05_relay_config_t zeroed;
    clear(sensor, sizeof *sensor);
    config = config_or_zeroed(config, &zeroed, sizeof zeroed);
    if ((config->wiring > FATHOM_A05_RELAY_NORMALLY_CLOSED) ||
        (config->level > FATHOM_A05_RELAY_CONDUCTS_HIGH))
        return FATHOM_ERR_ARGUMENT;
    base->pin = pin;
    base->clock = clock;
    base->near_is_high = (config->wiring == FATHOM_A05_RELAY_NORMALLY_CLOSED) !=
                         (config->level == FATHOM_A05_RELAY_CONDUCTS_HIGH);
    base->model = FATHOM_A05;
    return fathom_contact_init(base, &config->timing);
}
