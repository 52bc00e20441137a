/* SPDX-License-Identifier: MIT */
#ifndef SESSION_OPTIONS_H
#define SESSION_OPTIONS_H

#include "cli/command.h"
#include "cli/sensor_options.h"
#include "device/session.h"

/* The options of these commands: the first rows of a command's table. */
enum { SESSION_MODE = SENSOR_OPTIONS, SESSION_ADDRESS, SESSION_FORMAT, SESSION_HELP, SESSION_OPTIONS };
#define SESSION_OPTION_ROWS                                                                                  \
    SENSOR_OPTION_ROWS, [SESSION_MODE] = {"mode", required_argument, NULL, 256},                             \
                        [SESSION_ADDRESS] = {"address", required_argument, NULL, 256},                       \
                        [SESSION_FORMAT] = {"format", required_argument, NULL, 256},                         \
                        [SESSION_HELP] = {"help", no_argument, NULL, 256}
extern const struct option session_table[SESSION_OPTIONS + 1];

/*
 * Reads the options and the sensor, argv's first word that is no option; the words behind it are left in words[0] to
 * words[*count - 1]. The mode is the one in which the sensor is asked. False after a usage error. wants_help: --help was
 * given, nothing else was looked at.
 */
bool session_options(session_t *session, const char *command, int argc, char **argv,
                     const struct option *table, const char **values, char ***words, int *count,
                     bool *wants_help);

/* The same for a command that takes a sensor and no word behind it. False: the command is over, and *status is its exit
 * status: --help was printed, or a usage error. */
bool session_options_of_one(session_t *session, const command_t *command, int argc, char **argv,
                            const struct option *table, const char **values, int *status);

/* The same for a command that takes several sensors, and nothing else. */
bool session_options_of_several(session_t *session, const command_t *command, int argc, char **argv,
                                const struct option *table, const char **values, int *status);

/* The same sensor in another of its modes; after a usage error false: the user has asked for another one. */
bool session_set_mode(session_t *session, const char *command, const char *const *values,
                      const model_mode_t *mode);

/* Can anything be set at its address? False after a usage error. */
bool session_can_set(const session_t *session, const char *command);

/* The help of the options, and of those of a command that has no --format. */
void session_options_help(FILE *to);
void session_line_help(FILE *to);

#endif
