/* SPDX-License-Identifier: MIT */
#ifndef LOOP_H
#define LOOP_H

#include "reading/run.h"
#include "reading/stats.h"

/*
 * Reads all sensors of a site, in one loop, until the user, a count, a duration, a loss or the sink ends it. `fathom read`,
 * `fathom watch` and `fathom publish` are sinks of this loop.
 */

/* Clears everything. The time of readings starts here. */
void loop_init(loop_t *loop, const host_t *host, const sink_t *sink, void *ctx);

/* Starts to read the site in loop->site, which is the loop's from now on. False: the user knows why no port can be
 * opened or waited for. */
bool loop_open(loop_t *loop);

/*
 * Reads another site instead, between two steps of the loop: in tick. A line whose text is the same goes on. Any other line
 * is closed, and opened again if *site has it. False: a request on a line that has to be closed is pending; nothing
 * changed, call again soon. is_urgent: such a request is given up. When it is true, *site is empty and `old` has what is
 * not read any more, for the caller to free. The lines are started when tick returns.
 */
bool loop_set_site(loop_t *loop, site_t *site, bool is_urgent, site_t *old);

void loop_run(loop_t *loop);
void loop_stop(loop_t *loop);

/* Also after loop_open() failed, or without it. The site stays until loop_deinit(). */
void loop_close(loop_t *loop);
void loop_deinit(loop_t *loop);

/* Returns true if a port is lost, or was never there. */
bool loop_is_lost(const loop_t *loop);

/* Returns true if nothing failed and each sensor gave a reading that is not unknown. A sensor without a reading is good
 * if the user ended the loop, or if its port was still waited for. */
bool loop_is_good(const loop_t *loop);

/* Adds up all counters. */
void loop_account(loop_t *loop, account_t *account);

#endif
