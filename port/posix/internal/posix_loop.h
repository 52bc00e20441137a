/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_INTERNAL_POSIX_LOOP_H
#define FATHOM_INTERNAL_POSIX_LOOP_H

#include "fathom_loop.h"

/* What the files of the loop share. */

/* loop.c */
bool fathom_loop_has(const fathom_loop_t *loop, const fathom_loop_source_t *source);

/* loop_source.c: opens one that is closed, or says when that is tried again. */
void fathom_loop_open(fathom_loop_source_t *source);
void fathom_loop_close(fathom_loop_source_t *source);
/* Whatever is to be done with it now, and when it is polled next. */
void fathom_loop_turn(fathom_loop_source_t *source);

/* loop_due.c */
uint64_t fathom_loop_now_us(const fathom_loop_t *loop);
/* When the source is polled next, whatever was set before. */
void fathom_loop_due_at(fathom_loop_source_t *source, uint64_t time_us);
void fathom_loop_due_never(fathom_loop_source_t *source);

#endif
