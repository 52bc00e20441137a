/* SPDX-License-Identifier: MIT */
#ifndef CALIBRATE_REPORT_H
#define CALIBRATE_REPORT_H

#include "commands/calibrate/calibrate_measure.h"
#include "commands/calibrate/calibrate_plan.h"

/* Prints a measurement, or announces a write. With JSON, a measurement is not printed and a write is announced on
 * stderr. Returns false if the output failed. */
bool calibrate_report_measurement(const session_t *session, const calibrate_plan_t *plan,
                                  const calibrate_batch_t *batch, const calibrate_measurement_t *measurement);
bool calibrate_report_write(const session_t *session, const calibrate_plan_t *plan);

/* Prints the result and returns the exit status. is_dry: the calibration ended before its first write. */
int calibrate_report(const session_t *session, const calibrate_plan_t *plan, bool is_dry);

#endif
