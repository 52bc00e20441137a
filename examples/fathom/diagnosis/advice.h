/* SPDX-License-Identifier: MIT */
#ifndef ADVICE_H
#define ADVICE_H

#include <stdio.h>

#include "diagnosis/counters.h"
#include "ports/holder.h"
#include "sensors/models.h"

/* A failed attempt, and the evidence from which its cause is judged. FATHOM_OK: frames between good ones are damaged. */
typedef struct {
    fathom_status_t status;
    const model_t *model;
    const model_mode_t *mode;
    const reader_t *reader; /* NULL: a request without a driver */
    const port_t *port;
    const counters_t *counters;         /* of the attempt and of the whole run */
    const fathom_line_settings_t *line; /* of the requests to the sensor; NULL: of several */
    const char *shared;                 /* name of the sensor among others; NULL: it is the only one */
    evidence_t evidence;                /* what was received in this attempt */
    holder_t holder;                    /* set here: who else uses the port */
    uint32_t noises;                    /* pulses of this attempt that were too short */
    uint8_t address;
    uint8_t damaged;    /* with FATHOM_OK: frames of a hundred */
    bool others_answer; /* other sensors on this line respond */
    bool waits;         /* the command waits for a lost port */
    bool is_told;       /* a failure of the same port was already reported for another sensor */
    bool is_setting;    /* a setting was read or written, and no distance */
    bool is_request;    /* of `fathom request`, whose user enters the address as UNIT */
    bool is_scan;       /* of `fathom scan`: no sensor responded */
    bool is_whole;      /* with FATHOM_ERR_MALFORMED: the other probes were refused too */
} failure_t;

/* Returns a failed Modbus request to a sensor of unknown model. The caller adds the evidence. */
failure_t failure_of_request(fathom_status_t status, const port_t *port);

/* Writes which other program uses a port that was just opened. Returns a number for this program, 0: there is none. */
uint32_t advice_at_opening(char *text, size_t size, const port_t *port);

/* The same, printed on the standard error as a message. */
void advice_print_opening(const port_t *port);

/* Prints what failed, why, and what to try, without a line feed. After good readings the settings are right, so the cause
 * is the wiring, the power or a disturbance. */
void advice_print(FILE *to, const failure_t *failure);

/* Prints why, and what to try. */
void advice_print_cause(FILE *to, const failure_t *failure);

/* As advice_print(), but while the cause of a sensor's failures stays the same, prints only what failed and how often. A
 * lost port is always printed in full. reported: of this sensor, at first all zeros. */
typedef struct {
    uint64_t cause; /* the newest one that was printed, with the facts that distinguish it */
    uint64_t times; /* failures by this cause in a row; 0: none was printed */
} reported_t;
void advice_print_new(FILE *to, const failure_t *failure, reported_t *reported);

#endif
