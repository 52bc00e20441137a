/* SPDX-License-Identifier: MIT */
#ifndef COMMANDS_H
#define COMMANDS_H

#include "cli/command.h"

extern const command_t scan_command;
extern const command_t read_command;
extern const command_t watch_command;
extern const command_t publish_command;
extern const command_t info_command;
extern const command_t get_command;
extern const command_t set_command;
extern const command_t commission_command;
extern const command_t calibrate_command;
extern const command_t save_command;
extern const command_t restore_command;
extern const command_t reset_command;
extern const command_t request_command;
extern const command_t decode_command;
extern const command_t models_command;
extern const command_t sim_command;

/* The tool: argv[1] names the command. Returns the exit status. */
int run_command(const host_t *host, int argc, char **argv);

/* ---- tables in the topics of `fathom help`, a line for each row ---- */

void scan_help_fields(FILE *to); /* of the JSON of `fathom scan` */
void sim_print_traits(FILE *to); /* of simulated sensors, */
void sim_print_faults(FILE *to); /* and of what can happen to their frames */

#endif
