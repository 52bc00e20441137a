/* SPDX-License-Identifier: MIT */
#ifndef ADVICE_H
#define ADVICE_H

#include <stdio.h>

#include "diagnosis/counters.h"
#include "sensors/models.h"

/* A failed attempt. */
typedef struct {
    fathom_status_t status;
    const model_t *model;
    const model_mode_t *mode;
    const reader_t *reader;
    const channel_t *channel;
    const counters_t *counters;
    const fathom_line_settings_t *line; /* at which it was asked */
    const char *shared;                 /* its name among others that are read; NULL: it is alone */
    evidence_t evidence;                /* of this attempt */
    uint32_t noises;                    /* pulses of this attempt that were too short */
    uint8_t address;
    bool others_answer; /* on this line */
    bool waits;         /* for a lost port, which is opened again */
    bool is_told;       /* of another sensor on this port, which is lost to all of them */
    bool is_request;    /* of `fathom request`, which takes the address as UNIT */
    bool is_whole;      /* with FATHOM_ERR_MALFORMED: the other probes were refused too */
} failure_t;

/* What happened and what to try, without a line feed: the cause as far as the evidence tells it. */
void advice_print(FILE *to, const failure_t *failure);

#endif
