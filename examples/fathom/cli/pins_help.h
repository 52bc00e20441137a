/* SPDX-License-Identifier: MIT */
#ifndef PINS_HELP_H
#define PINS_HELP_H

#include <stdio.h>

/* The help of the modes on pins, for the commands that read. */
void pins_help(FILE *to);

#endif
