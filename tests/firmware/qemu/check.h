/* SPDX-License-Identifier: MIT */
#ifndef QEMU_CHECK_H
#define QEMU_CHECK_H

#include <stdbool.h>
#include <stdint.h>

/* For images that test themselves: each writes a line "ok WHAT" or "FAILED WHAT", by semihosting. */
void check(bool is_right, const char *what);

/* Is `value` at least `least` and at most `most`? If not, the three are written too, in hex. */
void check_within(uint32_t value, uint32_t least, uint32_t most, const char *what);

/* What main returns: 0 if nothing failed, else 1. */
int check_result(void);

#endif
