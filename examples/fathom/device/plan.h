/* SPDX-License-Identifier: MIT */
#ifndef PLAN_H
#define PLAN_H

#include "device/backup.h"

/* What `fathom restore` is to do with a unit, of what a file and the unit have. */
typedef enum {
    PLAN_NOTHING = 0, /* the file says nothing of it, or the same */
    PLAN_WRITE,
    PLAN_WRITE_UNSEEN, /* the unit does not tell it */
    PLAN_STAYS,        /* another place, where the unit is not to go */
    PLAN_IMPOSSIBLE    /* the unit does not have it */
} plan_step_t;

typedef struct {
    const backup_t *file;
    const backup_t *unit;
    plan_step_t steps[BACKUP_ROWS];
    size_t order
        [BACKUP_ROWS];  /* the rows that are to be written; what moves the unit last, its rate behind all */
    size_t count;       /* of these */
    bool is_impossible; /* the file has what the unit has not */
    bool moves;         /* the unit may go to the address of the file */
} plan_t;

/* moves, changes_rate: the unit may go to the address of the file, the rate of the file. */
void plan_begin(plan_t *plan, const backup_t *file, const backup_t *unit, bool moves, bool changes_rate);

/* Which unit it is, and in what the two differ. */
void plan_print(const plan_t *plan);

/* Says that of what it is of; false: another unit than that of which `one` was read. */
bool plan_print_identity(const backup_t *one, const char *one_is, const backup_t *other,
                         const char *other_is);

#endif
