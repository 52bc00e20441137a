/* SPDX-License-Identifier: MIT */
#ifndef COMMISSION_H
#define COMMISSION_H

#include "commands/commission/commission_options.h"
#include "commands/commission/record.h"
#include "device/presence.h"

/* What the files of this folder share. */
typedef struct {
    commission_options_t options;
    session_t session;
    record_t record;
    const model_t *model;
    unsigned write_count;
    unsigned unwritten_count; /* how often in a row a sensor responded and then could not be written */
    char prompt[200];         /* the last instruction to the user, which is not repeated */
} commission_t;

/* The result for one sensor. */
typedef enum {
    COMMISSION_DONE,   /* it has its address. Its record is `done`, or the user has to switch it off and on */
    COMMISSION_LATER,  /* nothing was written, and the user knows what to do */
    COMMISSION_STOPPED /* the command ends; the reason was printed, or the user has ended it */
} commission_end_t;

/* Returns the stream for people: stdout, or stderr with JSON. */
FILE *commission_text(const commission_t *run);

/* Prints an instruction to the user, unless it is the same as the last one. */
void commission_prompt(commission_t *run, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Returns true if the user has ended the command. */
bool commission_has_ended(const commission_t *run);

/* Gives the only sensor at address `at` the address that is planned for it, and verifies it there. */
commission_end_t commission_sensor(commission_t *run, const record_unit_t *plan, uint8_t at);

/* What a sensor responded at its own address. */
typedef struct {
    char termination[SETTING_TEXT]; /* "": the model has none */
    bool is_complete;               /* the termination reads as it was set */
    fathom_sample_t sample;
} commission_proof_t;

/* Verifies a sensor at its own address: its UUID, its termination, a measurement, and that no sensor with the same UUID
 * remains at address 1. Returns false after printing what is wrong. */
bool commission_verify(commission_t *run, const record_unit_t *unit, commission_proof_t *proof);

/* Prints the result for a sensor, without flushing. proof NULL: it is not done. */
void commission_report(const commission_t *run, const record_unit_t *unit, const commission_proof_t *proof);

#endif
