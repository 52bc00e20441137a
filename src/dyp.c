/* SPDX-License-Identifier: MIT */
#include "fathom/dyp.h"

static bool is_no_object(const fathom_dyp_window_t *window, uint16_t value)
{
    if (window->no_codes) return false;
    return value == FATHOM_DYP_NO_OBJECT || value == FATHOM_DYP_NO_OBJECT_OLD ||
           value == FATHOM_DYP_INTERFERENCE;
}

bool fathom_dyp_plausible(const fathom_dyp_window_t *window, uint16_t value)
{
    return is_no_object(window, value) || (value >= window->min_mm && value <= window->max_mm);
}

fathom_status_t fathom_dyp_next(fathom_dyp_answer_t *answer, fathom_sample_t *sample)
{
    if (answer->left == 0) return FATHOM_PENDING;
    uint8_t probe = 1;
    uint8_t bit = 1;
    for (; (answer->left & bit) == 0; bit = (uint8_t)(bit << 1)) probe++;
    answer->left &= (uint8_t)~bit;
    const uint16_t value = answer->values[probe - answer->first];
    if (!fathom_dyp_plausible(&answer->window, value)) {
        if (answer->implausible != UINT16_MAX) answer->implausible++;
        return FATHOM_ERR_MALFORMED;
    }
    const bool is_target = !is_no_object(&answer->window, value);
    sample->time_us = answer->time_us;
    sample->magnitude = 0;
    sample->sequence = answer->sequence;
    sample->raw = value;
    sample->distance_mm = is_target ? value : 0;
    sample->precision = 0;
    sample->kind = is_target ? FATHOM_TARGET : FATHOM_NO_TARGET;
    sample->model = answer->model;
    sample->unit = answer->unit;
    sample->probe = probe;
    sample->ambient = 0;
    sample->interference = !is_target && value == FATHOM_DYP_INTERFERENCE;
    return FATHOM_READY;
}

void fathom_dyp_answer(fathom_dyp_answer_t *answer, uint8_t probes, uint32_t time_us)
{
    answer->sequence++;
    answer->time_us = time_us;
    answer->left = probes;
}

fathom_status_t fathom_dyp_answer_init(fathom_dyp_answer_t *answer, uint16_t default_max_mm)
{
    if (answer->window.min_mm == 0) answer->window.min_mm = 1;
    if (answer->window.max_mm == 0) answer->window.max_mm = default_max_mm;
    answer->time_us = 0;
    answer->sequence = 0;
    answer->implausible = 0;
    answer->left = 0;
    return answer->window.min_mm > answer->window.max_mm ? FATHOM_ERR_ARGUMENT : FATHOM_READY;
}
