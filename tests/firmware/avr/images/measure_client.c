/* SPDX-License-Identifier: MIT */
/*
 * A bare modbus_client that asks again at once, for the bus time of a poll: no driver and no pace of one. It sleeps
 * while there is nothing to do. GPIOR0, set before it starts, says what it asks: bits 0..1 the rate, 9600, 19200,
 * 57600 or 115200; bit 2 an A05 for its first probe, 8N1, else an HPS-167S for a measurement, 8E1. DE is PD3. Each
 * transaction is a record without bytes, of kind 1 when it was OK and 2 when it was not.
 */
#include <avr/interrupt.h>
#include <avr/io.h>

#include "fathom/engine/modbus_client.h"
#include "fathom_avr.h"

static uint8_t sending[8];
static fathom_avr_usart_config_t usart = {
    .request = sending, .request_size = sizeof sending, .driver = {&PORTD, _BV(PD3)}};

static uint8_t frame[13];
static fathom_line_parts_t config = {.uart = &fathom_avr_usart0,
                                     .clock = &fathom_avr_clock,
                                     .frame = frame,
                                     .frame_size = sizeof frame,
                                     .echo = FATHOM_LINE_ECHO_OFF};
static fathom_line_t line;
static fathom_modbus_request_t request = {.transaction = {.timeout_us = 500000}};
static uint16_t values[4];

static void set_up(uint8_t what)
{
    static const uint32_t rates[4] = {9600, 19200, 57600, 115200};
    const bool is_a05 = (what & 4) != 0;
    usart.line.baud = rates[what & 3];
    usart.line.parity = is_a05 ? FATHOM_PARITY_NONE : FATHOM_PARITY_EVEN;
    usart.line.stop_bits = 1;
    config.silence_us = FATHOM_T3_5_US(usart.line.baud, is_a05 ? 10 : 11);
    if (is_a05)
        fathom_modbus_read_holding_registers(&request.message, 1, 0x0106, 1, values);
    else
        fathom_modbus_read_holding_registers(&request.message, 1, 0x0008, 4, values);
}

int main(void)
{
    set_up(GPIOR0);
    fathom_avr_clock_init();
    if (!fathom_avr_usart0_init(&usart)) return 1;
    if (fathom_line_init(&line, &config) != FATHOM_OK) return 1;
    sei();
    for (;;) {
        fathom_modbus_client_submit(&line, &request);
        for (;;) {
            fathom_line_poll(&line);
            if (request.transaction.status != FATHOM_PENDING) break;
            fathom_avr_idle(NULL, fathom_line_due_us(&line));
        }
        GPIOR1 = request.transaction.status == FATHOM_OK ? 1 : 2;
    }
}
