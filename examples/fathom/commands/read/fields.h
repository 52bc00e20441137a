/* SPDX-License-Identifier: MIT */
#ifndef FIELDS_H
#define FIELDS_H

#include <stdio.h>

#include "commands/read/reading.h"

/* JSON and CSV: the same fields in the same order. */

enum { VALUE_TEXT = 96 };

void fields_json(FILE *to, const reading_t *reading);
void fields_begin_csv(FILE *to, uint8_t columns);
void fields_csv(FILE *to, const reading_t *reading);

/* A switch or a relay's contact, which says no distance; and is it of one probe? A relay is all probes'. */
bool fields_is_contact(const reading_t *reading);
bool fields_has_probe(const reading_t *reading);

/* As in JSON; empty: it is not known. */
void fields_magnitude(const fathom_sample_t *sample, char text[VALUE_TEXT]);
void fields_temperature(const reader_t *reader, char text[VALUE_TEXT]);

/* What each of them is, and the words of `status`. */
void fields_help(FILE *to);

#endif
