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
extern const command_t sim_command;

/* The tool: argv[1] names the command. Returns the exit status. */
int run_command(const host_t *host, int argc, char **argv);

/* The topics of `fathom help`; a row without a name ends them. */
extern const help_topic_t topics[];

/* Topics that explain a task from its beginning to its end. */
void topic_log(FILE *to);
void topic_publish(FILE *to);
void topic_delivery(FILE *to);
void topic_boxes(FILE *to);
void topic_service(FILE *to);
void topic_commission(FILE *to);
void topic_calibrate(FILE *to);
void topic_backup(FILE *to);
void topic_request(FILE *to);

/* The topic `faults`, in the folder of `fathom sim`. */
void topic_faults(FILE *to);

/* Writes a line for each field of the JSON of `fathom scan`. */
void scan_help_fields(FILE *to);

#endif
