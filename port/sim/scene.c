/* SPDX-License-Identifier: MIT */
/* What a simulated sensor sees. A scene is fixed distances, or distances that move with the time. */
#include "scene.h"

static int32_t fixed_distance(void *ctx, uint8_t probe, uint32_t now_us)
{
    const fathom_sim_fixed_t *const fixed = (const fathom_sim_fixed_t *)ctx;
    (void)now_us;
    return probe >= 1 && probe <= 4 ? fixed->value[probe - 1] : FATHOM_SIM_NO_TARGET;
}

fathom_sim_scene_t fathom_sim_fixed(fathom_sim_fixed_t *fixed)
{
    const fathom_sim_scene_t scene = {fixed_distance, fixed};
    return scene;
}

/* How far from its start the movement is; `now_us` may be a little before it, seen from a line that lags
 * behind, and there it looks the same. */
static uint32_t phase_us(fathom_sim_moving_t *moving, uint32_t now_us)
{
    const uint32_t since_us = fathom_elapsed_us(now_us, moving->start_us);
    if (since_us > INT32_MAX) return fathom_elapsed_us(moving->start_us, now_us) % moving->period_us;
    const uint32_t phase = since_us % moving->period_us;
    moving->start_us = (uint32_t)(now_us - phase);
    return phase;
}

static int32_t moving_distance(void *ctx, uint8_t probe, uint32_t now_us)
{
    fathom_sim_moving_t *const moving = (fathom_sim_moving_t *)ctx;
    const uint32_t half_us = moving->period_us / 2;
    const int32_t range_mm = (int32_t)moving->to_mm - (int32_t)moving->from_mm;
    uint32_t at_us = phase_us(moving, now_us);
    (void)probe;
    if (at_us > half_us) at_us = moving->period_us - at_us;
    return moving->from_mm + (int32_t)((int64_t)range_mm * (int64_t)at_us / (int64_t)half_us);
}

fathom_sim_scene_t fathom_sim_moving(fathom_sim_moving_t *moving)
{
    const fathom_sim_scene_t scene = {moving_distance, moving};
    return scene;
}
