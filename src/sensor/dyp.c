/* SPDX-License-Identifier: MIT */
#include "fathom/sensor/internal/dyp.h"

#include "../common.h"

/*
 * The meaning of the 16-bit values of A16 and A05, and the samples that they become. A window copies byte by
 * byte, since compilers make a call of memcpy() of an assignment.
 */

uint8_t fathom_dyp_meaning(const fathom_dyp_window_t *window, uint16_t value)
{
    /* FFFD, FFFE, FFFF and 0 follow one another modulo 65536, and so do their members. */
    const uint16_t past_fffd = (uint16_t)(value - 0xFFFDu);
    if (past_fffd <= 3u)
        return ((const uint8_t *)window)[offsetof(fathom_dyp_window_t, value_fffd) + past_fffd];
    if ((value < window->min_mm) || (value > window->max_mm)) return FATHOM_MEANS_REFUSED;
    return FATHOM_TARGET;
}

fathom_status_t fathom_dyp_measurement_next(fathom_dyp_measurement_t *measurement, fathom_sample_t *sample)
{
    const uint8_t left = measurement->left;
    if (left == 0u) return FATHOM_PENDING;
    const uint8_t probe = fathom_dyp_first_probe(left);
    measurement->left = (uint8_t)(left & (left - 1u)); /* without its lowest bit, that of `probe` */
    const uint16_t value = measurement->values[probe - measurement->first];
    uint8_t kind = fathom_dyp_meaning(&measurement->window, value);
    if (kind == FATHOM_MEANS_REFUSED) {
        count_one(&measurement->implausible);
        measurement->refused_raw = value;
        measurement->refused_probe = probe;
        return FATHOM_ERR_MALFORMED;
    }
    sample->interference = kind == FATHOM_MEANS_INTERFERENCE;
    if (sample->interference) kind = FATHOM_NO_TARGET;
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

/* Replaces FATHOM_MEANS_DEFAULT. Returns false if the meaning is none that a value may have. */
static bool complete(uint8_t *meaning, uint8_t default_meaning)
{
    if (*meaning == FATHOM_MEANS_DEFAULT) *meaning = default_meaning;
    switch (*meaning) {
    case FATHOM_MEANS_UNKNOWN:
    case FATHOM_MEANS_NO_TARGET:
    case FATHOM_MEANS_TOO_NEAR:
    case FATHOM_MEANS_FAULT:
    case FATHOM_MEANS_INTERFERENCE:
    case FATHOM_MEANS_REFUSED:
        return true;
    default:
        return false;
    }
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
    const bool is_valid = (window->min_mm <= window->max_mm) &&
                          complete(&window->value_fffd, FATHOM_MEANS_NO_TARGET) &&
                          complete(&window->value_fffe, FATHOM_MEANS_INTERFERENCE) &&
                          complete(&window->value_ffff, FATHOM_MEANS_REFUSED) &&
                          complete(&window->value_0, FATHOM_MEANS_UNKNOWN);
    return is_valid ? FATHOM_OK : FATHOM_ERR_ARGUMENT;
}
