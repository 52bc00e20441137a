/* SPDX-License-Identifier: MIT */
#ifndef EVENTS_H
#define EVENTS_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom_loop.h"

/*
 * What a command waits for: its port, the time, and the wish to end it. SIGINT, SIGTERM and SIGHUP (unless
 * nohup has it ignored) only leave a mark, which cannot be missed between looking and sleeping; a broken
 * or limited output is told by write errors, not by SIGPIPE or SIGXFSZ.
 */

/* False, after saying why, when the system has no descriptor left. */
bool events_begin(void);

/* From now on this signal (SIGUSR1, SIGWINCH) ends no more than a sleep, and is noted. One of them a command. */
void events_note(int number);

/* Has it come since this was last called? */
bool events_noted(void);

/* Has a signal asked to end? */
bool events_ended(void);

/* Has the standard output lost its reader, as far as a sleep has seen? */
bool events_output_gone(void);

/*
 * Sleeps until one of `events` (poll(2)) happens on fd, max_us microseconds (FATHOM_NO_DEADLINE: no limit) have
 * passed, a signal has come, or the command is to end. watch_output: also until the reader of the standard output goes
 * away.
 */
void events_wait(int fd, short events, uint32_t max_us, bool watch_output);

/* From now on the same, with watch_output, ends each sleep of this loop. One loop a command. */
void events_attend(fathom_loop_t *loop);

#endif
