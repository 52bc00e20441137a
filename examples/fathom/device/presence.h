/* SPDX-License-Identifier: MIT */
#ifndef PRESENCE_H
#define PRESENCE_H

#include "device/session.h"

/* What responds at an address. */
typedef enum {
    PRESENT_NONE,
    PRESENT_ONE,     /* one sensor, as far as three reads show */
    PRESENT_UNCLEAR, /* a damaged or refused response, or two sensors */
    PRESENT_UNKNOWN, /* the line was busy or another master asked there: nothing is known about the address */
    PRESENT_STOPPED  /* the user has ended the command, or the port is lost */
} present_t;

typedef struct {
    present_t what;
    fathom_status_t status;    /* of the last read */
    bool is_two;               /* with PRESENT_UNCLEAR: two responses to one request, or two numbers */
    char number[SETTING_TEXT]; /* with PRESENT_ONE: the UUID; "-" if the model has none */
} presence_t;

/*
 * Moves the session to an address and these line settings, and reads there. PRESENT_NONE needs `times` requests in a row
 * without a response, since one response may be lost. PRESENT_ONE needs three reads of the same UUID (of the address, if
 * the model has no UUID) without damage and without a second response.
 */
presence_t presence_ask(session_t *session, uint8_t address, const fathom_line_settings_t *line,
                        unsigned times);

/* Prints the cause of PRESENT_UNCLEAR or PRESENT_UNKNOWN on stderr, without a line feed. */
void presence_explain(session_t *session, const presence_t *presence);

/* Returns true if no sensor responds at the new address, neither at today's line settings, which the sensor passes, nor
 * at the new rate. Then moves the session back. Returns false after printing the reason. */
bool presence_is_free(session_t *session, uint8_t address, uint32_t baud);

/* Moves the session to where the driver has followed the sensor. Returns false after printing the reason. */
bool presence_follow(session_t *session);

#endif
