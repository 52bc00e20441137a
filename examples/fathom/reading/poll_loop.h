/* SPDX-License-Identifier: MIT */
#ifndef POLL_LOOP_H
#define POLL_LOOP_H

#include "reading/poll.h"

/* Reads the sensors on all ports, in one loop, until the user, the count, the time or a loss ends it: what `fathom read`
 * and `fathom watch` share. */

/* To be called first; all of it is cleared. */
void poll_loop_begin(poll_loop_t *loop, const host_t *host, const poll_loop_user_t *user, void *ctx);

/* Opens the ports. False, after saying why: none can be opened or is waited for, or a driver did not take its
 * settings. */
bool poll_loop_open(poll_loop_t *loop);

void poll_loop_run(poll_loop_t *loop);

/* Also where it was not opened. */
void poll_loop_close(poll_loop_t *loop);

/* Is a port lost, or has it not been there yet? */
bool poll_loop_is_lost(const poll_loop_t *loop);

/* Has nothing failed, and has each sensor given a reading that is not unknown? One that has said nothing is forgiven
 * where the user ended it, or its port was still waited for. A port that could not be opened is a failure. */
bool poll_loop_is_good(const poll_loop_t *loop);

/* Takes and adds up all counters. */
void poll_loop_account(poll_loop_t *loop, account_t *account);

/* How long it has been running; and for a sample, when that was. */
uint64_t poll_loop_time_us(const poll_loop_t *loop);
uint64_t poll_loop_sample_us(const poll_loop_t *loop, const fathom_sample_t *sample);

#endif
