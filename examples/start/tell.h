/* SPDX-License-Identifier: MIT */
#ifndef START_TELL_H
#define START_TELL_H

#include "fathom/sample.h"
#include "fathom/status.h"

/*
 * By semihosting, one line each:
 *   NAME probe 1 754 mm
 *   NAME probe 1 no target        (or: fault)
 *   NAME error NO_RESPONSE          (fathom_status_name)
 */
void tell_sample(const char *name, const fathom_sample_t *sample);
void tell_error(const char *name, fathom_status_t status);

/* A number as text, which begins somewhere in `digits`. */
enum { TELL_DIGITS = 11 };
const char *tell_digits(char digits[TELL_DIGITS], uint32_t number);

#endif
