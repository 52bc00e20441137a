/* SPDX-License-Identifier: MIT */
#ifndef READ_COMMAND_H
#define READ_COMMAND_H

#include <stdio.h>

#include "sensors/model.h"

/* Writes the command that reads a sensor: "fathom read hps167s:7:modbus --port './a port' --baud 57600". address: -1 if
 * the command needs none. The port is quoted for a shell. */
void read_command_print(FILE *to, const model_t *model, const char *mode, int address,
                        const fathom_line_settings_t *line, const char *port);

#endif
