/* SPDX-License-Identifier: MIT */
#include "fathom/sensor/internal/dyp.h"

#include "../common.h"

/*
 * The meaning of the 16-bit values of A16 and A05, and the samples that they become.
 */

uint8_t fathom_dyp_meaning(const fathom_model_facts_t *facts, uint16_t value)
{
    uint8_t meaning = FATHOM_MEANS_DEFAULT;
    uint8_t default_meaning = FATHOM_MEANS_REFUSED;
    if (value == 0u) {
        meaning = facts->value_0;
        default_meaning = FATHOM_MEANS_UNKNOWN;
    } else if (value < 0xFFFBu) {
        if ((value >= facts->min_mm) && (value <= facts->max_mm)) meaning = FATHOM_TARGET;
    } else if (value == 0xFFFBu) {
        meaning = facts->value_fffb;
    } else if (value == 0xFFFFu) {
        meaning = facts->value_ffff;
    } else if (value == 0xFFFDu) {
        meaning = facts->value_fffd;
        default_meaning = FATHOM_MEANS_NO_TARGET;
    } else if (value == 0xFFFEu) {
        meaning = facts->value_fffe;
        default_meaning = FATHOM_MEANS_INTERFERENCE;
    } else {
        /* FFFC has no other meaning. */
    }
    return (meaning != FATHOM_MEANS_DEFAULT) ? meaning : default_meaning;
}

fathom_status_t fathom_dyp_measurement_next(fathom_dyp_measurement_t *measurement, fathom_sample_t *sample)
{
    const uint8_t left = measurement->left;
    if (left == 0u) return FATHOM_PENDING;
    const uint8_t probe = fathom_dyp_first_probe(left);
    measurement->left = (uint8_t)(left & (left - 1u)); /* without its lowest bit, that of `probe` */
    const uint16_t value = measurement->values[probe - measurement->first];
    uint8_t kind = fathom_dyp_meaning(measurement->facts, value);
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

/* A meaning is a kind of sample without a distance, and not FATHOM_FAR, which only a switch has; or one of the two that
 * follow the kinds. */
static bool is_meaning(uint8_t meaning)
{
    return (meaning > FATHOM_TARGET) && (meaning <= FATHOM_MEANS_REFUSED) && (meaning != FATHOM_FAR);
}

bool fathom_dyp_are_valid(const fathom_model_facts_t *facts)
{
    /* The values that are never distances: FFFB to FFFF, and 0, which follows FFFF. */
    for (uint16_t value = 0xFFFB; value != 1u; value++) {
        if (!is_meaning(fathom_dyp_meaning(facts, value))) return false;
    }
    return fathom_dyp_has_range(facts);
}
