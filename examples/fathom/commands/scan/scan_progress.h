/* SPDX-License-Identifier: MIT */
#ifndef SCAN_PROGRESS_H
#define SCAN_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

/* A bar in the last line of a terminal; where `to` is none, nothing is ever written. */
typedef struct {
    FILE *to;
    bool is_terminal;
    bool is_shown;
    uint64_t total_us;
    uint64_t shown_us; /* the clock when it was last written */
} scan_progress_t;

void scan_progress_begin(scan_progress_t *progress, FILE *to, uint64_t total_us);

/* done_us of total_us; what: a few words on what happens now. Written a few times a second at most. */
void scan_progress_show(scan_progress_t *progress, uint64_t now_us, uint64_t done_us, const char *what);

/* Takes it away, so that something else can be written. */
void scan_progress_clear(scan_progress_t *progress);

#endif
