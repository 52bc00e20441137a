/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TEST_ARDUINO_PRINTED_H
#define FATHOM_TEST_ARDUINO_PRINTED_H

#include "board.h"

/* What a sketch prints on Serial, a line at a time. */
typedef struct {
    board_t *board;
    uint32_t taken; /* of board->bytes */
    uint32_t length;
    char line[80];
} printed_t;

void printed_begin(printed_t *printed, board_t *board);

/* The next line without its end, running until there is one; NULL: none came within most_us. Valid until the next
 * call. */
const char *printed_line(printed_t *printed, uint64_t most_us);

#endif
