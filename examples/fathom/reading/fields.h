/* SPDX-License-Identifier: MIT */
#ifndef FIELDS_H
#define FIELDS_H

#include "output/record.h"
#include "reading/loop.h"

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

/* Writes the columns of the sensor as an object in its own line. */
void reading_json_line(FILE *to, const reading_t *reading);

/* Write a row with the columns of a table. */
void reading_csv_header(FILE *to, unsigned columns);
void reading_csv(FILE *to, const reading_t *reading, unsigned columns);

/* Writes a line for each field, and a line for each word of `status`. */
void reading_help(FILE *to);

/* ---- counters (stats.c) ---- */

/* Prints the sums in two lines, and a line for each of several sensors. Counters of the line that are 0 are left out. */
void stats_print_short(const account_t *account, FILE *to);

/* Prints all counters as lines of text, or as JSON objects in a line each. Counters of pulses begin again. */
void stats_print(const account_t *account, FILE *to);
void stats_print_json(const account_t *account, FILE *to);

/* Writes the counters of one sensor as members of the open object. */
void stats_json_of_sensor(json_t *json, sensor_t *sensor);

#endif
