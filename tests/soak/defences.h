/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_DEFENCES_H
#define FATHOM_TESTS_DEFENCES_H

#include <stdbool.h>
#include <stdint.h>

/* What the options of the drivers and the line are good for: the same run with one of them as it should be, and
 * with it off. Those that are no options are switched off by patches of the sources: test_defences.py. */

typedef struct {
    const char *what; /* is counted */
    uint64_t with, without;
} defence_result_t;

typedef struct {
    const char *name;
    void (*run)(uint64_t transactions, uint32_t seed, defence_result_t *result);
} defence_t;

enum { DEFENCES = 4 };
extern const defence_t defences[DEFENCES];

/* Does it matter? Where 0 is right with the defence it has to be so. */
bool defence_matters(const defence_result_t *result);

#endif
