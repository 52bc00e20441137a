/* SPDX-License-Identifier: MIT */
#ifndef LIBMODBUS_RIG_H
#define LIBMODBUS_RIG_H

#include "suite.h"

#include "fake.h"
#include "fathom_libmodbus.h"

/*
 * A port over a modbus_t whose connection is one end of a socket pair; the test is the far end. Both ends would
 * wait if they were asked to, which the port may not do: then the alarm ends the program. Time stands still until the
 * test moves it.
 */
typedef struct {
    fake_t fake; /* its clock */
    int far;
    modbus_t *modbus;
    fathom_libmodbus_t port;
    fathom_modbus_t transport;
    fathom_modbus_request_t request; /* of rig_ask_three */
    uint16_t values[125];
} rig_t;

extern rig_t rig;

/*
 * Modbus TCP (MODBUS Messaging on TCP/IP V1.0b, 3.1.3): transaction, protocol 0, how many bytes follow, unit, PDU.
 * The PDUs are A05 3(4)1 example 3: 250, 659 and 2426 mm.
 */
#define REQUEST(transaction)            0xF0, (transaction), 0, 0, 0, 6, 1, 0x03, 0x01, 0x07, 0x00, 0x03
#define RESPONSE(transaction)           0xF0, (transaction), 0, 0, 0, 9, 1, 0x03, 6, 0x00, 0xFA, 0x02, 0x93, 0x09, 0x7A
#define OTHER(transaction)              0xF0, (transaction), 0, 0, 0, 9, 1, 0x03, 6, 0, 1, 0, 2, 0, 3 /* other values */
#define REFUSAL(transaction, exception) 0xF0, (transaction), 0, 0, 0, 3, 1, 0x83, (exception)

enum { RIG_TIMEOUT_US = 100000, RIG_ALARM_S = 60, FINE_US = 100, SLOW_US = 20000 };

/* cmocka's fixtures. */
int rig_tcp_set_up(void **state);
int rig_rtu_set_up(void **state);
int rig_tear_down(void **state);

/* A new socket pair, as a program connects again. The old one, if it is there, is closed. */
void rig_connect(void);

/* The datasheet's request (A05 3(4)1, example 3): three registers from 0x0107 of unit 1. */
void rig_ask_three(fathom_modbus_request_t *request, uint8_t unit, uint8_t retries);

/* Were its values delivered (250, 659, 2426), or is `values` untouched? */
void rig_expect_three(void);
void rig_expect_none(void);

/* The same, as a new test has it, but for the first of many. */
void rig_again(bool is_first);

/* Once over TCP: that request has left with its transaction; its response comes, and then its values were delivered. */
void rig_expect_request(uint8_t transaction);
void rig_say_response(uint8_t transaction);
void rig_answered(uint8_t transaction);

/* rig_ask_three of unit 1 over TCP, whose first request has left. */
void rig_ask(uint8_t retries);

/* The far end hangs up; and the port's own end is full, until all of that was read again: returns how much it was. */
void rig_hang_up(void);
size_t rig_fill(void);
void rig_drain(size_t filled);

/* Is the port broken for that reason, and the request ended by it? */
void rig_expect_broken(fathom_libmodbus_error_t error);

/* Requests with line settings of their own are unsupported, and so is each unit from the first to the last. */
void rig_expect_no_settings(uint32_t in_us);
void rig_expect_units_refused(unsigned first, unsigned last);

/* One poll, FINE_US later. */
fathom_status_t rig_poll(void);

/* Of rig.request. */
static inline int status(void) { return rig.request.transaction.status; }

/* Moves the clock on by step_us and polls, until that makes in_us. */
void rig_run(uint32_t in_us, uint32_t step_us);
static inline void rig_run_fine(uint32_t in_us) { rig_run(in_us, FINE_US); }

/* To the port; and what the port has sent, which has to be that and nothing else. */
void rig_say(const void *bytes, size_t length);
void rig_expect_sent(const void *bytes, size_t length);

#endif
