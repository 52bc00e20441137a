/* SPDX-License-Identifier: MIT */
/*
 * proves: src/engine/line_listening.c
 * with:   src/engine/line.c src/engine/line_attempt.c src/engine/line_options.c src/engine/line_request.c
 *          src/engine/line_response.c src/engine/line_due.c src/engine/line_echo.c
 * unreached: advance_0
 * options: -eva-precision 0
 *          -eva-slevel-function fathom_line_begin:100,main:5,fathom_line_poll:3,fathom_line_marks:30
 *          -eva-split-return-function fathom_line_begin:0,fathom_line_init_listening:0
 * quick:   yes
 *
 * A line that only listens: any calls in any order, any bytes, receive flags and times. What sends is refused.
 */
#include "assumptions.h"
#include "fathom/engine/line.h"

enum { FRAME_SIZE = 13 };

static uint8_t frame[FRAME_SIZE];
static fathom_line_t line;
static fathom_line_parts_t config;
static uint16_t counters[FATHOM_LINE_COUNTERS];

static void receive(fathom_listener_t *listener, const uint8_t *bytes, uint8_t of_them, bool after_gap,
                    uint32_t time_us)
{
    (void)listener->gap_us;
    /*@ assert after_gap == 0 || after_gap == 1; */
    /*@ assert there: bytes == &frame[0] && of_them <= FRAME_SIZE; */
    (void)time_us;
}

static fathom_listener_t listener = {receive, 0, 0};

static void submit(void)
{
    static fathom_transaction_t transaction;
    transaction.timeout_us = any_32();
    const fathom_status_t status = fathom_line_submit(&line, &transaction);
    /*@ assert status == FATHOM_ERR_UNSUPPORTED || status == FATHOM_ERR_ARGUMENT; */
    fathom_line_cancel(&line, &transaction);
    fathom_line_cancel_unit(&line, any_8());
    const bool is_queued = fathom_line_is_queued(&line, &transaction);
    /*@ assert is_queued == 0; */
}

static void any_call(void)
{
    switch (any_8_in(0, 6)) {
    case 0:
        (void)fathom_line_poll(&line);
        break;
    case 1:
        (void)fathom_line_replace_listener(&line, any_bool() ? &listener : NULL);
        break;
    case 2:
        (void)fathom_line_break(&line, any_bool());
        break;
    case 3:
        (void)fathom_line_due_us(&line);
        break;
    case 4:
        submit();
        break;
    case 5:
        fathom_line_flush(&line);
        break;
    default:
        (void)fathom_line_is_idle(&line);
        (void)fathom_line_last_byte_us(&line);
    }
}

void main(void)
{
    config.uart = any_bool() ? &assumed_uart : &assumed_bare_uart;
    config.clock = &assumed_clock;
    config.frame = frame;
    config.frame_size = FRAME_SIZE;
    config.echo = any_8_in(0, 2);
    config.silence_us = any_16();
    config.gap_us = any_16();
    config.marks = any_bool() ? fathom_line_marks : NULL;
    config.count = any_bool() ? fathom_line_count : NULL;
    config.counters = counters;
    config.busy_us = any_32();
    listener.gap_us = any_16();
    listener.stale_us = any_32();
    if (fathom_line_init_listening(&line, &config) != FATHOM_OK) return;
    while (any_bool()) any_call();
}
