/* SPDX-License-Identifier: MIT */
#include "fathom/sensor/a16_switch.h"

#include "../common.h"

/*
 * The driver of an A16 with switch output. A contact reads the level; this file keeps the polarity in step
 * with register 0x0205.
 */

fathom_status_t fathom_a16_switch_init(fathom_a16_switch_t *sensor, const fathom_pin_t *pin,
                                       const fathom_clock_t *clock, const fathom_a16_switch_config_t *config)
{
    fathom_contact_t *const base = &sensor->base;
    fathom_a16_switch_config_t zeroed;
    config = config_or_zeroed(config, &zeroed, sizeof zeroed);
    base->pin = pin;
    base->clock = clock;
    base->guard = config->guard;
    base->near_is_high = !config->negative;
    base->model = FATHOM_A16;
    base->address = config->address;
    return fathom_contact_init(base, &config->timing);
}

fathom_status_t fathom_a16_switch_set_polarity(fathom_a16_switch_t *sensor, fathom_a16_modbus_t *modbus,
                                               fathom_a16_polarity_t polarity)
{
    const fathom_status_t status = fathom_a16_modbus_set_switch_polarity(modbus, polarity);
    fathom_contact_set_hold(&sensor->base, status == FATHOM_PENDING);
    if (status == FATHOM_OK) fathom_a16_switch_note_polarity(sensor, polarity);
    return status;
}

void fathom_a16_switch_note_polarity(fathom_a16_switch_t *sensor, fathom_a16_polarity_t polarity)
{
    fathom_contact_set_hold(&sensor->base, false);
    fathom_contact_set_near_is_high(&sensor->base, polarity == FATHOM_A16_POSITIVE);
}
