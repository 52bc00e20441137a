/* SPDX-License-Identifier: MIT */
#ifndef ADVICE_PINS_H
#define ADVICE_PINS_H

#include <stdio.h>

#include "diagnosis/advice.h"

/* The part of advice_print for a sensor on pins. Returns false if it has nothing to print for this failure. */
bool advice_print_pins(FILE *to, const failure_t *failure, const reader_facts_t *facts);

#endif
