/* SPDX-License-Identifier: MIT */
#ifndef OUTPUT_FILE_H
#define OUTPUT_FILE_H

#include <stdbool.h>
#include <stdint.h>

/* A file that stands in for the standard output, or one for each day. Rows are added to what it has. */

enum { OUTPUT_FILE_NAME = 1024 };

typedef struct {
    const char *path;            /* NULL: it is the standard output */
    bool is_by_day;              /* "log.csv" is "log-2026-11-23.csv" */
    char name[OUTPUT_FILE_NAME]; /* of what is open */
} output_file_t;

/*
 * What is written to stdout from now on is for this time of day, in UTC; nothing may stand in stdout's buffer. *is_empty:
 * it is another file than before, and nothing is in it; left as it is where there is no file. False, with errno: it
 * cannot be opened, and stdout is what it was.
 */
bool output_file_turn(output_file_t *file, uint64_t utc_us, bool *is_empty);

#endif
