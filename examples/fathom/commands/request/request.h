/* SPDX-License-Identifier: MIT */
#ifndef REQUEST_H
#define REQUEST_H

#include "commands/request/request_options.h"
#include "ports/port.h"

typedef enum {
    REQUEST_ANSWERED,
    REQUEST_SENT, /* to all units, which do not respond */
    REQUEST_ECHO, /* One copy of the request arrived, which is its acknowledgement or the echo of the adapter. */
    REQUEST_REFUSED,    /* by an exception */
    REQUEST_UNEXPECTED, /* the unit responded with something else */
    REQUEST_DAMAGED,
    REQUEST_NO_RESPONSE,
    REQUEST_LINE_BUSY,    /* the line was never silent */
    REQUEST_OTHER_MASTER, /* another master asked the same unit at the same time */
    REQUEST_FAILED,       /* the port failed, or the user ended the command */
    REQUEST_OUTCOMES
} request_outcome_t;

extern const struct request_outcome_row {
    const char *name; /* in JSON */
    fathom_status_t status;
} request_outcomes[REQUEST_OUTCOMES];

/* The request on a line, and its outcome. */
typedef struct {
    fathom_transaction_t transaction; /* first, so that a pointer to it is one to the request_ask_t */
    const request_t *request;
    request_outcome_t outcome;
    uint32_t more;         /* bytes that arrived besides the response, within 60 ms */
    evidence_t evidence;   /* heard since the request */
    uint8_t response[255]; /* with its CRC */
    uint8_t length;        /* 0: there is no response */
} request_ask_t;

/* Sends the request once on an open port and waits for its outcome. */
void request_ask(request_ask_t *ask, const request_t *request, port_t *port);

/* Prints on stderr what the request may do, a line for each effect. Returns true if it needs --yes. */
bool request_effects(const request_t *request);

/* Returns true if the request changes nothing, so that it may be sent while others send. */
bool request_may_collide(const request_t *request);

/* Decodes the request, or its response (NULL: the request), for the model that the user named or else for each that can
 * have this address. The frame points to `piece`. */
void request_decode(decode_frame_t *frame, decode_piece_t *piece, const request_t *request,
                    const uint8_t *response, uint8_t length);

#endif
