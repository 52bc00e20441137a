/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_PLAN_H
#define FATHOM_TESTS_PLAN_H

#include <stdint.h>

#include "cell.h"

/* Which cells a sensor is soaked in. */

/* One line of the table: what it was soaked in, and what came of it. */
typedef void (*plan_report_t)(void *ctx, uint8_t setting, const char *name, const cell_result_t *result);

typedef struct {
    plan_report_t report;
    void *ctx;
    uint32_t seed;
} plan_t;

/* No fault, each kind by itself at each rate, and responses that come later than twice the time-out. */
void plan_singles(const plan_t *plan, uint8_t setting, uint64_t transactions);

/* Every pair of kinds, at 30 % each and, where there are transactions enough, at the other rates too. A line for each
 * kind with all that come after it, and for each pair that breaks a rule. */
void plan_pairs(const plan_t *plan, uint8_t setting, uint64_t transactions);

/* All kinds at once, at low rates; and the same without those that cannot be told apart. */
void plan_mixtures(const plan_t *plan, uint8_t setting, uint64_t transactions);

/* These kinds alone, at each rate. */
void plan_these(const plan_t *plan, uint8_t setting, const uint8_t *kinds, uint8_t count,
                uint64_t transactions);

/* The kinds that do something to this sensor; returns how many. kinds: room for CELL_KINDS. */
uint8_t plan_kinds(uint8_t setting, uint8_t *kinds);

/* The sensor of that name; SOAK_SETTINGS: none. */
uint8_t plan_find(const char *name);

#endif
