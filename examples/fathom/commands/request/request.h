/* SPDX-License-Identifier: MIT */
#ifndef REQUEST_H
#define REQUEST_H

#include "cli/command.h"
#include "diagnosis/counters.h"
#include "ports/port.h"
#include "sensors/decoding.h"

/* Positions in a request. */
enum { REQUEST_UNIT = 0, REQUEST_FUNCTION = 1, REQUEST_FIRST = 2, REQUEST_COUNT = 4, REQUEST_VALUE = 4 };

enum { REQUEST_READ = 3, REQUEST_READ_INPUT = 4, REQUEST_WRITE = 6, REQUEST_WRITE_MANY = 16 };

/* A request and its options. */
typedef struct {
    const char *path;
    const model_t *model; /* NULL: not given */
    fathom_line_settings_t line;
    uint32_t timeout_us;
    uint8_t echo; /* fathom_line_parts_t.echo */
    bool rs485;   /* the kernel's driver switches the transceiver */
    bool is_json;
    bool is_confirmed;  /* --yes */
    uint8_t frame[255]; /* with its CRC */
    uint8_t length;
} request_t;

/* Reads UNIT FUNCTION and what belongs to the function, and adds the CRC. Returns false after rejecting a word. */
bool request_words(request_t *request, char **words, int count);

/* Returns the register or the number at a position of the request. */
uint16_t request_word(const request_t *request, size_t at);

/* Returns true for functions 1 to 4, which change nothing by the standard. */
bool request_is_read(const request_t *request);

/* Returns true if no unit responds. A read of unit 0 is no broadcast, since an A16 or A05 can have that address. */
bool request_is_broadcast(const request_t *request);

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
    uint32_t more;         /* further bytes that arrived within 60 ms of the response */
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

/* Writes the bytes and their meaning to standard output, as text or JSON. */
void request_print(const request_ask_t *ask, const port_t *port);

/* Prints on standard error what failed, or what else the user has to know. counters: of this attempt. */
void request_print_problem(const request_ask_t *ask, const port_t *port, const counters_t *counters);

/* Returns true if a unit responded, or if the request was sent to all units. */
bool request_is_good(const request_ask_t *ask);

#endif
