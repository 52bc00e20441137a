/* SPDX-License-Identifier: MIT */
#ifndef READING_H
#define READING_H

#include "diagnosis/advice.h"
#include "reading/site.h"

/* What the loop reports of a sensor: a reading, the change of an alarm, or an attempt that failed or could not be made
 * because the port is waited for. */
typedef struct {
    sensor_t *sensor;
    fathom_status_t status;    /* FATHOM_OK: a reading or a change of an alarm */
    const char *failure;       /* the word of `status` for programs; NULL with FATHOM_OK */
    const failure_t *evidence; /* of an attempt that failed; else NULL */
    const result_t *result;    /* of a failure: the time, the address, the probe if it is of one alone */
    uint64_t time_us;          /* since the start of the program; does not wrap */
    uint64_t utc_us;           /* since 1970 */
} reading_t;

#endif
