/* SPDX-License-Identifier: MIT */
#ifndef REQUEST_REPORT_H
#define REQUEST_REPORT_H

#include "commands/request/request.h"
#include "diagnosis/counters.h"

/* Writes what came of it: bytes and what they say to stdout, as text or JSON. */
void request_print(const request_ask_t *ask, const port_t *port);

/* Says on stderr what went wrong, or what else is to be known. counters: of this attempt. */
void request_tell(const request_ask_t *ask, const port_t *port, const counters_t *counters);

/* Has the request been answered, or been sent to all units? */
bool request_is_good(const request_ask_t *ask);

#endif
