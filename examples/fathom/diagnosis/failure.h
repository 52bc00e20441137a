/* SPDX-License-Identifier: MIT */
#ifndef FAILURE_H
#define FAILURE_H

#include "diagnosis/counters.h"
#include "sensors/models.h"

/* A failed attempt, and the evidence from which its cause is judged. */
typedef struct {
    fathom_status_t status;
    const model_t *model;
    const model_mode_t *mode;
    const reader_t *reader; /* NULL: a request without a driver */
    const port_t *port;
    const counters_t *counters;         /* of the attempt and of the whole run */
    const fathom_line_settings_t *line; /* with which the sensor was asked; NULL: with several */
    const char *shared;                 /* name of the sensor among others; NULL: it is the only one */
    evidence_t evidence;                /* what was received in this attempt */
    uint32_t noises;                    /* pulses of this attempt that were too short */
    uint8_t address;
    bool others_answer; /* other sensors on this line respond */
    bool waits;         /* the command waits for a lost port */
    bool is_told;       /* a failure of the same port was already reported for another sensor */
    bool is_setting;    /* a setting was read or written, and no distance */
    bool is_request;    /* of `fathom request`, whose user enters the address as UNIT */
    bool is_scan;       /* of `fathom scan`: no sensor responded */
    bool is_whole;      /* with FATHOM_ERR_MALFORMED: the other probes were refused too */
} failure_t;

#endif
