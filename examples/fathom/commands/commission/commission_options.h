/* SPDX-License-Identifier: MIT */
#ifndef COMMISSION_OPTIONS_H
#define COMMISSION_OPTIONS_H

#include "cli/session_options.h"

/* The options before the sensor is known. */
typedef struct {
    session_settings_t session;
    const char *addresses;
    const char *record;
    const char *terminated; /* NULL: not given */
    uint64_t wait_us;
} commission_settings_t;

extern const option_table_t commission_tables[];

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

#endif
