/* SPDX-License-Identifier: MIT */
#include "console.h"

#include <stdio.h>

/* Line by line, so that a crash loses nothing. */
void console_open(void) { setvbuf(stdout, NULL, _IOLBF, 0); }
