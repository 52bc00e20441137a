/* SPDX-License-Identifier: MIT */
#ifndef ROWS_H
#define ROWS_H

#include "cli/command.h"
#include "cli/sensor_words.h"
#include "device/session.h"
#include "reading/site.h"

/* Options that several commands have, and keys of a configuration file. */

/* Capabilities of a mode beside READER_TAKES_...; an option that needs one of these has no effect without it, which is
 * no error. */
enum { SUITS_REQUESTS = 0x100, SUITS_ADDRESS = 0x200, SUITS_NOTICES = SUITS_REQUESTS | SUITS_ADDRESS };

extern const option_t port_rows[];      /* a sensor_defaults_t: the port and its line */
extern const option_t word_rows[];      /* a sensor_defaults_t: address and mode */
extern const option_t interval_rows[];  /* a reader_settings_t */
extern const option_t request_rows[];   /* a reader_settings_t: time-out and retries */
extern const option_t reading_rows[];   /* a reader_settings_t: what distances are, and which */
extern const option_t reconnect_rows[]; /* a run_settings_t */
extern const option_t result_rows[];    /* a results_config_t */

/* Until when a command reads. */
typedef struct {
    uint64_t duration_us; /* 0: endless */
    bool reconnect;
} run_settings_t;

/* The sensors of a command, as words and options name them. */
typedef struct {
    sensor_defaults_t defaults;
    reader_settings_t reader; /* of each sensor */
    run_settings_t run;
} sensor_settings_t;

/* The longest time without a distance that can be set; the library's is 35 minutes. */
enum { MAX_UNKNOWN_MS = 2000000 };

/* Fills in what follows from the interval of the sensors, and rejects what does not outlast it. */
bool results_finish(results_config_t *results, uint32_t interval_us, const origin_t *origin);

/* Does each option that was given have an effect on at least one of the sensors? Else rejects it, or prints a notice
 * unless is_quiet. `lines` of the file where each was given, if it is one. */
bool options_suit(const option_table_t *tables, const option_given_t *given, sensor_t *const *stations,
                  size_t count, bool is_quiet, const origin_t *origin);

/* Reads the first `count` words of a command as sensors, with what the options set for them. False after rejecting. */
bool sensors_read(site_t *site, const arguments_t *arguments, const sensor_settings_t *settings, int count,
                  bool is_quiet);

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
