/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_FAKE_H
#define FATHOM_TESTS_FAKE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "fathom/hal.h"

/*
 * A UART and a clock that do what the test says. Time stands still until the test moves it. Received bytes are
 * scheduled for a time and handed over by the first read at or after it, one scheduled chunk a read; what is
 * written is kept, and leaves at byte_us a byte.
 */
enum { FAKE_CHUNKS = 128, FAKE_WRITES = 64 };

/* The bytes of all of them together: few are long, and a microcontroller runs these tests too. */
enum { FAKE_CHUNK_BYTES = 1024, FAKE_WRITE_BYTES = 1024 };

typedef struct {
    uint32_t at_us; /* may be read from then on */
    const uint8_t *bytes;
    size_t length;
    size_t taken;
    fathom_rx_t rx; /* handed over with the chunk */
} fake_chunk_t;

typedef struct {
    const uint8_t *bytes;
    size_t length;
    uint32_t at_us;
    uint32_t baud; /* that was set then */
} fake_write_t;

typedef struct {
    uint32_t now_us;
    uint32_t step_us; /* each look at the clock moves it on by this */
    uint32_t byte_us; /* how long a written byte takes to leave; 0: sent at once */
    uint32_t busy_until_us;

    fake_chunk_t chunks[FAKE_CHUNKS];
    size_t first;
    size_t last;
    uint8_t chunk_bytes[FAKE_CHUNK_BYTES];
    fake_write_t writes[FAKE_WRITES];
    size_t written; /* a test may set it to 0 */
    uint8_t write_bytes[FAKE_WRITE_BYTES];
    unsigned reads;
    unsigned set_lines;
    uint32_t leaves_in_us;
    unsigned breaks; /* begun so far */
    bool in_break;
    fathom_line_settings_t settings;

    /* What goes wrong. */
    bool read_fails;
    bool write_fails;
    bool write_busy;
    bool write_too_short;
    bool never_sent;
    uint32_t unsupported_baud;
    int refusals;       /* of a break, one each; < 0: without end */
    bool refuses_begin; /* those of its begin, else of its end */
    int refusal;        /* what set_break says then: 0 or < 0 */

    fathom_uart_t uart;
    fathom_clock_t clock;
} fake_t;

void fake_init(fake_t *fake);

/* Says what fake->leaves_in_us is. For fake->uart.leaves_in_us, which is NULL otherwise. */
uint32_t fake_leaves_in_us(void *ctx);

/* The bytes may be read `in_us` from now. */
void fake_receive(fake_t *fake, uint32_t in_us, const uint8_t *bytes, size_t length);
void fake_receive_rx(fake_t *fake, uint32_t in_us, const uint8_t *bytes, size_t length, fathom_rx_t rx);

/* The same, byte by byte at byte_us each, the first complete in_us + byte_us from now. */
void fake_trickle(fake_t *fake, uint32_t in_us, uint32_t byte_us, const uint8_t *bytes, size_t length);

/* Nothing is waiting or scheduled any more. */
bool fake_drained(const fake_t *fake);

#endif
