/* SPDX-License-Identifier: MIT */
#include "fathom/sensor/internal/dyp.h"

#include <stddef.h>

#include "../common.h"

/*
 * The meaning of the 16-bit values of A16 and A05, and the samples that they become. A window copies byte by
 * byte, since compilers make a call of memcpy() of an assignment.
 */

/* The default meanings of FFFD, FFFE, FFFF and 0, four bits each. FFFD has the lowest four. */
enum {
    MEANINGS = FATHOM_MEANS_NO_TARGET | (FATHOM_MEANS_INTERFERENCE << 4) | (FATHOM_MEANS_REFUSED << 8) |
               (FATHOM_MEANS_UNKNOWN << 12)
};

uint8_t fathom_dyp_meaning(const fathom_dyp_window_t *window, uint16_t value)
{
    const uint16_t special = (uint16_t)(value + 3u);
    if (special > 3u)
        return ((value >= window->min_mm) && (value <= window->max_mm)) ? (uint8_t)FATHOM_TARGET
                                                                        : (uint8_t)FATHOM_MEANS_REFUSED;
    const uint8_t meaning = ((const uint8_t *)window)[offsetof(fathom_dyp_window_t, value_fffd) + special];
    if (meaning != FATHOM_MEANS_DEFAULT) return meaning;
    return (uint8_t)((MEANINGS >> (4u * special)) & 15);
}

fathom_status_t fathom_dyp_measurement_next(fathom_dyp_measurement_t *measurement, fathom_sample_t *sample)
{
    uint8_t left = measurement->left;
    uint8_t probe = 1;
    if (left == 0u) return FATHOM_PENDING;
    measurement->left = left & (uint8_t)(left - 1u);
    for (; (left & 1u) == 0u; left >>= 1) probe++;
    const uint16_t value = measurement->values[probe - measurement->first];
    uint8_t kind = fathom_dyp_meaning(&measurement->window, value);
    if (kind == FATHOM_MEANS_REFUSED) {
        count_one(&measurement->implausible);
        measurement->refused_raw = value;
        measurement->refused_probe = probe;
        return FATHOM_ERR_MALFORMED;
    }
    sample->interference = false;
    if (kind == FATHOM_MEANS_INTERFERENCE) {
        kind = FATHOM_NO_TARGET;
        sample->interference = true;
    }
    sample->kind = kind;
    sample->distance_mm = 0;
    if (kind == FATHOM_TARGET) sample->distance_mm = value;
    sample->raw = value;
    sample->time_us = measurement->time_us;
    sample->magnitude = 0;
    sample->sequence = measurement->sequence;
    sample->precision = 0;
    sample->model = measurement->model;
    sample->address = measurement->address;
    sample->probe = probe;
    sample->ambient = 0;
    return FATHOM_OK;
}

void fathom_dyp_window_copy(fathom_dyp_window_t *to, const fathom_dyp_window_t *from)
{
    const uint8_t *next = (const uint8_t *)from;
    /* Without volatile, compilers replace this loop by a call of memcpy() too. */
    for (volatile uint8_t *byte = (uint8_t *)to; byte != (uint8_t *)(to + 1); byte++) {
        *byte = *next;
        next++;
    }
}

/* Returns true if a value may mean this: any fathom_meaning_t. */
static bool is_meaning(uint8_t meaning)
{
    enum {
        ALL = (1 << FATHOM_MEANS_DEFAULT) | (1 << FATHOM_MEANS_UNKNOWN) | (1 << FATHOM_MEANS_NO_TARGET) |
              (1 << FATHOM_MEANS_TOO_NEAR) | (1 << FATHOM_MEANS_FAULT) | (1 << FATHOM_MEANS_INTERFERENCE) |
              (1 << FATHOM_MEANS_REFUSED)
    };
    return (meaning <= FATHOM_MEANS_REFUSED) && (((ALL >> meaning) & 1) != 0);
}

fathom_status_t fathom_dyp_measurement_init(fathom_dyp_measurement_t *measurement, uint16_t default_max_mm)
{
    fathom_dyp_window_t *const window = &measurement->window;
    if (window->max_mm == 0u) window->max_mm = default_max_mm;
    measurement->left = 0;
    measurement->sequence = 0;
    measurement->implausible = 0;
    measurement->refused_raw = 0;
    measurement->refused_probe = 0;
    const bool is_valid = (window->min_mm <= window->max_mm) && is_meaning(window->value_fffd) &&
                          is_meaning(window->value_fffe) && is_meaning(window->value_ffff) &&
                          is_meaning(window->value_0);
    return is_valid ? FATHOM_OK : FATHOM_ERR_ARGUMENT;
}
