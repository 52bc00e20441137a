/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TEST_AVR_CONSOLE_H
#define FATHOM_TEST_AVR_CONSOLE_H

#include "board.h"

/* Lines of text that the image sends by its UART. */
enum { CONSOLE_LINE = 80 };

typedef struct {
    board_t *board;
    uint32_t seen; /* of board->bytes */
    size_t length;
    char text[CONSOLE_LINE];
    uint64_t end_cycle; /* of the line's last stop bit */
} console_t;

void console_begin(console_t *console, board_t *board);

/* The next line, without its end; it runs until there is one. "" when none came within most_us. Valid until the next
 * call. */
const char *console_line(console_t *console, uint64_t most_us);

#endif
