/* SPDX-License-Identifier: MIT */
#ifndef SET_REPORT_H
#define SET_REPORT_H

#include "stations/session.h"

/* What `fathom set` was asked to change. */
typedef struct {
    session_t *session;
    const setting_t *setting;
    int32_t value;
    char wanted[SETTING_TEXT];
    char was[SETTING_TEXT]; /* "": it was not read */
    bool is_blind;
    bool is_for_all;
} change_t;

/* Says what has become of it; status: of the last call, FATHOM_READY if all went well. Returns the exit status. */
int set_report(const change_t *change, fathom_status_t status);

#endif
