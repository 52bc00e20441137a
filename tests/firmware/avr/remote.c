/* SPDX-License-Identifier: MIT */
#include "remote.h"

/* More than any call takes, fathom_avr_idle for one period of Timer1 included. */
static const uint64_t most_us = 100000;

static volatile remote_t *remote_of(void) { return (volatile remote_t *)(void *)board_data("remote"); }

static bool is_done(void *ctx)
{
    const volatile remote_t *const remote = (const volatile remote_t *)ctx;
    return remote->call == 0;
}

volatile remote_t *remote_call(uint8_t call)
{
    volatile remote_t *const remote = remote_of();
    remote->call = call;
    return remote;
}

static int run(uint8_t call)
{
    volatile remote_t *const remote = remote_call(call);
    if (!board_run(is_done, (void *)(uintptr_t)remote, most_us))
        board_give_up("call %u does not return", call);
    return remote->result;
}

void remote_start(void)
{
    board_start("remote");
    const board_record_t *const record = board_next_record(most_us);
    if (record == NULL || record->kind != REMOTE_READY) board_give_up("the image does not begin");
}

static void set_line(volatile remote_t *remote, const fathom_line_settings_t *line)
{
    remote->baud = line->baud;
    remote->parity = line->parity;
    remote->stop_bits = line->stop_bits;
}

bool remote_begin(const fathom_line_settings_t *line, bool driver, uint8_t request_size)
{
    volatile remote_t *const remote = remote_of();
    set_line(remote, line);
    remote->flags = driver;
    remote->length = request_size;
    return run(REMOTE_BEGIN) != 0;
}

int remote_read(uint8_t *bytes, uint8_t capacity, uint8_t *flags)
{
    volatile remote_t *const remote = remote_of();
    remote->length = capacity;
    const int count = run(REMOTE_READ);
    for (int i = 0; i < count; i++) bytes[i] = remote->bytes[i];
    *flags = remote->flags;
    return count;
}

int remote_write(const uint8_t *bytes, uint8_t length)
{
    volatile remote_t *const remote = remote_of();
    for (uint8_t i = 0; i < length; i++) remote->bytes[i] = bytes[i];
    remote->length = length;
    return run(REMOTE_WRITE);
}

bool remote_sent(void) { return run(REMOTE_SENT) != 0; }

uint32_t remote_leaves_in_us(void)
{
    run(REMOTE_LEAVES);
    return remote_of()->time_us;
}

int remote_set_line(const fathom_line_settings_t *line)
{
    set_line(remote_of(), line);
    return run(REMOTE_SET_LINE);
}

int remote_set_break(bool on)
{
    remote_of()->flags = on;
    return run(REMOTE_SET_BREAK);
}

void remote_idle(uint32_t max_us)
{
    remote_of()->time_us = max_us;
    run(REMOTE_IDLE);
}

void remote_watch_clock(bool on, uint8_t masked)
{
    remote_of()->length = masked;
    remote_of()->call = on ? REMOTE_CLOCK : 0;
}
