/* SPDX-License-Identifier: MIT */
#ifndef FIELDS_H
#define FIELDS_H

#include "output/record.h"
#include "reading/results.h"

/* The fields of a reading, for JSON, CSV and MQTT. A new field is a row, a member and an assignment in fields.c. */

/* Columns that not every record has: those of some sensors, those of a reading or of the change of an alarm, those of a
 * tank, those of a row of `fathom read`. */
enum {
    COLUMNS_OPTICS = 1,
    COLUMNS_TEMPERATURE = 2,
    COLUMNS_READING = 4,
    COLUMNS_ALARM = 8,
    COLUMNS_LEVEL = 16,
    COLUMNS_DISTANCE = 32,
    COLUMNS_ROW = 64
};

/* A result or a failed attempt, with what the library does not know about it. */
typedef struct {
    const model_t *model;
    const model_mode_t *mode;
    const reader_t *reader;
    const char *name;
    const char *label;   /* the name in text, shorter if there is only one sensor */
    const char *failure; /* a word of status_word.h; NULL if the attempt did not fail */
    const result_t *result;
    const fathom_sample_t *sample; /* of the result */
    uint64_t time_us;              /* since the program's start; does not wrap */
    uint64_t utc_us;               /* since 1970 */
    uint8_t own;                   /* COLUMNS_... of this sensor */
    uint8_t columns;               /* COLUMNS_... of all sensors in the table */
} reading_t;

/* Returns the word of `status`. */
const char *reading_status(const reading_t *reading);

/* Returns true for a switch or a relay contact, which has no distance. */
bool reading_is_contact(const reading_t *reading);

/* Returns true if the reading belongs to one probe. A relay contact belongs to all probes. */
bool reading_has_probe(const reading_t *reading);

/* Writes the fields in reading->own as members of the open object. */
void reading_json(json_t *json, const reading_t *reading);

void reading_csv_header(FILE *to, unsigned columns);
void reading_csv(FILE *to, const reading_t *reading);

/* Writes a line for each field, and a line for each word of `status`. */
void reading_help(FILE *to);

#endif
