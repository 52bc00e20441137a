/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TEST_ARDUINO_SOFT_H
#define FATHOM_TEST_ARDUINO_SOFT_H

#include <stddef.h>

#include "board.h"

/*
 * The other end of the SoftwareSerial of the sketches, bit by bit, 8N1: a sensor that sends to pin 10 (PB2) at 9600 baud,
 * and a console that receives from pin 11 (PB3) at 115200 baud.
 */
enum { SOFT_BIT_CYCLES = BOARD_HZ / 9600, CONSOLE_BIT_CYCLES = BOARD_HZ / 115200, SOFT_CHARACTER_BITS = 10 };

static struct {
    uint8_t bytes[16];
    size_t length;
    unsigned bit; /* of all of them */
} soft_sent;

static avr_cycle_count_t soft_next_bit(avr_t *avr, avr_cycle_count_t when, void *param)
{
    if (soft_sent.bit == soft_sent.length * SOFT_CHARACTER_BITS) return 0;
    const unsigned at = soft_sent.bit % SOFT_CHARACTER_BITS;
    const uint8_t byte = soft_sent.bytes[soft_sent.bit++ / SOFT_CHARACTER_BITS];
    board_drive('B', 2, at == 9 || (at != 0 && (byte >> (at - 1) & 1) != 0));
    return when + SOFT_BIT_CYCLES;
}

/* Sends bytes without a gap, `in_us` from now. */
static inline void soft_send(const uint8_t *bytes, size_t length, uint32_t in_us)
{
    assert_true(length <= sizeof soft_sent.bytes);
    memcpy(soft_sent.bytes, bytes, length);
    soft_sent.length = length;
    soft_sent.bit = 0;
    avr_cycle_timer_register(board.avr, in_us * BOARD_CYCLES_PER_US + SOFT_BIT_CYCLES, soft_next_bit, NULL);
}

static struct {
    char line[80]; /* of those that are complete, the first */
    char next[80];
    size_t length; /* of `next` */
    bool has_line, level, in_byte;
    uint64_t start_cycle;
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
            console.start_cycle + CONSOLE_BIT_CYCLES * console.at + CONSOLE_BIT_CYCLES / 2;
        if (middle >= board.avr->cycle) return;
        console.bits |= (unsigned)console.level << console.at;
        if (++console.at != SOFT_CHARACTER_BITS) continue;
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

/* From now on the console receives. */
static inline void console_join(void)
{
    memset(&console, 0, sizeof console);
    console.level = true;
    board_watch('B', 3, true, console_changed, NULL);
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
