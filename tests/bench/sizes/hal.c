/* SPDX-License-Identifier: MIT */
#include "programs.h"

fathom_line_t line;
fathom_modbus_t modbus;
uint8_t frame[32];

static const fathom_line_parts_t line_parts = {.uart = &uart,
                                               .clock = &clock,
                                               .frame = frame,
                                               .frame_size = sizeof frame,
                                               .echo = FATHOM_LINE_ECHO_OFF,
                                               .silence_us = FATHOM_T3_5_US(19200, 11)};

void line_begin(void) { fathom_line_init(&line, &line_parts); }

void listening_begin(void) { fathom_line_init_listening(&line, &line_parts); }

void modbus_begin(void)
{
    line_begin();
    modbus = fathom_modbus_client(&line);
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
