/* SPDX-License-Identifier: MIT */
#ifndef POLL_CHANGE_H
#define POLL_CHANGE_H

#include "reading/poll.h"

/*
 * From now on the loop reads what `next` names, whose stations are others than the loop's (sensor_options_t.beside). A port
 * of which nothing has changed, nor of its sensors, is not touched. One that is open and whose sensors are asked by their
 * addresses stays open when some of them come or go, and a request of those that stay goes on. Any other one is closed, and
 * opened anew. A sensor that is named as it was before stays the same station, and goes on.
 *
 * Only between two steps of the loop. False: a request is under way that would be given up, and nothing has changed; to be called
 * again, soon. is_urgent: what is under way is given up. `next` has the stations that are read, when it is done, and its ports
 * are the loop's; it may be forgotten, but what their paths point into.
 */
bool poll_loop_change(poll_loop_t *loop, const sensor_options_t *next, bool is_urgent);

#endif
