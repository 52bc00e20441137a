/* SPDX-License-Identifier: MIT */
#ifndef START_SEMIHOSTING_H
#define START_SEMIHOSTING_H

#include <stdint.h>

/*
 * A simulator or a debugger that does for a program what an operating system would ("Semihosting for AArch32 and
 * AArch64" 2.0; RISC-V has the same calls). QEMU needs -semihosting-config enable=on. On a board without a debugger
 * each of these is a fault.
 */

/* Text, 0 at its end. */
void semihosting_write(const char *text);

/* The simulator ends, with this exit status. Where it goes on, this returns. */
void semihosting_exit(int status);

#endif
