/* SPDX-License-Identifier: MIT */
#ifndef REQUEST_REPORT_H
#define REQUEST_REPORT_H

#include "commands/request/request.h"
#include "diagnosis/counters.h"

/* Writes the bytes and their meaning to standard output, as text or JSON. */
void request_print(const request_ask_t *ask, const port_t *port);

/* Prints on standard error what failed, or what else the user has to know. counters: of this attempt. */
void request_print_problem(const request_ask_t *ask, const port_t *port, const counters_t *counters);

/* Returns true if a unit responded, or if the request was sent to all units. */
bool request_is_good(const request_ask_t *ask);

#endif
