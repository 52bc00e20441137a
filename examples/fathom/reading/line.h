/* SPDX-License-Identifier: MIT */
#ifndef LINE_H
#define LINE_H

#include "reading/run.h"

/* A line of the loop: opens its port, polls its sensors, and waits for a lost port. */

/* Adds the line to the loop's sources, and tries to open its port. */
void line_start(line_t *line, loop_t *loop);

/* Takes the line out of the loop, and closes its port. Not within a step of the loop. */
void line_remove(line_t *line);

/* Lets the sensors leave their devices as they were before. Call it until it returns true. */
bool line_end_sensors(line_t *line);

/* Returns true if a request on the line is pending. */
bool line_is_busy(const line_t *line);

#endif
