/* SPDX-License-Identifier: MIT */
#ifndef POLL_ATTEMPT_H
#define POLL_ATTEMPT_H

#include "reading/poll.h"

/* What the poll loop makes of one station's attempt to read. */

/* The clock of the host. */
uint64_t poll_now_us(const poll_loop_t *loop);

/* Has it more than one station? */
bool poll_is_shared(const poll_port_t *port);

/* How long a sensor of this port that does not answer is left alone at last: a line that others share is not taken from
 * them. And what remembers what is heard of it. */
uint32_t poll_backoff_us(const poll_port_t *port);
listener_t *poll_listener_of(poll_port_t *port, station_t *station);

/* Is there nothing more to be read, or is the command to end? */
bool poll_is_over(const poll_loop_t *loop);

/* Has it had all the attempts that were asked for? */
bool poll_is_done(const poll_loop_t *loop, const station_t *station);

/* A request is about to leave: the listener of its station. The line has put it at the front. ctx: the
 * poll_port_t. */
listener_t *poll_whose(void *ctx);

/* A late response comes while its unit is asked nothing, and perhaps another one is: it explains the failures of the
 * unit that it is from. */
void poll_take_late(poll_port_t *port);

/* What is heard from now on, and counted, is the next attempt's. */
void poll_begin_attempt(station_t *station);

/* Takes an outcome of its driver, anything but FATHOM_PENDING. */
void poll_take_outcome(poll_port_t *port, station_t *station, fathom_status_t status,
                       const fathom_sample_t *sample);

/* Its port is lost. is_told: another sensor of it has failed for this. */
void poll_take_loss(poll_port_t *port, station_t *station, bool is_told);

#endif
