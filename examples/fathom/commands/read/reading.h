/* SPDX-License-Identifier: MIT */
#ifndef READING_H
#define READING_H

#include "reading/results.h"

/* Members and columns that are not always there: of some sensors, of readings, of the changes of an alarm, and of a
 * tank. */
enum {
    COLUMNS_OPTICS = 1,
    COLUMNS_TEMPERATURE = 2,
    COLUMNS_READING = 4,
    COLUMNS_ALARM = 8,
    COLUMNS_LEVEL = 16
};

/* One line of output: a result, or an attempt that has failed, and what the library does not know of it. */
typedef struct {
    const model_t *model;
    const model_mode_t *mode;
    const reader_t *reader;
    const char *name;
    const char *label;   /* the name in text, shorter where there is one sensor alone */
    const char *failure; /* a word of `status`; NULL: it has not failed */
    const result_t *result;
    const fathom_sample_t *sample; /* the result's */
    uint64_t time_us;              /* since the program's start; does not wrap */
    uint64_t utc_us;               /* since 1970 */
    uint8_t own;                   /* COLUMNS_... of this sensor, ... */
    uint8_t columns;               /* ... and of all that stand in the same table */
} reading_t;

#endif
