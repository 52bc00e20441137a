/* SPDX-License-Identifier: MIT */
#ifndef SESSION_H
#define SESSION_H

#include "fathom/hps167s_auto.h"
#include "settings/settings.h"
#include "stations/sensor_options.h"

/* One sensor on a port, with which commands are exchanged: what `fathom get`, `set`, `info` and `reset` share. */
typedef struct {
    session_options_t options;
    station_t *station; /* the only one */
    channel_t channel;
    port_counts_t port_counts;
    fathom_hps167s_auto_t hears; /* frames that an hps167s sends unasked, so that the driver knows of them */
    bool is_json;
} talk_t;

/* The options of these commands: the first rows of a command's table. */
enum { TALK_MODE = SESSION_OPTIONS, TALK_ADDRESS, TALK_FORMAT, TALK_HELP, TALK_OPTIONS };
#define TALK_OPTION_ROWS                                                                                     \
    SESSION_OPTION_ROWS, [TALK_MODE] = {"mode", required_argument, NULL, 256},                               \
                         [TALK_ADDRESS] = {"address", required_argument, NULL, 256},                         \
                         [TALK_FORMAT] = {"format", required_argument, NULL, 256},                           \
                         [TALK_HELP] = {"help", no_argument, NULL, 256}
extern const struct option talk_table[TALK_OPTIONS + 1];

/*
 * Reads the options and the sensor, argv's first word that is no option; the words behind it are left in words[0] to
 * words[*count - 1]. The mode is the one in which the sensor is asked. needs_port: false, where the command can do
 * something without. False after a usage error. wants_help: --help was given, nothing else was looked at.
 */
bool talk_options(talk_t *talk, const char *command, int argc, char **argv, const struct option *table,
                  const char **values, char ***words, int *count, bool *wants_help);

/* The same sensor in another of its modes; after a usage error false: the user has asked for another one. */
bool talk_set_mode(talk_t *talk, const char *command, const char *const *values, const char *mode);

/* The table of the sensor's settings. */
const setting_t *talk_settings(const talk_t *talk);

/* False after saying why. */
bool talk_open(talk_t *talk, const host_t *host);
void talk_close(talk_t *talk);

/* Calls until it is not FATHOM_PENDING, waiting as long as it may. A signal ends it: FATHOM_ERR_CANCELLED. */
typedef fathom_status_t (*talk_call_t)(reader_t *reader, void *ctx);
fathom_status_t talk_call(talk_t *talk, talk_call_t call, void *ctx);
fathom_status_t talk_get(talk_t *talk, const setting_t *setting, char text[SETTING_TEXT]);
fathom_status_t talk_set(talk_t *talk, const setting_t *setting, int32_t value);

/* "9600 8N1", at which the sensor is asked; of a connection "Modbus TCP". */
const char *talk_line_text(const talk_t *talk, char text[SETTINGS_TEXT]);

/* What has gone wrong with the last call, and what to try, without a line feed. An answer that cannot be what was asked
 * for is no distance here. */
void talk_explain(talk_t *talk, fathom_status_t status);

/* The help of the options. */
void talk_options_help(FILE *to);

/* A value as JSON: a number, or a string. */
void talk_print_json(FILE *to, const char *text);

#endif
