/* SPDX-License-Identifier: MIT */
#ifndef SESSION_H
#define SESSION_H

#include "cli/command.h"
#include "cli/sensor_options.h"
#include "ports/line_text.h"
#include "sensors/setting.h"

/* A session with one sensor at a port: what all commands share that ask for, or change, more than distances. */
typedef struct {
    site_t site;
    sensor_t *station; /* the only one; with session_options_of_several each in turn */
    bool has_begun;    /* the host */
    port_t port;
    port_counts_t port_counts;
    bool is_json;
} session_t;

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

/* Its port. */
const port_options_t *session_port(const session_t *session);

/* The same sensor in another of its modes; after a usage error false: the user has asked for another one. */
bool session_set_mode(session_t *session, const char *command, const char *const *values,
                      const model_mode_t *mode);

/* Can anything be set at its address? False after a usage error. */
bool session_can_set(const session_t *session, const char *command);

/* The table of the sensor's settings. */
const setting_t *session_settings(const session_t *session);

/* For session->station, which may be another one than before. False after saying why. */
bool session_open(session_t *session, const host_t *host);
void session_close(session_t *session);

/* On the open port from now on the sensor is asked at this address, at these line settings: another one, or the same
 * one that has been moved. What was under way is given up. False after saying why. */
bool session_move(session_t *session, uint8_t address, const fathom_line_settings_t *line);

/* Asks nothing for so long; what is heard is added to what the last call has heard. A signal ends it. */
void session_listen(session_t *session, uint32_t for_us);

/* Calls until it is not FATHOM_PENDING, waiting as long as it may. A signal ends it: FATHOM_ERR_CANCELLED. */
typedef fathom_status_t (*session_call_t)(reader_t *reader, void *ctx);
fathom_status_t session_call(session_t *session, session_call_t call, void *ctx);
fathom_status_t session_get(session_t *session, const setting_t *setting, char text[SETTING_TEXT]);
fathom_status_t session_set(session_t *session, const setting_t *setting, int32_t value);

/* "9600 8N1", at which the sensor is asked; of a connection "Modbus TCP". */
const char *session_line_text(const session_t *session, char text[LINE_TEXT]);

/* What has gone wrong with the last call, and what to try, without a line feed. A response that cannot be what was
 * asked for is no distance here. */
void session_explain(session_t *session, fathom_status_t status);

/* The help of the options, and of those of a command that has no --format. */
void session_options_help(FILE *to);
void session_line_help(FILE *to);

#endif
