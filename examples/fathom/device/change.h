/* SPDX-License-Identifier: MIT */
#ifndef CHANGE_H
#define CHANGE_H

#include "device/session.h"

/* A setting of a sensor that is changed. */
typedef struct {
    session_t *session;
    const setting_t *setting;
    int32_t value;
    char wanted[SETTING_TEXT]; /* the value as text */
    char was[SETTING_TEXT];    /* the old value; "": it was not read */
    bool is_blind;             /* nothing was read before the write */
    bool is_for_all;           /* sent to all units on the line */
} change_t;

typedef enum {
    CHANGE_UNCHANGED, /* the sensor had this value already */
    CHANGE_DONE,      /* confirmed, or only acknowledged if the setting cannot be read */
    CHANGE_UNCONFIRMED,
    CHANGE_DIFFERS, /* the sensor reads back another value */
    CHANGE_REFUSED,
    CHANGE_NOT_WRITTEN,
    CHANGE_SENT /* to all units */
} change_outcome_t;

/* Returns the outcome. status: of the last call, FATHOM_OK if every call succeeded. */
change_outcome_t change_outcome(const change_t *change, fathom_status_t status);

/* Prints an outcome that is no success on stderr: what is known, and what to try. */
void change_explain(const change_t *change, change_outcome_t outcome, fathom_status_t status);

/* Prints the outcome. Returns true if the setting has its value, as far as that can be known, and the output worked. */
bool change_report(const change_t *change, fathom_status_t status);

#endif
