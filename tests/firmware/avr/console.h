/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TEST_AVR_CONSOLE_H
#define FATHOM_TEST_AVR_CONSOLE_H

#include <stddef.h>

#include "board.h"

/* A console that receives lines of text, bit by bit, 8N1, from a pin at which the image makes a UART by software. */
enum { CONSOLE_CHARACTER_BITS = 10 };

static struct {
    char line[80]; /* of those that are complete, the first */
    char next[80];
    size_t length; /* of `next` */
    bool has_line, level, in_byte;
    uint64_t start_cycle, bit_cycles;
    unsigned at, bits; /* of the present byte */
} console;

static void console_take(char byte)
{
    if (byte == '\r') return;
    assert_true(console.length < sizeof console.next - 1);
    console.next[console.length++] = byte == '\n' ? '\0' : byte;
    if (byte != '\n') return;
    assert_false(console.has_line); /* the test reads each one */
    memcpy(console.line, console.next, console.length);
    console.has_line = true;
    console.length = 0;
}

/* The pin has had its level until now: each bit whose middle is over has it. */
static void console_sample(void)
{
    while (console.in_byte) {
        const uint64_t middle =
            console.start_cycle + console.bit_cycles * console.at + console.bit_cycles / 2;
        if (middle >= board.avr->cycle) return;
        console.bits |= (unsigned)console.level << console.at;
        if (++console.at != CONSOLE_CHARACTER_BITS) continue;
        assert_true(console.level); /* the stop bit */
        console.in_byte = false;
        console_take((char)(console.bits >> 1 & 0xFF));
    }
}

static void console_changed(void *ctx, bool high)
{
    console_sample();
    console.level = high;
    if (high || console.in_byte) return;
    console.in_byte = true;
    console.start_cycle = board.avr->cycle;
    console.at = console.bits = 0;
}

/* From now on the console receives from a pin. */
static inline void console_join(char port, uint8_t bit, uint32_t baud)
{
    memset(&console, 0, sizeof console);
    console.level = true;
    console.bit_cycles = BOARD_HZ / baud;
    assert_non_null(board_watch(port, bit, true, console_changed, NULL));
}

static bool console_has_line(void *ctx)
{
    console_sample();
    return console.has_line;
}

/* The next line without its end, running until there is one; "": none came within most_us. */
static inline const char *console_line(uint64_t most_us)
{
    if (!board_run(console_has_line, NULL, most_us)) return "";
    console.has_line = false;
    return console.line;
}

#endif
