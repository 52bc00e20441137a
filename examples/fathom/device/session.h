/* SPDX-License-Identifier: MIT */
#ifndef SESSION_H
#define SESSION_H

#include "diagnosis/advice.h"
#include "output/progress.h"
#include "reading/site.h"
#include "sensors/models.h"

/* ---- a session: one sensor at a port, for commands that read or change more than distances (session.c) ---- */

typedef struct {
    site_t site;
    sensor_t *sensor; /* of the site; a command that takes several sets one after another */
    bool has_begun;   /* host_t.begin was called */
    port_t port;
    progress_t progress;
    const char *doing; /* shown while the calls of a longer task wait; NULL: each call is a task of its own */
    bool is_json;
} session_t;

/* Opens the port of session->sensor, and listens long enough to receive its automatic or unsolicited frames. Returns
 * false after printing why. */
bool session_open(session_t *session, const host_t *host);
void session_close(session_t *session);

/* Asks another sensor on the open port, or the same sensor after its address or its line settings were changed. Cancels
 * the present request. Returns false after printing why. */
bool session_move(session_t *session, uint8_t address, const fathom_line_settings_t *line);

/* Calls until the result is not FATHOM_PENDING, and waits between two calls. A signal ends it: FATHOM_ERR_CANCELLED. If
 * the port is lost: FATHOM_ERR_PORT. */
typedef fathom_status_t (*session_call_t)(reader_t *reader, void *ctx);
fathom_status_t session_call(session_t *session, session_call_t call, void *ctx);

/* Shows on a terminal what the next calls do, such as "reading the settings", if that takes longer than two seconds. The
 * end removes the line; it must come before anything is printed. */
void session_begin_task(session_t *session, const char *doing);
void session_end_task(session_t *session);

/* Reads or writes a setting. Repeats a call that failed and wrote nothing, if the failure proves nothing about the
 * sensor. */
fathom_status_t session_get(session_t *session, const setting_t *setting, char text[SETTING_TEXT]);
fathom_status_t session_set(session_t *session, const setting_t *setting, int32_t value);

/* Returns a sample of a probe. */
fathom_status_t session_measure(session_t *session, fathom_sample_t *sample);

/* The line settings of the sensor, "9600 8N1". Behind a gateway "Modbus TCP". */
const char *session_line_text(const session_t *session, char text[LINE_TEXT]);

/* Prints what failed as one line on stderr and, unless the status is FATHOM_OK, why. Returns false. */
bool session_fail(session_t *session, fathom_status_t status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* ---- which sensor responds at an address (session.c) ---- */

typedef enum {
    PRESENT_NONE,
    PRESENT_ONE,     /* one sensor, as far as three reads show */
    PRESENT_UNCLEAR, /* a damaged or refused response, or two sensors */
    PRESENT_UNKNOWN, /* the line was busy or another master asked there: nothing is known about the address */
    PRESENT_STOPPED  /* the user has ended the command, or the port is lost */
} present_t;

typedef struct {
    present_t what;
    fathom_status_t status;    /* of the last read */
    bool is_two;               /* with PRESENT_UNCLEAR: two responses to one request, or two numbers */
    char number[SETTING_TEXT]; /* with PRESENT_ONE: the UUID; "-" if the model has none */
} presence_t;

/*
 * Moves the session to an address and these line settings, and reads there. PRESENT_NONE needs `times` requests in a row
 * without a response, since one response may be lost. PRESENT_ONE needs three reads of the same UUID (of the address, if
 * the model has no UUID) without damage and without a second response.
 */
presence_t presence_ask(session_t *session, uint8_t address, const fathom_line_settings_t *line,
                        unsigned times);

/* Prints the cause of PRESENT_UNCLEAR or PRESENT_UNKNOWN on stderr, without a line feed. */
void presence_explain(session_t *session, const presence_t *presence);

/* ---- settings as text (change.c) ---- */

/* Stores the value. Returns false if the text is none. */
bool setting_value(const setting_t *setting, const char *text, int32_t *value);

/* Returns the possible values: "0 to 255 s" or "off, on". */
enum { SETTING_VALUES = 400 };
const char *setting_values_text(const setting_t *setting, char text[SETTING_VALUES]);

/* Prints a value: a word, or a number. */
void setting_print_value(const setting_t *setting, int32_t value, char text[SETTING_TEXT]);

/* Returns the value with its unit, "5 s". */
enum { SETTING_CELL = SETTING_TEXT + 16 };
const char *setting_with_unit(const setting_t *setting, const char *text, char cell[SETTING_CELL]);

/* Writes a value as a member of the open object: off and on as booleans, numbers as numbers, all else as a string, and
 * null if `text` is NULL. If `key` is NULL, the key is the name of the setting with underscores. */
void setting_json(json_t *json, const char *key, const setting_t *setting, const char *text);

/* Returns why a sensor that responds did not report this setting. NULL: the status is not about this setting alone. */
const char *setting_reason(fathom_status_t status);

/* Prints all settings with their possible values and effects. */
void settings_print(FILE *to, const setting_t *settings);

/* ---- a setting that is changed (change.c) ---- */

typedef struct {
    session_t *session;
    const setting_t *setting;
    int32_t value;
    char wanted[SETTING_TEXT]; /* the value as text */
    char was[SETTING_TEXT];    /* the old value; "": it was not read */
    bool is_blind;             /* nothing was read before the write */
    bool is_for_all;           /* sent to all units on the line */
} change_t;

typedef enum {
    CHANGE_UNCHANGED, /* the sensor had this value already */
    CHANGE_DONE,      /* confirmed, or only acknowledged if the setting cannot be read */
    CHANGE_UNCONFIRMED,
    CHANGE_DIFFERS, /* the sensor reads back another value */
    CHANGE_REFUSED,
    CHANGE_NOT_WRITTEN,
    CHANGE_SENT /* to all units */
} change_outcome_t;

/* Returns the outcome. status: of the last call, FATHOM_OK if every call succeeded. */
change_outcome_t change_outcome(const change_t *change, fathom_status_t status);

/* Prints an outcome that is no success on stderr: what is known, and what to try. */
void change_explain(const change_t *change, change_outcome_t outcome, fathom_status_t status);

/* Prints the outcome. Returns true if the setting has its value, as far as that can be known, and the output worked. */
bool change_report(const change_t *change, fathom_status_t status);

/* ---- values of a sensor, as it reports them or as a file has them (backup.c) ---- */

typedef enum {
    HELD_NOTHING = 0, /* it was not read, or the file does not have it */
    HELD_VALUE,
    HELD_NOT_READABLE, /* write-only */
    HELD_NOT_THERE,    /* this variant of the sensor does not have it */
    HELD_NOT_SETTABLE  /* the sensor has a value that cannot be set */
} held_t;

typedef struct {
    const setting_t *setting; /* NULL: the end of the rows */
    held_t held;
    char text[SETTING_TEXT]; /* with HELD_VALUE and HELD_NOT_SETTABLE: as the sensor reports it */
    fathom_status_t status;  /* with HELD_NOT_THERE: the reason */
    unsigned line;           /* of the file; 0: none */
} value_t;

enum { VALUES = 32 }; /* Invariant: no model has as many settings. */

typedef struct {
    const model_t *model;
    bool is_known; /* the sensor has responded */
    value_t rows[VALUES];
} values_t;

/* Begins with a row for each setting that is wanted. */
void values_begin(values_t *values, const model_t *model, bool (*is_wanted)(const setting_t *setting));

/* Reads the rows. Returns false after printing which value could not be read; this one and the next rows are not read. A
 * single value may be missing; with is_backup only one that not each sensor has. */
bool values_read(session_t *session, values_t *values, bool is_backup);

/* Returns the value, or the words in its place, such as "not readable". */
const char *value_text(const value_t *value);

bool value_is_same(const value_t *one, const value_t *other);

/* Reads what `fathom save` keeps. */
bool backup_read(session_t *session, values_t *unit);

/*
 * The file of `fathom save`: lines of NAME = VALUE with the names and values of `fathom get` and `fathom set`, after the
 * line sensor = MODEL. A comment begins with #. A value may also be "not readable" and the like. A line ends with LF or
 * CR LF and has at most 250 bytes.
 */

/* Prints the file. place: "address 7, 19200 8E1"; when: UTC. */
void backup_print(FILE *to, const values_t *unit, const char *place, const char *when);

/* Reads the file. moves: the sensor is to get its address. Returns STATUS_OK. After printing what is wrong returns
 * STATUS_FAILED if the file cannot be read, or STATUS_USAGE if a line is wrong. */
int backup_parse(const char *path, const model_t *model, bool moves, values_t *file);

/* ---- a file that is complete or not there (backup.c) ---- */

/* Returns true if no file has this name. Returns false after printing that one has it. */
bool file_is_free(const char *path);

/* Prints a file that appears complete or not at all. It replaces another file only with `replaces`. Returns false after
 * printing the reason. */
typedef void (*file_print_t)(FILE *to, const void *ctx);
bool file_write(const char *path, bool replaces, file_print_t print, const void *ctx);

#endif
