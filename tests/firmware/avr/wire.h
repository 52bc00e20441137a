/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TEST_AVR_WIRE_H
#define FATHOM_TEST_AVR_WIRE_H

#include "board.h"

/* The requests of 8 bytes in the log of the wire, which has everything; {0} before the first. */
typedef struct {
    uint32_t requests;     /* so far */
    uint64_t before_cycle; /* the end of whatever came before it; 0: nothing */
    uint64_t begin_cycle, end_cycle;
    uint64_t on_cycle;  /* when the driver was switched on for it, */
    uint64_t off_cycle; /* and off; 0: not yet */
    uint32_t at;        /* of board.bytes */
} wire_t;

/* The next one; false: there is none, or it is still leaving. Fails the test unless its bytes are back to back and the
 * driver is on around it. */
bool wire_next_request(wire_t *wire);

#endif
