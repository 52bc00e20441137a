/* SPDX-License-Identifier: MIT */
#ifndef COMMISSION_OPTIONS_H
#define COMMISSION_OPTIONS_H

#include "cli/command.h"
#include "device/session.h"

/* What `fathom commission` was asked to do. */
enum { COMMISSION_ADDRESSES = 254 };

typedef struct {
    uint8_t addresses[COMMISSION_ADDRESSES]; /* to give, in this order */
    uint32_t count;
    uint8_t terminated; /* at which the termination resistor stays on; 0: at none */
    uint64_t wait_us;   /* so long without a unit ends it; 0: never */
    const char *record;
} commission_options_t;

/* Checks the options and reads the sensor. False after rejecting what is wrong. */
bool commission_options(commission_options_t *options, session_t *session, const arguments_t *arguments);

/* command_t.start */
int commission_start(const host_t *host, const arguments_t *arguments);

#endif
