/* SPDX-License-Identifier: MIT */
#ifndef PLAN_H
#define PLAN_H

#include "device/backup.h"

/* What `fathom restore` does with a setting. */
typedef enum {
    PLAN_NOTHING = 0, /* the file does not have it, or has the same value */
    PLAN_WRITE,
    PLAN_WRITE_UNSEEN, /* it is write-only, so it cannot be compared */
    PLAN_STAYS,        /* an address or a baud rate that is not to change */
    PLAN_IMPOSSIBLE    /* the sensor does not have it */
} plan_step_t;

typedef struct {
    const backup_t *file;
    const backup_t *unit;
    plan_step_t steps[BACKUP_ROWS];
    size_t order
        [BACKUP_ROWS]; /* rows to write. Those that move the sensor come last, and its baud rate at the end */
    size_t count;      /* of these */
    bool is_impossible; /* a step is PLAN_IMPOSSIBLE */
    bool moves;         /* the sensor may get the address of the file */
} plan_t;

/* Compares a file with a sensor. moves, changes_rate: the sensor may get the address, the baud rate of the file. */
void plan_init(plan_t *plan, const backup_t *file, const backup_t *unit, bool moves, bool changes_rate);

/* Prints which sensor it is, and the differences. */
void plan_print(const plan_t *plan);

/* Prints the versions and numbers of both. Returns false if `other` is another sensor. */
bool plan_print_identity(const backup_t *one, const char *one_is, const backup_t *other,
                         const char *other_is);

#endif
