/* SPDX-License-Identifier: MIT */
#ifndef FIELDS_H
#define FIELDS_H

#include "read/output.h"

/* JSON and CSV: the same fields in the same order. */

enum { VALUE_TEXT = 96 };

void fields_json(FILE *to, const reading_t *reading);
void fields_begin_csv(FILE *to, uint8_t columns);
void fields_csv(FILE *to, const reading_t *reading);

/* As in JSON; empty: it is not known. */
void fields_magnitude(const fathom_sample_t *sample, char text[VALUE_TEXT]);
void fields_temperature(const reader_t *reader, char text[VALUE_TEXT]);

/* What each of them is, and the words of `status`. */
void fields_help(FILE *to);

#endif
