/* SPDX-License-Identifier: MIT */
#ifndef FIELDS_H
#define FIELDS_H

#include "output/record.h"
#include "reading/reading.h"

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

/* Returns the columns of this sensor in `fathom read`. */
unsigned sensor_columns(const sensor_t *sensor);

/* Returns the word of `status`. */
const char *reading_status(const reading_t *reading);

/* Returns true if the reading belongs to one probe. A relay contact belongs to all probes. */
bool reading_has_probe(const reading_t *reading);

/* Writes these columns as members of the open object. */
void reading_json(json_t *json, const reading_t *reading, unsigned columns);

void reading_csv_header(FILE *to, unsigned columns);

/* Writes a row with the columns of a table. */
void reading_csv(FILE *to, const reading_t *reading, unsigned columns);

/* Writes a line for each field, and a line for each word of `status`. */
void reading_help(FILE *to);

#endif
