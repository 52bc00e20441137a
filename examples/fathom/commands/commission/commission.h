/* SPDX-License-Identifier: MIT */
#ifndef COMMISSION_H
#define COMMISSION_H

#include "commands/commission/commission_options.h"
#include "commands/commission/presence.h"
#include "commands/commission/record.h"

/* What the files of this folder share. */
typedef struct {
    commission_options_t options;
    session_t session;
    record_t record;
    const model_t *model;
    unsigned writes;     /* that were made */
    unsigned unwritten;  /* how often in a row a unit answered, and then nothing could be written to it */
    char last_told[200]; /* the last thing that the user was told to do: not again while it is so */
} commission_t;

/* What became of a unit. */
typedef enum {
    COMMISSION_DONE,
    COMMISSION_LATER,   /* nothing was written, and the user has been told what to do */
    COMMISSION_RESTART, /* it reads what was written from its next power-on only */
    COMMISSION_STOPPED  /* what is known has been said, or the user has ended it */
} commission_end_t;

/* Where people read: stdout, or beside the objects on it. */
FILE *commission_text(const commission_t *run);

/* Tells the user what to do, once. */
void commission_tell(commission_t *run, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Has the user ended it? */
bool commission_has_ended(const commission_t *run);

/* Gives the unit at address `at`, which was found there by itself, the address that is planned for it. */
commission_end_t commission_unit(commission_t *run, const record_unit_t *plan, uint8_t at);

/* At its own address: is it that unit, with its settings, measuring, and is none left at address 1? */
typedef struct {
    char termination[SETTING_TEXT]; /* "": the model has none */
    bool is_complete;               /* and reads as it is to */
    fathom_sample_t sample;
} commission_proof_t;
bool commission_verify(commission_t *run, const record_unit_t *unit, commission_proof_t *proof);

/* At its address: does it read as it is to? Where it is not waited for until its next power-on: true. */
bool commission_is_restarted(commission_t *run, const record_unit_t *unit);

/* Says that a unit is done; proof NULL: that it is still open. Not flushed. */
void commission_report(const commission_t *run, const record_unit_t *unit, const commission_proof_t *proof);

#endif
