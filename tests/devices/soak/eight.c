/* SPDX-License-Identifier: MIT */
#include "eight.h"

#include <string.h>

const char *const eight_mix_names[EIGHT_MIXES] = {"8 a16-real-time", "8 a05-modbus", "4+2+2 of all at 9600",
                                                  "8 hps167s"};
const char *const eight_trouble_names[EIGHT_TROUBLES] = {"alive", "dead", "damaged"};

#define TWO(setting)  (setting), (setting)
#define FOUR(setting) TWO(setting), TWO(setting)
#define EIGHT(setting)                                                                                       \
    {                                                                                                        \
        FOUR(setting), FOUR(setting)                                                                         \
    }
static const uint8_t mixes[EIGHT_MIXES][EIGHT_UNITS] = {
    [EIGHT_A16] = EIGHT(SOAK_A16_REAL_TIME),
    [EIGHT_A05] = EIGHT(SOAK_A05_MODBUS),
    [EIGHT_MIXED] = {FOUR(SOAK_A16_REAL_TIME), SOAK_A16_PROCESSED, TWO(SOAK_A05_MODBUS), SOAK_A16_PROCESSED},
    [EIGHT_HPS167S] = EIGHT(SOAK_HPS167S),
};

static const uint32_t loop_us = 1000;

static void come_back(rig_t *rig, rig_unit_t *unit, eight_result_t *result)
{
    fathom_sim_fault_enable(&unit->fault, false);
    const uint32_t begin_us = rig->clock.now_us;
    result->bound_us = rig_recovery_us(unit);
    do rig_turn(rig);
    while (fathom_elapsed_us(unit->right_us, begin_us) > INT32_MAX &&
           fathom_elapsed_us(rig->clock.now_us, begin_us) <= 2 * result->bound_us);
    result->returned_us = fathom_elapsed_us(unit->right_us, begin_us);
    if (result->returned_us > INT32_MAX) result->returned_us = fathom_elapsed_us(rig->clock.now_us, begin_us);
}

void eight_run(uint8_t mix, uint8_t trouble, uint32_t backoff_us, uint32_t seconds, uint32_t seed,
               eight_result_t *result)
{
    const soak_options_t options = {.backoff_us = backoff_us};
    const uint8_t kind = trouble == EIGHT_DEAD ? FATHOM_SIM_FAULT_SILENCE : FATHOM_SIM_FAULT_FLIP_BYTE;
    rig_t rig;
    memset(result, 0, sizeof *result);
    rig_init(&rig, mixes[mix][0], loop_us, FATHOM_RX_TIMED, &options);
    for (uint8_t i = 0; i < EIGHT_UNITS; i++)
        (void)rig_add(&rig, mixes[mix][i], (uint8_t)(i + 1), seed * EIGHT_UNITS + i);
    rig_unit_t *const last = &rig.units[EIGHT_LAST];
    if (trouble != EIGHT_ALIVE)
        (void)fathom_sim_fault_add(&last->fault, kind, FATHOM_SIM_FAULT_ALWAYS_PPM, 0);
    for (uint32_t i = 0; i < seconds; i++) rig_run(&rig, 1000000);
    for (uint8_t i = 0; i < EIGHT_UNITS; i++) result->readings[i] = rig.units[i].totals.readings;
    come_back(&rig, last, result);
    for (uint8_t i = 0; i < EIGHT_UNITS; i++) {
        rig_account(&rig.units[i]);
        rig_totals_add(i == EIGHT_LAST ? &result->troubled : &result->others, &rig.units[i].totals);
    }
}

uint32_t eight_percent(const eight_result_t *alive, const eight_result_t *result)
{
    uint64_t least = UINT32_MAX;
    for (uint8_t i = 0; i < EIGHT_LAST; i++) {
        const uint64_t percent =
            result->readings[i] * 100 / (alive->readings[i] != 0 ? alive->readings[i] : 1);
        if (percent < least) least = percent;
    }
    return (uint32_t)least;
}

const char *eight_broken_rule(const eight_result_t *result)
{
    if (result->others.wrong_responses + result->others.old != 0) return "wrong readings";
    if (result->troubled.wrong_responses + result->troubled.old != 0) return "wrong readings of the last";
    if (result->others.errors != 0) return "errors of those that are well";
    if (result->others.stuck + result->troubled.stuck != 0) return "stuck";
    if (result->others.unaccounted + result->troubled.unaccounted != 0) return "books that do not balance";
    if (result->troubled.unexplained != 0) return "readings lost without a fault";
    if (result->returned_us > result->bound_us) return "came back too slowly";
    return NULL;
}
