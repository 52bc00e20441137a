/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_SIM_SCENE_H
#define FATHOM_SIM_SCENE_H

#include <stdint.h>

#include "device.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Two ready-made scenes. Each struct is the caller's, lives as long as the device that sees it, and may be
 * changed at any time; several devices may look at one. */

/* Things that stand still: probe n sees value[n - 1], 0..65535 mm or FATHOM_SIM_NO_TARGET and so on. */
typedef struct {
    int32_t value[4];
} fathom_sim_fixed_t;
fathom_sim_scene_t fathom_sim_fixed(fathom_sim_fixed_t *fixed);

/* Something that goes from `from_mm` to `to_mm` and back in `period_us` (2..2^30), for ever, evenly; at
 * `from_mm` when the clock says `start_us`. All probes see it alike. start_us is moved on, so that the
 * movement is smooth across the wrap of the clock if it is looked at every 30 minutes. */
typedef struct {
    uint16_t from_mm;
    uint16_t to_mm;
    uint32_t period_us;
    uint32_t start_us;
} fathom_sim_moving_t;
fathom_sim_scene_t fathom_sim_moving(fathom_sim_moving_t *moving);

#ifdef __cplusplus
}
#endif

#endif
