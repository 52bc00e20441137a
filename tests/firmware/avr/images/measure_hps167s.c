/* SPDX-License-Identifier: MIT */
/*
 * An HPS-167S, asked by its driver as fast as it measures, 54 times a second; 8E1, DE is PD3. It sleeps in between. For
 * the share of its time that the chip is awake. GPIOR0, when it starts: bit 0 for 115200 baud, else 9600; bit 1 for a
 * sleep that lets bytes gather for 1 ms. Each reading is a record without bytes, of kind 1, and each error one of kind
 * 2.
 */
#include <avr/interrupt.h>
#include <avr/io.h>

#include "fathom/engine/modbus_client.h"
#include "fathom/engine/wait.h"
#include "fathom/sensor/hps167s.h"
#include "fathom_avr.h"

static uint8_t sending[8];
static fathom_avr_usart_config_t usart = {.request = sending,
                                          .request_size = sizeof sending,
                                          .driver = {&PORTD, _BV(PD3)},
                                          .line = {9600, FATHOM_PARITY_EVEN, 1}};
static uint8_t frame[13];
static fathom_line_parts_t line_parts = {.uart = &fathom_avr_usart0,
                                         .clock = &fathom_avr_clock,
                                         .frame = frame,
                                         .frame_size = sizeof frame,
                                         .echo = FATHOM_LINE_ECHO_OFF};
static fathom_line_t line;
static fathom_modbus_t modbus;
static fathom_hps167s_t gate;

static uint16_t gather_us; /* fathom_avr_idle: bytes wake it at once, or after so long */

int main(void)
{
    const uint8_t option = GPIOR0;
    if ((option & 1) != 0) usart.line.baud = 115200;
    if ((option & 2) != 0) gather_us = 1000;
    line_parts.silence_us = FATHOM_T3_5_US(usart.line.baud, 11);
    fathom_avr_clock_init();
    if (!fathom_avr_usart0_init(&usart)) return 1;
    if (fathom_line_init(&line, &line_parts) != FATHOM_OK) return 1;
    modbus = fathom_modbus_client(&line);
    if (fathom_hps167s_init(&gate, &modbus, NULL) != FATHOM_OK) return 1;
    sei();
    const fathom_sensor_t sensor = fathom_hps167s_sensor(&gate);
    for (;;) {
        fathom_sample_t sample;
        const fathom_status_t status = fathom_wait(&sensor, &sample, fathom_avr_idle, &gather_us);
        GPIOR1 = status == FATHOM_OK ? 1 : 2;
    }
}
