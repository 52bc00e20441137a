/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_EIGHT_H
#define FATHOM_TESTS_EIGHT_H

#include <stdint.h>

#include "rig.h"

/* Eight units on one RS-485 pair, one of them in trouble: what is left for the others? */

typedef enum { EIGHT_A16, EIGHT_A05, EIGHT_MIXED, EIGHT_HPS167S, EIGHT_MIXES } eight_mix_t;
typedef enum { EIGHT_ALIVE, EIGHT_DEAD, EIGHT_DAMAGED, EIGHT_TROUBLES } eight_trouble_t;

enum { EIGHT_UNITS = RIG_UNITS, EIGHT_LAST = EIGHT_UNITS - 1, EIGHT_LEAST_PERCENT = 90 };

extern const char *const eight_mix_names[EIGHT_MIXES];
extern const char *const eight_trouble_names[EIGHT_TROUBLES];

typedef struct {
    uint64_t readings[EIGHT_UNITS];
    rig_totals_t others;   /* of the seven that are well */
    rig_totals_t troubled; /* of the last one, which is not */
    uint32_t returned_us;  /* from its recovery to its next right reading */
    uint32_t bound_us;     /* of that, by the headers */
} eight_result_t;

/* Runs them for so long. backoff_us: of each driver's config; 0: its default, 1: never less often. */
void eight_run(uint8_t mix, uint8_t trouble, uint32_t backoff_us, uint32_t seconds, uint32_t seed,
               eight_result_t *result);

/* What the worst off of the seven has kept, in percent of what it had. */
uint32_t eight_percent(const eight_result_t *alive, const eight_result_t *result);

/* NULL, or the rule that is broken. */
const char *eight_broken_rule(const eight_result_t *result);

#endif
