/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_THEORY_H
#define FATHOM_TESTS_THEORY_H

#include <stdbool.h>
#include <stdint.h>

/* What checksums must let pass, and what cannot be told apart. */

/* Frames that pass though a fault of this kind has hit them, at most, in 65536 of them. */
uint32_t theory_pass(uint8_t setting, uint8_t kind);

/* The same where two kinds have hit one frame; and without gaps where FF stands beside it for other reasons. */
uint32_t theory_pass_joint(uint8_t setting);
uint32_t theory_pass_full(void);

/* More than this many come about once in a million runs when `expected` are expected. */
uint64_t theory_most(double expected);

/*
 * What cannot be told apart on any wire (line.h, "What cannot be told apart"): an old value of the unit that was
 * asked may then be read. By setting and kinds; another kind beside it changes nothing.
 */
typedef struct {
    uint8_t setting; /* soak_setting_t; SOAK_SETTINGS: all that are asked */
    uint8_t kind;    /* fathom_sim_fault_kind_t */
    uint8_t beside;  /* only together with this one; 0: always */
    const char *why;
} theory_alike_t;

enum { THEORY_ALIKE = 3 };
extern const theory_alike_t theory_alike[THEORY_ALIKE];

/* kinds: set of FATHOM_SIM_FAULT_BIT. late_us: of FATHOM_SIM_FAULT_LATE. NULL: all can be told apart. */
const theory_alike_t *theory_is_alike(uint8_t setting, uint32_t kinds, uint32_t late_us);

#endif
