/* SPDX-License-Identifier: MIT */
#ifndef OUTPUT_H
#define OUTPUT_H

#include <stdio.h>

#include "reading/fields.h"

/* A way to write readings. begin may be NULL. */
typedef struct {
    const char *name;
    bool is_json;
    bool has_failures; /* a row for each attempt, also for one that has failed */
    void (*begin)(FILE *to, unsigned columns);
    void (*write)(FILE *to, const reading_t *reading, unsigned columns);
} format_t;

/* In the order of the words of --format. */
enum { FORMAT_TEXT, FORMAT_JSON, FORMAT_CSV };
extern const format_t read_formats[];

#endif
