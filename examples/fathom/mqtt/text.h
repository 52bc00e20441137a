/* SPDX-License-Identifier: MIT */
#ifndef TEXT_H
#define TEXT_H

#include <stddef.h>

/* Adds to a text of `capacity` bytes, as printf has it; what does not fit is left out. */
void text_add(char *text, size_t capacity, const char *format, ...) __attribute__((format(printf, 3, 4)));

#endif
