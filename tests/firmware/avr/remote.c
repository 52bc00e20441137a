/* SPDX-License-Identifier: MIT */
#include "remote.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* More than any call takes, fathom_avr_idle for one period of Timer1 included. */
static const uint64_t most_us = 100000;

static volatile remote_t *remote_of(board_t *board)
{
    return (volatile remote_t *)(void *)board_data(board, "remote");
}

static bool is_done(void *ctx)
{
    const volatile remote_t *const remote = (const volatile remote_t *)ctx;
    return remote->call == 0;
}

volatile remote_t *remote_call(board_t *board, uint8_t call)
{
    volatile remote_t *const remote = remote_of(board);
    remote->call = call;
    return remote;
}

static int run(board_t *board, uint8_t call)
{
    volatile remote_t *const remote = remote_call(board, call);
    if (!board_run(board, is_done, (void *)(uintptr_t)remote, most_us)) {
        fprintf(stderr, "call %u does not return\n", call);
        exit(EXIT_FAILURE);
    }
    return remote->result;
}

void remote_start(board_t *board)
{
    if (!board_start(board, "remote")) exit(EXIT_FAILURE);
    const board_record_t *const record = board_next_record(board, most_us);
    if (record == NULL || record->kind != REMOTE_READY) {
        fprintf(stderr, "the image does not begin\n");
        exit(EXIT_FAILURE);
    }
}

static void set_line(volatile remote_t *remote, const fathom_line_settings_t *line)
{
    remote->baud = line->baud;
    remote->parity = line->parity;
    remote->stop_bits = line->stop_bits;
}

bool remote_begin(board_t *board, const fathom_line_settings_t *line, bool driver, uint8_t request_size)
{
    volatile remote_t *const remote = remote_of(board);
    set_line(remote, line);
    remote->flags = driver;
    remote->length = request_size;
    return run(board, REMOTE_BEGIN) != 0;
}

int remote_read(board_t *board, uint8_t *bytes, uint8_t capacity, uint8_t *flags)
{
    volatile remote_t *const remote = remote_of(board);
    remote->length = capacity;
    const int count = run(board, REMOTE_READ);
    for (int i = 0; i < count; i++) bytes[i] = remote->bytes[i];
    *flags = remote->flags;
    return count;
}

int remote_write(board_t *board, const uint8_t *bytes, uint8_t length)
{
    volatile remote_t *const remote = remote_of(board);
    for (uint8_t i = 0; i < length; i++) remote->bytes[i] = bytes[i];
    remote->length = length;
    return run(board, REMOTE_WRITE);
}

bool remote_sent(board_t *board) { return run(board, REMOTE_SENT) != 0; }

int remote_set_line(board_t *board, const fathom_line_settings_t *line)
{
    set_line(remote_of(board), line);
    return run(board, REMOTE_SET_LINE);
}

int remote_set_break(board_t *board, bool on)
{
    remote_of(board)->flags = on;
    return run(board, REMOTE_SET_BREAK);
}

uint32_t remote_now_us(board_t *board)
{
    run(board, REMOTE_NOW);
    return remote_of(board)->time_us;
}

void remote_idle(board_t *board, uint32_t max_us)
{
    remote_of(board)->time_us = max_us;
    run(board, REMOTE_IDLE);
}

void remote_watch_clock(board_t *board, bool on, uint8_t masked)
{
    remote_of(board)->length = masked;
    remote_of(board)->call = on ? REMOTE_CLOCK : 0;
}
