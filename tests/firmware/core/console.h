/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_CONSOLE_H
#define FATHOM_TESTS_CONSOLE_H

/* Gives stdout and stderr somewhere to go, where the C library does not. May be called again. */
void console_open(void);

#endif
