/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_INTERNAL_POSIX_DESCRIBE_H
#define FATHOM_INTERNAL_POSIX_DESCRIBE_H

#include <stddef.h>

/* Error texts that the ports of Linux share. Both functions write one line into `text` and return `text`. */

/* Writes the words of the system for an errno. */
const char *fathom_posix_words(int code, char *text, size_t capacity);

/* Writes why the user may not open `path`, and what to do: the group to join, or, if that would not help, the udev rule
 * that gives the path to `usual_group`. */
const char *fathom_posix_describe_denied(const char *path, const char *usual_group, char *text,
                                         size_t capacity);

#endif
