/* SPDX-License-Identifier: MIT */
#ifndef ADVICE_WORDS_H
#define ADVICE_WORDS_H

#include <stdio.h>

#include "diagnosis/failure.h"

/* Prints a template. {word} is replaced by a fact of the failure. [number:text] is printed only if this number is not
 * 0. */
void advice_print_template(FILE *to, const char *text, const failure_t *failure);

#endif
