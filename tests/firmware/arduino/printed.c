/* SPDX-License-Identifier: MIT */
#include "printed.h"

#include <stdio.h>
#include <stdlib.h>

void printed_begin(printed_t *printed, board_t *board)
{
    printed->board = board;
    printed->taken = board->bytes_seen;
    printed->length = 0;
}

/* Takes what has left; true: a line is whole. */
static bool has_line(void *ctx)
{
    printed_t *const printed = (printed_t *)ctx;
    const board_t *const board = printed->board;
    while (printed->taken != board->bytes_seen) {
        const board_byte_t *const sent = &board->bytes[printed->taken++ % BOARD_BYTES];
        if (!sent->from_here || sent->byte == '\r') continue;
        if (sent->byte == '\n') {
            printed->line[printed->length] = '\0';
            printed->length = 0;
            return true;
        }
        if (printed->length == sizeof printed->line - 1) {
            fprintf(stderr, "a line is too long\n");
            exit(EXIT_FAILURE);
        }
        printed->line[printed->length++] = (char)sent->byte;
    }
    return false;
}

const char *printed_line(printed_t *printed, uint64_t most_us)
{
    return board_run(printed->board, has_line, printed, most_us) ? printed->line : NULL;
}
