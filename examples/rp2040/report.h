/* SPDX-License-Identifier: MIT */
#ifndef RP2040_REPORT_H
#define RP2040_REPORT_H

#include "fathom/hal.h"
#include "fathom/sample.h"
#include "fathom/status.h"

enum { REPORT_SIZE = 48 }; /* the longest line */

/*
 * What fathom_poll returned, as a line of text. It does not wait: while another line is leaving, this one is dropped.
 *   target 2083 mm, raw 2083
 *   no target, raw 94000
 *   fault, raw 0
 *   error -3
 */
void report(const fathom_uart_t *uart, fathom_status_t status, const fathom_sample_t *sample);

#endif
