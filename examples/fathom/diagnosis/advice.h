/* SPDX-License-Identifier: MIT */
#ifndef ADVICE_H
#define ADVICE_H

#include <stdio.h>

#include "diagnosis/failure.h"

/* Returns a failed Modbus request to a sensor of unknown model. The caller adds the evidence. */
failure_t failure_of_request(fathom_status_t status, const port_t *port);

/* A cause: what it is and what to try, as templates. */
typedef struct cause cause_t;

/* Returns the cause that fits the evidence best, never NULL. After good readings the settings are right, so the cause is
 * the wiring, the power or a disturbance. */
const cause_t *diagnose(const failure_t *failure);

/* Prints what failed, why, and what to try, without a line feed. */
void advice_print(FILE *to, const failure_t *failure);

/* Prints why, and what to try. */
void advice_print_cause(FILE *to, const failure_t *failure);

#endif
