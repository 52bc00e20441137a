/* SPDX-License-Identifier: MIT */
#ifndef DECODING_PRINT_H
#define DECODING_PRINT_H

#include <stdio.h>

#include "sensors/decoding.h"

/* Indented lines; what has one field stands in one. */
void decoding_put_text(FILE *to, const decode_meaning_t *meaning);

/* An object. All texts are the program's own: nothing in them needs to be escaped. */
void decoding_put_json(FILE *to, const decode_meaning_t *meaning);

#endif
