/* SPDX-License-Identifier: MIT */
#ifndef SCAN_REPORT_H
#define SCAN_REPORT_H

#include <stdio.h>

#include "sensors/finding.h"

/* A finding in one line, with what to type next where there is something. port: as the user gave it. */
void scan_print_text(FILE *to, const scan_finding_t *finding, const char *port);
void scan_print_json(FILE *to, const scan_finding_t *finding, const char *port);

/* What the finding calls for besides its line, on `to`; nothing for most. */
void scan_print_advice(FILE *to, const scan_finding_t *finding);

#endif
