/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_WIRE_PHASES_H
#define FATHOM_TESTS_WIRE_PHASES_H

#include "wire_desk.h"

/*
 * The transitions between the phases of the desk's line. The phase is sampled in each call of the port, of the
 * clock and of the counters, and so between any two changes within one poll.
 */

/* Begins to watch the desk's line, which was just initialised. */
void phases_watch(void);

/* Samples the phase. `wire.on_call` does this too. */
void phases_sample(void);

/* In place of fathom_line_count() in the config. */
void phases_count(fathom_line_t *line, uint8_t which, uint8_t by);

/* Fails if a transition was seen that src/engine/README.md does not have, or if one of its rows was never seen. */
void phases_expect_table(void);

#endif
