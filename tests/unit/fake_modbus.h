/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_FAKE_MODBUS_H
#define FATHOM_TESTS_FAKE_MODBUS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "fathom/engine/internal/modbus_command.h"

/*
 * A transport of Modbus, its line and a clock that do what the test says, without a wire. Time stands still until the
 * test moves it, and what was submitted waits until the test sends and ends it. The fake fails the test when a driver
 * breaks the rules of a line: a second submit, or a request that changed while it was queued.
 *
 * For this line, and for no other one, the functions of fake_modbus.c replace those of line.h that a driver calls
 * (fake_modbus.cmake). No other function of line.h may get it.
 */
enum { FAKE_MODBUS_LOG = 64 };

typedef struct {
    fathom_line_t
        line; /* the first member, so that one pointer is both; without `parts` it is not initialised */
    fathom_line_parts_t parts;
    fathom_modbus_t modbus;
    fathom_clock_t clock;
    uint32_t now_us;
    uint32_t due_us;
    uint32_t heard_us;         /* when the response to a request came */
    fathom_status_t transport; /* what poll returns */
    fathom_status_t refuses;   /* < 0: what submit returns, and nothing happens */

    fathom_modbus_request_t *request; /* under way */
    fathom_modbus_request_t snapshot; /* of it, as it was submitted */
    bool is_sent;                     /* the next poll puts it on the wire */
    fathom_status_t ends;             /* with which the next poll ends it; FATHOM_PENDING: it does not */
    uint8_t exception;
    uint16_t response[16];
    uint8_t response_count;

    uint8_t log[FAKE_MODBUS_LOG][6]; /* heads of all that was submitted: unit, function, first, count */
    unsigned submits;
    unsigned cancels;
    unsigned unit_cancels;
    uint8_t cancelled_unit; /* the last one */
    unsigned polls;
} fake_modbus_t;

void fake_modbus_init(fake_modbus_t *fake);

/* The next poll puts the request on the wire; each time it is a further attempt. */
void fake_modbus_send(fake_modbus_t *fake);

/* The next poll ends the request: with a response of `count` registers, which must be as many as were asked, with
 * an exception, or with another error. A request that was not sent goes out in the same poll. */
void fake_modbus_response(fake_modbus_t *fake, const uint16_t *values, uint8_t count);
void fake_modbus_acknowledge(fake_modbus_t *fake); /* a write */
void fake_modbus_refuse(fake_modbus_t *fake, uint8_t exception);
void fake_modbus_fail(fake_modbus_t *fake, fathom_status_t status);

/* The line is initialised again: it has forgotten the request, which never ends. */
void fake_modbus_forget(fake_modbus_t *fake);

/* The last request was a read of `count` registers from `first` of `unit`, asked `submits`-th. */
void fake_modbus_assert_asked(const fake_modbus_t *fake, unsigned submits, uint8_t unit, uint16_t first,
                              uint16_t count);

/* What a driver does with its unit: its init, and after fathom_modbus_unit_poll() its measurement or command. A request
 * whose id is below FATHOM_MODBUS_COMMAND is the measurement. */
fathom_status_t init_unit(fathom_modbus_unit_t *unit, const fathom_modbus_t *transport,
                          const fathom_modbus_config_t *config, uint32_t timeout_us, uint32_t pace_us);
fathom_status_t ask_unit(fathom_modbus_unit_t *unit, const fathom_modbus_unit_request_t *request);

#endif
