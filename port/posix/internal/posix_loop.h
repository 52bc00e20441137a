/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_INTERNAL_POSIX_LOOP_H
#define FATHOM_INTERNAL_POSIX_LOOP_H

#include "fathom_loop.h"

/* What the files of the loop share. */

uint64_t fathom_loop_now_us(const fathom_loop_t *loop);

/* loop_due.c: when the source is polled next, whatever was set before. */
void fathom_loop_due_at(fathom_loop_source_t *source, uint64_t time_us);
void fathom_loop_due_never(fathom_loop_source_t *source);

#endif
