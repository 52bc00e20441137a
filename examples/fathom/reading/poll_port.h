/* SPDX-License-Identifier: MIT */
#ifndef POLL_PORT_H
#define POLL_PORT_H

#include "reading/poll.h"

/* A port of the poll loop: opens it, polls its sensors, and says why it is lost. */

/* A station of it, before the others that it has; before poll_port_begin. */
void poll_port_add(poll_port_t *port, station_t *station);

/* Adds it to the loop's sources, and tries to open it. */
void poll_port_begin(poll_port_t *port, poll_loop_t *loop, const port_options_t *options);

/* One of its sensors, when it is open. False after saying why: its driver does not take its settings. */
bool poll_port_begin_station(poll_port_t *port, station_t *station);

/* Nothing is read there any more, and that is a failure, which was told. */
void poll_port_give_up(poll_port_t *port);

/* Takes it out of the loop. */
void poll_port_end(poll_port_t *port);

/* Leaves its sensors as they were: to be called until it is true. */
bool poll_port_end_stations(poll_port_t *port);

#endif
