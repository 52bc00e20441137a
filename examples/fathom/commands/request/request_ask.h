/* SPDX-License-Identifier: MIT */
#ifndef REQUEST_ASK_H
#define REQUEST_ASK_H

#include "commands/request/request_options.h"
#include "ports/channel.h"

typedef enum {
    REQUEST_ANSWERED,
    REQUEST_SENT, /* to all units, which do not answer */
    REQUEST_ECHO, /* one copy came of a request that its acknowledgement equals: that, or the adapter's echo */
    REQUEST_REFUSED,    /* an exception */
    REQUEST_UNEXPECTED, /* the unit has answered something else */
    REQUEST_DAMAGED,
    REQUEST_NO_RESPONSE,
    REQUEST_LINE_BUSY,    /* the line was never silent */
    REQUEST_OTHER_MASTER, /* another master asked the same unit meanwhile */
    REQUEST_FAILED,       /* the port did, or the user has ended it */
} request_outcome_t;

/* The request on a line, and what came of it. */
typedef struct {
    fathom_transaction_t transaction; /* first: the line hands back this one */
    const request_t *request;
    request_outcome_t outcome;
    uint32_t more;         /* bytes that came besides the response, within 60 ms */
    evidence_t evidence;   /* what was heard since it left */
    uint8_t response[255]; /* with its CRC */
    uint8_t length;        /* 0: there is none */
} request_ask_t;

/* Sends it on an open channel, once, and waits for what comes of it. */
void request_ask(request_ask_t *ask, const request_t *request, channel_t *channel);

#endif
