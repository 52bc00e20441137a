/* SPDX-License-Identifier: MIT */
#ifndef STEPS_H
#define STEPS_H

#include <stdbool.h>
#include <stdint.h>

/*
 * What libmodbus_client and fathom_client are told to do, an argument a step:
 *
 *   read:FIRST:COUNT       function 03          input:FIRST:COUNT    function 04
 *   coils:FIRST:COUNT      function 01          raw:BYTE,BYTE,...    any request, from the function code on
 *   write:ADDRESS:VALUE    function 06          unit:UNIT            whom the steps after it ask
 *   many:FIRST:VALUE,...   function 16
 *
 * Numbers as in C. For each step but unit they print a line: the values read (or the response's bytes) in hex,
 * "done", "exception N", "no response", "damaged", "unfit", or other words for what else went wrong.
 */
typedef enum {
    STEP_READ = 1,
    STEP_INPUT,
    STEP_COILS,
    STEP_WRITE,
    STEP_MANY,
    STEP_RAW,
    STEP_UNIT
} step_kind_t;

enum { STEP_VALUES = 128 };

typedef struct {
    step_kind_t kind;
    uint16_t first; /* address, or the unit */
    uint16_t count; /* to read, or in values */
    uint16_t values[STEP_VALUES];
} step_t;

/* False, with words on stderr: that is no step. */
bool step_parse(step_t *step, const char *text);

/* A line of values, `digits` (2 or 4) each. */
void step_print(const uint16_t *values, uint16_t count, int digits);

#endif
