/* SPDX-License-Identifier: MIT */
#include "plan.h"

#include <stdio.h>
#include <string.h>

#include "theory.h"

enum { NAME = 64, ENOUGH = 40, LOW_RATES = 2 };

uint8_t plan_kinds(uint8_t setting, uint8_t *kinds)
{
    const fathom_sim_scene_t scene = {NULL, NULL};
    soak_device_t model;
    const fathom_sim_device_t *const device = soak_device_init(&model, setting, 1, &scene, 1);
    uint8_t count = 0;
    for (uint8_t kind = 1; kind < FATHOM_SIM_FAULT_END; kind++)
        if (fathom_sim_fault_applies(kind, device)) kinds[count++] = kind;
    return count;
}

uint8_t plan_find(const char *name)
{
    uint8_t setting = 0;
    while (setting != SOAK_SETTINGS && strcmp(name, soak_facts[setting].name) != 0) setting++;
    return setting;
}

/* Another seed for each cell. */
static uint32_t next_seed(uint32_t *seed) { return *seed += 1009; }

/* At one rate after the other, from the highest: `rates` of them. */
static void run_rates(cell_t *cell, uint32_t *seed, uint8_t rates, uint64_t transactions,
                      cell_result_t *result)
{
    for (uint8_t i = 0; i < rates; i++) {
        cell->chance_ppm = cell_rates_ppm[CELL_RATES - 1 - i];
        cell->seed = next_seed(seed);
        cell_run(cell, transactions / rates + 1, result);
    }
}

void plan_these(const plan_t *plan, uint8_t setting, const uint8_t *kinds, uint8_t count,
                uint64_t transactions)
{
    cell_result_t result = {0};
    cell_t cell = {.setting = setting, .kinds_used = count};
    char name[NAME] = "none";
    uint32_t seed = plan->seed;
    for (uint8_t i = 0; i < count; i++) {
        cell.kinds[i] = kinds[i];
        const size_t used = i == 0 ? 0 : strlen(name);
        (void)snprintf(name + used, NAME - used, "%s%s", i == 0 ? "" : "+", fathom_sim_fault_name(kinds[i]));
    }
    run_rates(&cell, &seed, CELL_RATES, transactions, &result);
    plan->report(plan->ctx, setting, name, &result);
}

void plan_singles(const plan_t *plan, uint8_t setting, uint64_t transactions)
{
    uint8_t kinds[CELL_KINDS];
    const uint8_t count = plan_kinds(setting, kinds);
    const uint64_t each = transactions / (count + 2u);
    plan_these(plan, setting, NULL, 0, each);
    for (uint8_t i = 0; i < count; i++) plan_these(plan, setting, &kinds[i], 1, each);
    if (!soak_is_asked(setting)) return;
    cell_result_t result = {0};
    cell_t cell = {.setting = setting,
                   .kinds_used = 1,
                   .kinds = {FATHOM_SIM_FAULT_LATE},
                   .late_us = cell_late_beyond_us(setting)};
    uint32_t seed = plan->seed;
    run_rates(&cell, &seed, CELL_RATES, each, &result);
    plan->report(plan->ctx, setting, "too-late", &result);
}

void plan_pairs(const plan_t *plan, uint8_t setting, uint64_t transactions)
{
    uint8_t kinds[CELL_KINDS];
    const uint8_t count = plan_kinds(setting, kinds);
    const uint64_t each = transactions / (count * (count - 1u) / 2);
    const uint8_t rates = each >= (uint64_t)ENOUGH * CELL_RATES ? CELL_RATES : 1;
    uint32_t seed = plan->seed;
    for (uint8_t i = 0; i + 1 < count; i++) {
        cell_result_t sum = {0};
        char name[NAME];
        for (uint8_t j = (uint8_t)(i + 1); j < count; j++) {
            cell_result_t result = {0};
            cell_t cell = {.setting = setting, .kinds_used = 2, .kinds = {kinds[i], kinds[j]}};
            run_rates(&cell, &seed, rates, each, &result);
            (void)snprintf(name, NAME, "%s+%s", fathom_sim_fault_name(kinds[i]),
                           fathom_sim_fault_name(kinds[j]));
            if (cell_broken_rule(&result) != NULL)
                plan->report(plan->ctx, setting, name, &result);
            else
                cell_add(&sum, &result);
        }
        (void)snprintf(name, NAME, "%s+each", fathom_sim_fault_name(kinds[i]));
        if (sum.totals.transactions != 0) plan->report(plan->ctx, setting, name, &sum);
    }
}

void plan_mixtures(const plan_t *plan, uint8_t setting, uint64_t transactions)
{
    static const uint32_t low_ppm[LOW_RATES] = {2000, 20000};
    uint8_t kinds[CELL_KINDS];
    const uint8_t count = plan_kinds(setting, kinds);
    uint32_t seed = plan->seed;
    for (uint8_t told_apart = 0; told_apart != 2; told_apart++) {
        cell_result_t result = {0};
        cell_t cell = {.setting = setting};
        for (uint8_t i = 0; i < count; i++)
            if (!told_apart ||
                (kinds[i] != FATHOM_SIM_FAULT_UNASKED && kinds[i] != FATHOM_SIM_FAULT_CLOCK_JUMP))
                cell.kinds[cell.kinds_used++] = kinds[i];
        for (uint8_t i = 0; i < LOW_RATES; i++) {
            cell.chance_ppm = low_ppm[i];
            cell.seed = next_seed(&seed);
            cell_run(&cell, transactions / (2 * LOW_RATES) + 1, &result);
        }
        plan->report(plan->ctx, setting, told_apart ? "all-told-apart" : "all", &result);
    }
}
