/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_INTERNAL_POSIX_DESCRIBE_H
#define FATHOM_INTERNAL_POSIX_DESCRIBE_H

#include <stddef.h>

/* What the ports of Linux say in the same words. Both write one line into text, and return it. */

/* The system's words of an errno. */
const char *fathom_posix_words(int code, char *text, size_t capacity);

/* Why this path may not be opened, and what to do: the group to join, or, where that would not help, the udev rule that
 * gives it to usual_group. */
const char *fathom_posix_describe_denied(const char *path, const char *usual_group, char *text,
                                         size_t capacity);

#endif
