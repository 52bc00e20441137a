/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_TOOL_RUN_H
#define FATHOM_TESTS_TOOL_RUN_H

#include "suite.h"
#include <stdint.h>

#include "fathom/hal.h"
#include "ports/host.h"

/*
 * Runs commands of the tool in this process, against a device behind a UART in memory, in the device's time.
 *
 *     const tool_line_t line = {.uart = ..., .clock = ..., .idle = fathom_sim_clock_idle, .ctx = &sim_clock};
 *     const tool_run_t *const run = tool_run(&line, "read a16 --count %u --port line", 3);
 *     assert_int_equal(run->status, 0);
 *     assert_string_equal(run->out, "...");
 *
 * Nothing is kept from one run to the next but what the device keeps.
 */

/* One of several ports. */
typedef struct {
    const char *path;
    fathom_uart_t uart;
    bool is_away; /* there is no such port; one that is open is lost. It may change while the time passes */
} tool_port_t;

/* A GPIO chip; what its lines are is the test's. */
typedef struct {
    const char *path;
    fathom_pin_t trigger;
    fathom_capture_t capture;
    fathom_pin_t in;
    uint8_t missed; /* as pins_t has them: the tool takes them */
    uint32_t lost_events;
    bool is_away; /* there is no such chip; one that is open is lost. It may change while the time passes */
    const char *refusal; /* it can be opened, but no line of it: with this text */
    /* What was asked for last, and how often lines were opened and closed. */
    pin_options_t asked;
    unsigned opened;
    unsigned closed;
} tool_chip_t;

typedef struct {
    /* Behind every PATH but tcp:, unless there are ports; set_line is called when the port is opened. */
    fathom_uart_t uart;
    const tool_port_t *ports; /* whose time is the same */
    size_t port_count;        /* 0: `uart` is the only one */
    tool_chip_t *chip;        /* NULL: there is none */
    fathom_clock_t clock;     /* the device's time; it may begin anywhere and wrap */
    /* Lets the time pass until something may be read or something else can happen, but no longer than max_us
     * (FATHOM_NO_DEADLINE: any time), and at least a microsecond. It may not end the test, as assert does. */
    void (*idle)(void *ctx, uint32_t max_us);
    void *ctx;
    uint64_t ctrl_c_us; /* so long after its begin the user ends the command; 0: never */
} tool_line_t;

typedef struct {
    int status;       /* the exit status: 0 to 3 */
    const char *out;  /* the standard output */
    const char *err;  /* the standard error */
    uint64_t took_us; /* of the device's time */
} tool_run_t;

/* What comes after "fathom" on a command line, as printf has it; blanks divide the words. What is returned is there
 * until the next run. A command that is not over after two hours of the device's time fails the test. */
const tool_run_t *tool_run(const tool_line_t *line, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* The host of a new run, whose time begins at 0, for a test that calls an inner part of the tool. */
host_t tool_host(const tool_line_t *line);

#endif
