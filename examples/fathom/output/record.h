/* SPDX-License-Identifier: MIT */
#ifndef OUTPUT_RECORD_H
#define OUTPUT_RECORD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* ---- JSON ---- */

/* A writer of JSON that keeps the commas. A key is NULL for an element of an array and for the outermost value:
 *
 *     json_t json = {.to = stdout};
 *     json_begin(&json, NULL, '{');
 *     json_string(&json, "name", "tank");
 *     json_end(&json, '}');
 */
typedef struct {
    FILE *to;
    /* Invariant: true if the innermost object or array has a member, so that a comma comes first. */
    bool has_member;
} json_t;

/* Opens an object '{' or an array '[', and closes the innermost one with '}' or ']'. */
void json_begin(json_t *json, const char *key, char bracket);
void json_end(json_t *json, char bracket);

/* Writes a number, true, false or null, formatted as by printf. */
void json_value(json_t *json, const char *key, const char *format, ...) __attribute__((format(printf, 3, 4)));
void json_flag(json_t *json, const char *key, bool flag);

/* Writes a string with its escapes, or null if `text` is NULL. */
void json_string(json_t *json, const char *key, const char *text);

/* Writes bytes as a string of hexadecimal numbers, "01 03 FF". */
void json_bytes(json_t *json, const char *key, const uint8_t *bytes, size_t count);

/* ---- records ---- */

/* A record is a structure that a table of fields describes. JSON, CSV and text are printed from the table, so a field is
 * one row in it. Every member that a row names is an int64_t (or a uint64_t less than 2^63) or a const char *. */

/* The value of an int64_t member that is null. A const char * that is null is NULL. */
#define NO_VALUE INT64_MIN

typedef enum {
    FIELD_NUMBER,
    FIELD_TENTHS,          /* an int64_t that is printed with one decimal */
    FIELD_TEN_THOUSANDTHS, /* an int64_t that is printed with four decimals */
    FIELD_FLAG,            /* an int64_t: 0 is false, 1 is true */
    FIELD_WORD             /* a const char * */
} field_type_t;

/* Every table ends with a row whose key is NULL. */
typedef struct {
    const char *key;  /* snake_case, with the unit at its end */
    const char *unit; /* "" if there is none */
    const char *help; /* NULL if no help lists the field */
    field_type_t type;
    unsigned needs; /* columns that a record must have to have this field: bits of the table's module */
    size_t at;      /* offset of the member */
} field_t;

/* Writes the fields as members of the open object, or as an object in its own line. `columns` are those of this
 * record. */
void record_json(json_t *json, const field_t *fields, const void *record, unsigned columns);
void record_json_line(FILE *to, const field_t *fields, const void *record, unsigned columns);

/* Writes a row of a table that has the columns `all`. What is null or not in `columns` is empty. A record that is NULL
 * is the header. */
void record_csv(FILE *to, const field_t *fields, const void *record, unsigned columns, unsigned all);

/* Writes the fields for people, as "missed_frames 3, temperature_degc 21.5", with `before` in front; null is "-".
 * omits_zero: numbers that are 0 or null are left out. Returns false if nothing was written. */
bool record_print(FILE *to, const char *before, const field_t *fields, const void *record, unsigned columns,
                  bool omits_zero);

/* Writes a line for each field: its key, its unit and its help. */
void record_help(FILE *to, const field_t *fields);

#endif
