/* SPDX-License-Identifier: MIT */
#ifndef START_NEWLIB_H
#define START_NEWLIB_H

/* Writes `length` characters of text, and waits until the machine has accepted them. Returns `length`. The machine's
 * print.c defines the function, and newlib's printf() calls it. The start-up code of a chip's maker has it already. */
/* NOLINTNEXTLINE(bugprone-reserved-identifier,readability-identifier-naming): newlib's name */
int _write(int file, const char *text, int length);

#endif
