/* SPDX-License-Identifier: MIT */
#ifndef REQUEST_EFFECTS_H
#define REQUEST_EFFECTS_H

#include "commands/request/request_options.h"

/* Says on stderr what the request may do, a line each. True: it is sent only if that is meant. */
bool request_effects(const request_t *request);

/* Returns true if the request changes nothing, so that it may be sent while others send. */
bool request_may_collide(const request_t *request);

#endif
