/* SPDX-License-Identifier: MIT */
#ifndef NEW_FILE_H
#define NEW_FILE_H

#include <stdbool.h>
#include <stdio.h>

enum { NEW_FILE_PATH = 4096 };

/* A new file that appears complete or not at all, and never replaces another one. */
typedef struct {
    const char *path;
    FILE *file; /* to write to, under another name in the same folder */
    char temporary[NEW_FILE_PATH];
} new_file_t;

/* Each of these returns false after printing the reason. */

/* Checks that no file has this name. */
bool new_file_is_free(const char *path);
bool new_file_open(new_file_t *file, const char *path);

/* Completes the file and gives it its name. */
bool new_file_close(new_file_t *file);

#endif
