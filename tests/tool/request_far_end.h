/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_REQUEST_FAR_END_H
#define FATHOM_TESTS_REQUEST_FAR_END_H

#include "tool_run.h"

/* For fathom request: a far end that says what the test says. */

/* 9600 8N1: a character of 10 bits takes 1041.7 us. */
enum { CHARACTER_US = 1042, MOST = 256 };

typedef struct {
    uint32_t now_us;
    uint32_t leaves_us; /* the end of the last request */
    uint32_t delay_us;  /* from there to the first character of the response, at its beginning */
    bool echoes;
    uint8_t sent[MOST]; /* by the tool, all of it */
    size_t sent_length;
    unsigned writes;
    uint8_t answer[MOST];
    size_t length;
    uint8_t coming[2 * MOST]; /* echo and response */
    uint32_t at_us[2 * MOST]; /* when each is there */
    size_t count;
    size_t taken;
    bool babbles; /* a byte every 2 ms, less than the silence of 3.5 characters */
    uint32_t babbled;
    tool_line_t tool;
} far_end_t;

extern far_end_t far_end;

/* From now on it answers with these bytes in hex, 20 ms after the request. */
void far_answers(const char *bytes);

/* So much has left, and no more. */
void far_expect_sent(const char *bytes);

/* fathom request LINE: it ends so, says this on stdout and this on stderr, and one request has left at most. */
void far_run(int status, const char *out, const char *err, const char *line);

#endif
