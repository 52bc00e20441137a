/* SPDX-License-Identifier: MIT */
#ifndef BACKUP_FILE_H
#define BACKUP_FILE_H

#include "device/backup.h"

/*
 * The file of `fathom save`: lines of NAME = VALUE, with the names and values of `fathom get` and `fathom set`, and
 * before them sensor = MODEL. What follows a # is a comment. A value may also be one of backup_word(). Lines end with
 * LF or CR LF and have no more than BACKUP_LINE bytes.
 */
enum { BACKUP_LINE = 250 };

/* place: "address 7, 19200 8E1"; when: in UTC. */
void backup_print(FILE *to, const backup_t *unit, const char *place, const char *when);

/* Returns STATUS_OK; else after saying what is wrong and in which line, STATUS_FAILED: it cannot be read; STATUS_USAGE:
 * it does not fit this model. */
int backup_parse(const char *path, const model_t *model, backup_t *file);

/* Says that this row of the file cannot be used; returns STATUS_USAGE. */
int backup_refuse(const char *path, const backup_row_t *row, const char *why);

#endif
