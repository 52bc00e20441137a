/* SPDX-License-Identifier: MIT */
#ifndef SET_REPORT_H
#define SET_REPORT_H

#include "device/change.h"

/* Says what has become of it; status: of the last call, FATHOM_OK if all went well. Returns the exit status. */
int set_report(const change_t *change, fathom_status_t status);

#endif
