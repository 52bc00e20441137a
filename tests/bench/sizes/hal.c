/* SPDX-License-Identifier: MIT */
#include "programs.h"

fathom_line_t line;
fathom_modbus_t modbus;
uint8_t frame[32];

static const fathom_line_config_t line_config = {.uart = &uart,
                                                 .clock = &clock,
                                                 .frame = frame,
                                                 .frame_size = sizeof frame,
                                                 .silence_us = FATHOM_T3_5_US(19200, 11)};

void line_begin(void) { fathom_line_init(&line, &line_config); }

void modbus_begin(void)
{
    line_begin();
    modbus = fathom_modbus_client(&line);
}

/* GCC copies structs by it, on RISC-V those of 28 bytes and more, and wants it from whoever has no libc. volatile: or
 * it would make a call of memcpy of this too. */
void *memcpy(void *restrict to, const void *restrict from, size_t length);
void *memcpy(void *restrict to, const void *restrict from, size_t length)
{
    volatile uint8_t *at = to;
    for (const uint8_t *byte = from; length != 0; length--) *at++ = *byte++;
    return to;
}

static void stub_set(void *ctx, bool high) { level = high; }

static bool stub_get(void *ctx) { return level != 0; }

static void stub_arm(void *ctx) { level = 0; }

static int stub_take(void *ctx, fathom_pulse_t *pulse)
{
    pulse->is_high = level != 0;
    if (pulse->is_high) return 0;
    pulse->width_us = argument;
    pulse->end_us = argument;
    return 1;
}

const fathom_pin_t pin = {stub_set, stub_get, NULL};
const fathom_capture_t capture = {stub_arm, stub_take, NULL};
