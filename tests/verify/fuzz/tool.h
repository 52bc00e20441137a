/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_FUZZ_TOOL_H
#define FATHOM_TESTS_FUZZ_TOOL_H

#include <stdio.h>

#include "fuzz.h"

/*
 * The tool's commands in this process, on a machine without ports: every path leads to one file in memory, or to
 * nothing, so that no input can do harm. Linked with --wrap for what would reach the system (targets.py).
 */
typedef struct {
    int status;
    char *out; /* and the standard error: there until the next run */
    char *err;
    size_t out_size;
    size_t err_size;
    unsigned opens; /* of ports */
} tool_t;

extern tool_t tool;

/* What each path that is read has; NULL: there is no such file. What is written replaces it. */
void tool_file(const uint8_t *bytes, size_t size);
const char *tool_written(size_t *size); /* NULL: nothing was */

/* The standard output and error into tool.out and tool.err, and back. */
void tool_capture(void);
void tool_release(void);

/* argv as main has it, with the standard input as the file is. */
void tool_run(int argc, char **argv);

#endif
