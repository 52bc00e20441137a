/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_LOOP_FAR_END_H
#define FATHOM_TESTS_LOOP_FAR_END_H

#include <sys/types.h>

#include "posix_pty.h"

/* HPS-167S of address 1, one behind each pseudo terminal, in a process of their own: what they call is not counted. They
 * answer each request with 2083 mm. */
enum { FAR_END_MM = 2083, FAR_END_MOST = 64 };

/* The pseudo terminals are open, and stay so. late_ms: until it answers; it does nothing else meanwhile. */
pid_t far_end_begin(const posix_pty_t *ptys, unsigned count, unsigned late_ms);
void far_end_end(pid_t child);

#endif
