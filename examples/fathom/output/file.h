/* SPDX-License-Identifier: MIT */
#ifndef OUTPUT_FILE_H
#define OUTPUT_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A file that stands in for the standard output, or one for each day. Rows are added to what it has. */

enum { OUTPUT_FILE_NAME = 1024 };

typedef struct {
    const char *path;            /* NULL: it is the standard output */
    bool is_by_day;              /* "log.csv" is "log-2026-11-23.csv" */
    char name[OUTPUT_FILE_NAME]; /* of what is open */
} output_file_t;

typedef enum {
    OUTPUT_FILE_SAME,  /* it is the one before, or none */
    OUTPUT_FILE_EMPTY, /* it is another one, with nothing in it */
    OUTPUT_FILE_FILLED,
    OUTPUT_FILE_FAILED /* with errno: it cannot be opened, and stdout is what it was */
} output_file_turn_t;

/* What is written to stdout from now on is for this time of day, in UTC; nothing may stand in stdout's buffer. */
output_file_turn_t output_file_turn(output_file_t *file, uint64_t utc_us);

/* Does what is open begin with this? Not where that cannot be told. */
bool output_file_begins(const output_file_t *file, const char *text, size_t length);

#endif
