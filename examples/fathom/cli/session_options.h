/* SPDX-License-Identifier: MIT */
#ifndef SESSION_OPTIONS_H
#define SESSION_OPTIONS_H

#include "cli/complete.h"
#include "cli/rows.h"
#include "device/session.h"

/* The options of commands that send requests to one sensor; the first member of the settings of such a command. */
typedef struct {
    sensor_settings_t sensors;
    bool is_json;
    bool is_confirmed; /* --yes */
} session_settings_t;

extern const option_t session_format_rows[];
extern const option_t session_yes_rows[];

/* The tables of these commands, before their own. */
#define SESSION_TABLES                                                                                       \
    {word_rows, offsetof(session_settings_t, sensors.defaults)},                                             \
        {request_rows, offsetof(session_settings_t, sensors.reader)},                                        \
    {                                                                                                        \
        port_rows, offsetof(session_settings_t, sensors.defaults)                                            \
    }

/* Reads the first words of a command, at most `most` of them, as sensors in modes that send requests, and begins a
 * session with the first. At most `rest` words may follow. False after rejecting what is wrong. */
bool session_read(session_t *session, const arguments_t *arguments, int most, int rest);

/* Changes the mode of the sensor, unless the user has chosen another one. False after rejecting that. */
bool session_set_mode(session_t *session, const arguments_t *arguments, const model_mode_t *mode);

/* Can settings be written at the sensor's address? False after rejecting it. */
bool session_can_set(const session_t *session, const arguments_t *arguments);

/* The setting of the session's sensor with this name. NULL after rejecting it. */
const setting_t *setting_named(const session_t *session, const char *name, const arguments_t *arguments);

/* Returns true if the user confirms a dangerous action: by --yes, or by "y" on a terminal. Without a terminal and
 * --yes, the action is rejected. */
bool confirm(const arguments_t *arguments, bool is_confirmed, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

#endif
