/* SPDX-License-Identifier: MIT */
#include "bus.h"

/* The UART of tests/bench/mcu.c. */
extern const fathom_uart_t uart;
extern const fathom_clock_t clock;

bus_t bus;
volatile uint16_t distance_mm;

static uint8_t frame[32];
static const fathom_line_parts_t parts = {.uart = &uart,
                                          .clock = &clock,
                                          .frame = frame,
                                          .frame_size = sizeof frame,
                                          .echo = FATHOM_LINE_ECHO_OFF,
                                          .silence_us = FATHOM_T3_5_US(19200, 11)};

void bus_begin(void)
{
#ifdef LISTENS
    fathom_line_init_listening(&bus.line, &parts);
#else
    fathom_line_init(&bus.line, &parts);
    bus.modbus = fathom_modbus_client(&bus.line);
#endif
}
