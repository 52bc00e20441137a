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
    void (*write)(FILE *to, const reading_t *reading);
} format_t;

/* By name; NULL: the default, text. NULL after a usage error that lists what there is. */
const format_t *format_find(const char *command, const char *name);

#endif
