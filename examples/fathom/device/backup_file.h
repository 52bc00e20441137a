/* SPDX-License-Identifier: MIT */
#ifndef BACKUP_FILE_H
#define BACKUP_FILE_H

#include "device/backup.h"

/*
 * The file of `fathom save`: lines of NAME = VALUE with the names and values of `fathom get` and `fathom set`, after the
 * line sensor = MODEL. A comment begins with #. A value may also be one of backup_word(). A line ends with LF or CR LF
 * and has at most BACKUP_LINE bytes.
 */
enum { BACKUP_LINE = 250 };

/* Prints the file. place: "address 7, 19200 8E1"; when: UTC. */
void backup_print(FILE *to, const backup_t *unit, const char *place, const char *when);

typedef enum {
    BACKUP_OK,
    BACKUP_UNREADABLE,
    BACKUP_INVALID /* a line is wrong, or the file belongs to another model */
} backup_result_t;

/* Reads the file. If that fails, prints what is wrong and in which line. */
backup_result_t backup_parse(const char *path, const model_t *model, backup_t *file);

/* Prints why a row of the file cannot be used, and returns BACKUP_INVALID. */
backup_result_t backup_refuse(const char *path, const backup_row_t *row, const char *why);

#endif
