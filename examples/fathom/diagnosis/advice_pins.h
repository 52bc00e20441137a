/* SPDX-License-Identifier: MIT */
#ifndef ADVICE_PINS_H
#define ADVICE_PINS_H

#include <stdio.h>

#include "sensors/reader.h"

/* The part of advice_print for a sensor on pins. noises: pulses of this attempt that were too short. False: it has nothing
 * to say of this failure. */
bool advice_print_pins(FILE *to, fathom_status_t status, const reader_t *reader, uint32_t noises);

#endif
