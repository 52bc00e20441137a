/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_SIM_VALUES_H
#define FATHOM_SIM_VALUES_H

#include <stdint.h>

/* What all models do with values. */

/* A register on the wire, the high byte first. */
static inline uint16_t fathom_sim_get16(const uint8_t *at) { return (uint16_t)(at[0] * 256u + at[1]); }

/* A member of a config that may be left out. */
static inline uint32_t fathom_sim_or_else(uint32_t value, uint32_t otherwise)
{
    return value != 0 ? value : otherwise;
}

#endif
