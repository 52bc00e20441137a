/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_WIRE_DESK_H
#define FATHOM_TESTS_WIRE_DESK_H

#include "suite.h"

#include "fathom/fathom.h"
#include "wire.h"

/* A program: one line on the wire. */
typedef struct {
    fathom_line_parts_t config;
    fathom_line_t line;
    fathom_modbus_t modbus;
    uint8_t frame[64];
    uint16_t counters[FATHOM_LINE_COUNTERS];
    /* For the bound: the longest turn, if turns change; requests beside those of the drivers. */
    wire_us_t longest_turn_us;
    unsigned request_count, request_retries;
    wire_us_t turn_us, jitter_us; /* of the main loop: each turn is random by plus or minus `jitter_us` */
} desk_t;

extern desk_t desk;

/* Which optional parts the line's config names. */
typedef enum { DESK_PLAIN = 0, DESK_SENDERS = 1, DESK_MASTERS = 2, DESK_ALL = 3 } desk_parts_t;

/* The silence is 3.5 characters at the rate of the wire. The line has seen the port empty. */
void desk_open(desk_parts_t parts, wire_us_t turn_us, wire_us_t jitter_us);
/* The same with desk.config as it is now. */
void desk_init_line(void);

/* Before its first transaction a line knows no protocol, and so no request of another master. */
void desk_learn_protocol(void);

/* One turn of the main loop passes. The caller polls after it. */
void desk_turn(void);
/* Turns with fathom_line_poll() for a time. */
void desk_run(wire_us_t for_us);

wire_us_t desk_longest_turn_us(void);

/*
 * The bound of line.h for a transaction behind `others` others like it: (others + 1) x ((retries + 1) x (busy_us
 * + 2 x FATHOM_LINE_SEND_US + timeout_us + FATHOM_LINE_FINISH_US) + retries x timeout_us). Each of the five waits
 * of an attempt, and the quarantine, ends with a poll, which may come one turn later.
 */
wire_us_t desk_bound_us(wire_us_t timeout_us, unsigned retries, unsigned others);

unsigned desk_count(unsigned which);

/* A read or a write of unit 1 without a driver. */
typedef struct {
    fathom_modbus_request_t request;
    uint16_t values[8];
    wire_us_t begin_us;
} desk_request_t;

void desk_read(desk_request_t *request, uint16_t reg, uint8_t count, uint32_t timeout_us, uint8_t retries);
void desk_write(desk_request_t *request, uint16_t reg, uint16_t value, uint32_t timeout_us);
fathom_status_t desk_status(const desk_request_t *request);
/* Turns until the request has an outcome, at most for a time. Returns the outcome, or FATHOM_PENDING. */
fathom_status_t desk_wait(const desk_request_t *request, wire_us_t at_most_us);

/* In a share of the tests, `share` of them; all if suite_is_long. */
#define DESK_SHARE(all, share) (suite_is_long ? (all) : (share))

#endif
