/* SPDX-License-Identifier: MIT */
#ifndef PRESENCE_H
#define PRESENCE_H

#include "device/session.h"

/* What answers at an address. */
typedef enum {
    PRESENT_NONE,
    PRESENT_ONE,     /* unit, as far as three reads can tell */
    PRESENT_UNCLEAR, /* something does, and it is damaged, refused, or two that differ */
    PRESENT_UNKNOWN, /* the line was busy, or another master asked there: nothing is known about the address */
    PRESENT_STOPPED  /* the user has ended it, or the port is lost */
} present_t;

typedef struct {
    present_t what;
    fathom_status_t status; /* of the last read */
    bool is_two;            /* PRESENT_UNCLEAR: two responses to one request, or two numbers */
    char number[SETTING_TEXT];
} presence_t;

/*
 * Asks at this address, where the session is from then on. times: so many requests in a row have to find nothing
 * before it is PRESENT_NONE; a response may be lost once. PRESENT_ONE: its number (UUID) was read three times without
 * damage and was the same, and to none of the requests a second response came; of a model without numbers the same
 * by its address, and the number is "-".
 */
presence_t presence_ask(session_t *session, uint8_t address, unsigned times);

/* Of what is PRESENT_UNCLEAR or PRESENT_UNKNOWN: on stderr, without a line feed. */
void presence_explain(session_t *session, const presence_t *presence);

#endif
