/* SPDX-License-Identifier: MIT */
#ifndef ROWS_H
#define ROWS_H

#include "cli/command.h"
#include "device/session.h"
#include "reading/site.h"

/*
 * [NAME=]SENSOR[:ADDRESS][:MODE][@PORT[,key=value...]], as a user names a sensor and its port:
 *
 *     word   = [ NAME "=" ] sensor [ "@" PORT { "," key "=" value } ]
 *     sensor = model [ ":" [ ADDRESS ] ] [ ":" MODE ]
 *
 * A PORT is any path without a comma. An ADDRESS is a number; what begins with a letter is a MODE.
 */
enum { SENSOR_NAME_SIZE = 32 };

typedef struct {
    origin_t origin;
    const char *word;            /* all of it but the keys */
    char name[SENSOR_NAME_SIZE]; /* "": none was given */
    const model_t *model;
    const char *address; /* NULL: none was given; "": the factory's */
    const char *mode;    /* NULL: none was given */
    const char *port;    /* NULL: none was given */
    port_keys_t keys;
    char parts[40];
} sensor_word_t;

/* The keys of serial ports and of GPIO chips: a port_keys_t. */
extern const option_t serial_keys[];
extern const option_t chip_keys[];

/* The name of a key. */
const char *port_key_name(port_key_t key);

/* Can the first `length` bytes of it be a NAME? */
bool sensor_name_is_good(const char *text, size_t length);

/* Cuts the word, into which *sensor then points. *sensor may not be moved. False after rejecting it. */
bool sensor_word_parse(sensor_word_t *sensor, char *word, const origin_t *origin);

/* Parses the ADDRESS of a sensor in this mode. Without one *address stays. False after rejecting it. */
bool sensor_word_address(const sensor_word_t *word, const model_mode_t *mode, uint8_t *address);

/* The model, or the mode of a model, with this name. NULL after rejecting it. */
const model_t *model_word(const char *name, const origin_t *origin);
const model_mode_t *mode_word(const model_t *model, const char *name, const origin_t *origin);

/* The port of a mode on pins, as an example: "gpiochip0,in=5". False: the mode has no pins. */
enum { PORT_EXAMPLE = 80 };
bool pins_example(const model_mode_t *mode, const char *chip, char text[PORT_EXAMPLE]);

/* What options set for the sensors of a command: for their ports, unless a key stands behind one, and for a single
 * sensor. */
typedef struct {
    const char *path; /* NULL: not given */
    port_keys_t keys; /* of serial ports */
    uint32_t address;
    bool has_address;
    const char *mode; /* NULL: not given */
} sensor_defaults_t;

/*
 * Reads the words that name sensors, and finds out which share a port. The words are cut. `asks_all` is set before, all
 * else is set here but what a reader is to do. False after rejecting what cannot be.
 */
bool sensor_words(site_t *site, const sensor_defaults_t *defaults, char **words, int count,
                  const origin_t *origin);

/* The same for sensors whose words were parsed. */
bool sensors_add(site_t *site, const sensor_defaults_t *defaults, const sensor_word_t *words, int count);

/* ---- rows ---- */

/* False: options of a serial port were given for a port over TCP, and the user knows it. */
bool line_options_suit(const port_keys_t *options, const char *path, const origin_t *origin);

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
