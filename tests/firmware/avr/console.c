/* SPDX-License-Identifier: MIT */
#include "console.h"

/* Takes what has been sent; true at the end of a line. */
static bool has_line(void *ctx)
{
    console_t *const console = ctx;
    const board_t *const board = console->board;
    while (console->seen != board->bytes_seen) {
        const board_byte_t *const byte = &board->bytes[console->seen++ % BOARD_BYTES];
        if (!byte->from_here || byte->byte == '\r') continue;
        if (byte->byte == '\n') {
            console->end_cycle = byte->end_cycle;
            return true;
        }
        if (console->length < CONSOLE_LINE - 1) console->text[console->length++] = (char)byte->byte;
    }
    return false;
}

void console_begin(console_t *console, board_t *board)
{
    const console_t fresh = {.board = board, .seen = board->bytes_seen};
    *console = fresh;
}

const char *console_line(console_t *console, uint64_t most_us)
{
    console->length = 0;
    if (!board_run(console->board, has_line, console, most_us)) return "";
    console->text[console->length] = '\0';
    return console->text;
}
