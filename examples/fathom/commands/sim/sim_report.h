/* SPDX-License-Identifier: MIT */
#ifndef SIM_REPORT_H
#define SIM_REPORT_H

#include "commands/sim/sim_options.h"
#include "sim/sim.h"

/* What there is and how to read it; port: the name to open. */
void sim_announce(FILE *to, const sim_options_t *options, const char *port);

/* What device i has heard and done, as one JSON object: its place on the command line, what it is now (an
 * address or a rate may have been changed), its counters, and the bytes of the whole line that collided. */
void sim_print_counters(FILE *to, const sim_options_t *options, uint32_t i, const fathom_sim_device_t *device,
                        const fathom_sim_line_t *line);

#endif
