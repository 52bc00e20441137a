/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TEST_AVR_TRACE_H
#define FATHOM_TEST_AVR_TRACE_H

#include <stdint.h>

/*
 * Which instructions of an image were executed, and where each of them has led: for tests/verify/coverage, which names a folder
 * in FATHOM_TRACE. Without that all of it does nothing. A file for each run: the image's path, then a line "FROM TO" for
 * each pair, in hex. Of one instruction two places are kept: a conditional branch has no more.
 */
void trace_begin(const char *image);
void trace_step(uint32_t from, uint32_t to); /* addresses of bytes; interrupts are no part of it */
void trace_end(void);

#endif
