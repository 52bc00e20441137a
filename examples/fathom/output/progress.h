/* SPDX-License-Identifier: MIT */
#ifndef PROGRESS_H
#define PROGRESS_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

/* A bar in the last line of a terminal. Nothing is written to anything else. */
typedef struct {
    FILE *to;
    bool is_terminal;
    bool is_shown;
    uint64_t start_us;
    uint64_t total_us; /* 0: unknown; then there is no bar, but the number of seconds from the third one on */
    uint64_t shown_us; /* time at which the line was last written */
} progress_t;

void progress_init(progress_t *progress, FILE *to, uint64_t now_us, uint64_t total_us);

/* Shows `done_us` of the total, and what happens now in a few words. Writes at most ten times a second. */
void progress_show(progress_t *progress, uint64_t now_us, uint64_t done_us, const char *doing);

/* Removes the line, so that something else can be written. */
void progress_clear(progress_t *progress);

#endif
