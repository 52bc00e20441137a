/* SPDX-License-Identifier: MIT */
#ifndef DECODING_PRINT_H
#define DECODING_PRINT_H

#include <stdio.h>

#include "output/record.h"
#include "sensors/decoding.h"

/* Prints the meaning and its first value, without a line feed. */
void decoding_put_line(FILE *to, const decode_meaning_t *meaning);

/* Prints indented lines; a meaning with one value is one line. */
void decoding_put_text(FILE *to, const decode_meaning_t *meaning);

/* Writes an element of the open array. */
void decoding_put_json(json_t *json, const decode_meaning_t *meaning);

#endif
