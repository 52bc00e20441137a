/* SPDX-License-Identifier: MIT */
#ifndef ANY_SAMPLE_H
#define ANY_SAMPLE_H

#include "assumptions.h"
#include "fathom/sample.h"

/* Also one that no driver makes: a kind, a probe or a distance that there is not. */
static inline fathom_sample_t any_sample(void)
{
    fathom_sample_t sample;
    sample.time_us = any_32();
    sample.magnitude = any_32();
    sample.raw = any_32();
    sample.sequence = any_16();
    sample.distance_mm = any_16();
    sample.precision = any_16();
    sample.kind = any_8();
    sample.model = any_8();
    sample.address = any_8();
    sample.probe = any_8();
    sample.ambient = any_8();
    sample.interference = any_bool();
    return sample;
}

#endif
