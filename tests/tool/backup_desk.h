/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_BACKUP_DESK_H
#define FATHOM_TESTS_BACKUP_DESK_H

#include "suite.h"

/* A folder of a test's own, for files of `fathom save`. */
enum { DESK_TEXT = 8192 };

void desk_begin(void);
int desk_end(void **state); /* a suite's tear-down */

/* Of a file in it; valid until the next call but one. */
const char *desk_path(const char *name);

void desk_write(const char *name, const char *text);
/* Returns text. */
const char *desk_read(const char *name, char text[DESK_TEXT]);
void desk_remove(const char *name);

/* How many files there are, whatever their names. */
unsigned desk_count(void);

#endif
