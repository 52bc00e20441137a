/* SPDX-License-Identifier: MIT */
#ifndef OUTPUT_H
#define OUTPUT_H

#include "models/models.h"

/* One line of output: a sample and what the library does not know of it. */
typedef struct {
    const model_t *model;
    const model_mode_t *mode;
    const char *name; /* in text */
    const fathom_sample_t *sample;
    uint64_t time_us; /* since the program's start; does not wrap */
    uint64_t utc_us;  /* since 1970 */
    bool has_optics;  /* this sensor or another one that stands in the same table */
} reading_t;

/* A way to write readings. begin may be NULL. */
typedef struct {
    const char *name;
    bool is_json;
    void (*begin)(FILE *to, bool has_optics);
    void (*write)(FILE *to, const reading_t *reading);
} format_t;

/* By name; NULL: the default, text. NULL after a usage error that lists what there is. */
const format_t *format_find(const char *command, const char *name);

#endif
