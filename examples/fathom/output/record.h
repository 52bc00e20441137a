/* SPDX-License-Identifier: MIT */
#ifndef OUTPUT_RECORD_H
#define OUTPUT_RECORD_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "output/json.h"

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

typedef struct {
    const char *key;  /* snake_case, with the unit at its end */
    const char *unit; /* "" if there is none */
    const char *help; /* NULL if no help lists the field */
    field_type_t type;
    unsigned
        needs; /* Columns that the record must have: bits of the module that has the table. 0: always there. */
    size_t at; /* offset of the member */
} field_t;

/* Every table ends with a row whose key is NULL. */

/* Writes the fields as members of the open object. `columns` are those of this record. */
void record_json(json_t *json, const field_t *fields, const void *record, unsigned columns);

/* Writes the fields as an object in a line of its own. */
void record_json_line(FILE *to, const field_t *fields, const void *record, unsigned columns);

/* Writes the header of a table with these columns. */
void record_csv_header(FILE *to, const field_t *fields, unsigned columns);

/* Writes a row of a table that has the columns `all`. What is null or not in `columns` is empty. */
void record_csv(FILE *to, const field_t *fields, const void *record, unsigned columns, unsigned all);

/* Writes the fields for people, as "missed_frames 3, temperature_degc 21.5"; null is "-". */
void record_print(FILE *to, const field_t *fields, const void *record, unsigned columns);

/* Writes the numbers that are not 0 in the same way, with `before` in front. Returns false if there are none. */
bool record_print_used(FILE *to, const char *before, const field_t *fields, const void *record);

/* Writes a line for each field: its key, its unit and its help. */
void record_help(FILE *to, const field_t *fields);

#endif
