/* SPDX-License-Identifier: MIT */
#ifndef CHANGE_H
#define CHANGE_H

#include "device/session.h"

/* One setting of one device that is changed, and what has become of it. */
typedef struct {
    session_t *session;
    const setting_t *setting;
    int32_t value;
    char wanted[SETTING_TEXT];
    char was[SETTING_TEXT]; /* "": it was not read */
    bool is_blind;
    bool is_for_all;
} change_t;

/* What has become of a setting, and whether it holds now is known. */
typedef enum {
    CHANGE_UNCHANGED,
    CHANGE_DONE, /* confirmed, or acknowledged where it cannot be read */
    CHANGE_UNCONFIRMED,
    CHANGE_DIFFERS,
    CHANGE_REFUSED,
    CHANGE_NOT_WRITTEN,
    CHANGE_SENT /* to all units */
} change_outcome_t;

/* As words, by outcome. */
extern const char *const change_outcomes[];

/* status: of the last call, FATHOM_OK if all went well. */
change_outcome_t change_outcome(const change_t *change, fathom_status_t status);

/* Is its value read back, so that CHANGE_DONE is more than an acknowledgement? */
bool change_is_read_back(const change_t *change);

/* Of one that is not done: a line on stderr with what is known, and what to try. */
void change_explain(const change_t *change, change_outcome_t outcome, fathom_status_t status);

#endif
