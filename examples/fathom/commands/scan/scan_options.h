/* SPDX-License-Identifier: MIT */
#ifndef SCAN_OPTIONS_H
#define SCAN_OPTIONS_H

#include <stdbool.h>
#include <stdio.h>

#include "commands/scan/scan_plan.h"

typedef struct {
    const char *port; /* NULL: with --estimate none is needed */
    scan_plan_t plan;
    bool is_default; /* the plan: none of its options was given */
    bool wake;
    bool estimate;
    bool is_json;
    bool wants_help;
} scan_options_t;

/* False, after saying why: wrong usage. */
bool scan_options(scan_options_t *options, int argc, char **argv);

void scan_help(FILE *to);

#endif
