/* SPDX-License-Identifier: MIT */
#ifndef SIM_HELP_H
#define SIM_HELP_H

#include <stdio.h>

void sim_help(FILE *to);

#endif
