/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_CELL_H
#define FATHOM_TESTS_CELL_H

#include <stdbool.h>
#include <stdint.h>

#include "rig.h"

/* One sensor with some kinds of faults at one rate: run, let recover, and held against the rules. */

enum { CELL_KINDS = FATHOM_SIM_FAULT_END };

typedef struct {
    uint8_t setting; /* soak_setting_t */
    uint8_t kinds_used, kinds[CELL_KINDS];
    uint32_t chance_ppm;
    uint32_t late_us; /* of FATHOM_SIM_FAULT_LATE; 0: after the time-out, before twice the time-out */
    uint32_t seed;
    uint16_t held_mm; /* truth_t.held_mm */
    soak_options_t options;
} cell_t;

typedef struct {
    rig_totals_t totals;
    double expected; /* wrong readings that the checksums must let pass, at most */
    bool is_alike;   /* old values cannot be told from new ones: theory_alike */
    uint32_t recovered_us;
    uint32_t bound_us; /* of that */
    uint64_t too_slow; /* recoveries over their bound */
} cell_result_t;

/* Faults that come in later than any time-out knows of. */
uint32_t cell_late_beyond_us(uint8_t setting);

/* Runs at least so many transactions, in turns of the loop of 0.1, 1 and 20 ms, with ports that know all and nothing,
 * and adds to *result what came of it. */
void cell_run(const cell_t *cell, uint64_t transactions, cell_result_t *result);

/* b on top of a. */
void cell_add(cell_result_t *a, const cell_result_t *b);

/* NULL, or the rule that is broken. */
const char *cell_broken_rule(const cell_result_t *result);

/* The rates from 0.1 to 30 %. */
enum { CELL_RATES = 4 };
extern const uint32_t cell_rates_ppm[CELL_RATES];

#endif
