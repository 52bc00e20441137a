/* SPDX-License-Identifier: MIT */
#ifndef COMMANDS_H
#define COMMANDS_H

#include "cli/command.h"

/* The commands, a folder each; settings/ has four, backup/ two. */
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
extern const command_t sim_command;

/* The tool: argv[1] names the command. Returns the exit status. */
int run_command(const host_t *host, int argc, char **argv);

#endif
