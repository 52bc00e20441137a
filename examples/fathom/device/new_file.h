/* SPDX-License-Identifier: MIT */
#ifndef NEW_FILE_H
#define NEW_FILE_H

#include <stdbool.h>
#include <stdio.h>

enum { NEW_FILE_PATH = 4096 };

/* A file that is there as a whole or not at all, and never takes the place of another one. */
typedef struct {
    const char *path;
    FILE *file; /* to write to, under another name in the same folder */
    char temporary[NEW_FILE_PATH];
} new_file_t;

/* Can there be a new file of this name? False after saying that there is one. */
bool new_file_is_free(const char *path);

/* False after saying why. */
bool new_file_begin(new_file_t *file, const char *path);

/* Now it is there. False, after saying why: nothing is. */
bool new_file_end(new_file_t *file);

#endif
