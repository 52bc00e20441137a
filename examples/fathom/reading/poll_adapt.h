/* SPDX-License-Identifier: MIT */
#ifndef POLL_ADAPT_H
#define POLL_ADAPT_H

#include "reading/poll.h"

/* Other sensors on a port that stays open. */

/* Is it open, and are its sensors asked by their addresses? Then others can come and go, and the line stays as it is. */
bool poll_may_adapt(const poll_port_t *port);

/* These are its sensors from now on, and port->options are as they need. Those that it had already go on, and a request of theirs
 * that is under way with them; the others begin; those that are not named have gone. */
void poll_adapt(poll_port_t *port, station_t *const *stations, size_t count);

#endif
