/* SPDX-License-Identifier: MIT */
#ifndef CALIBRATE_REPORT_H
#define CALIBRATE_REPORT_H

#include "commands/calibrate/calibrate_measure.h"
#include "commands/calibrate/calibrate_plan.h"

/* What `fathom calibrate` says on the way: of a measurement, and of what is about to be written. In JSON the former is
 * left out and the latter goes to stderr. False: it could not be said. */
bool calibrate_report_measurement(const session_t *session, const calibrate_plan_t *plan,
                                  const calibrate_batch_t *asked, const calibrate_measurement_t *measurement);
bool calibrate_report_write(const session_t *session, const calibrate_plan_t *plan);

/* What has come of it; is_dry: it ended before the first write. Returns the exit status. */
int calibrate_report(const session_t *session, const calibrate_plan_t *plan, bool is_dry);

#endif
