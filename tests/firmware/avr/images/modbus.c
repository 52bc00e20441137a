/* SPDX-License-Identifier: MIT */

/* Asks one or two HPS-167S over RS-485, driver-enable on PD3. */
#include <avr/interrupt.h>
#include <stddef.h>
#include <util/delay.h>

#include "fathom/hps167s.h"
#include "fathom/modbus_client.h"
#include "fathom_avr.h"
#include "report.h"

static uint8_t request[8];
static uint8_t frame[16];
static fathom_line_t line;
static fathom_modbus_t modbus;
static fathom_hps167s_t hps[2];
static fathom_sensor_t sensors[2];

static fathom_avr_usart_config_t usart = {
    .request = request,
    .request_size = sizeof request,
    .driver = {.port = &PORTD, .mask = _BV(PORTD3)},
    .line = {.baud = 19200, .parity = FATHOM_PARITY_EVEN, .stop_bits = 1},
};
static fathom_line_config_t line_config = {
    .uart = &fathom_avr_usart0,
    .clock = &fathom_avr_clock,
    .frame = frame,
    .frame_size = sizeof frame,
    .silence_us = FATHOM_T3_5_US(19200, 11),
};

static void obey(uint8_t order)
{
    GPIOR0 = 0;
    GPIOR1 = REPORT_ASKED;
    if (order == ORDER_AWAY) _delay_ms(60);
    if (order != ORDER_COUNTERS) return;
    report_counters(line.counters, FATHOM_LINE_COUNTERS);
    const uint16_t port[] = {fathom_avr_usart0_counters.parity, fathom_avr_usart0_counters.framing,
                             fathom_avr_usart0_counters.overruns};
    report_counters(port, 3);
}

int main(void)
{
    fathom_avr_clock_begin();
    const uint8_t orders = await_orders();
    if ((orders & ORDER_115200) != 0) {
        usart.line.baud = 115200;
        line_config.silence_us = FATHOM_T3_5_US(115200, 11);
    }
    if (!fathom_avr_usart0_begin(&usart)) GPIOR2 = 1;
    sei();
    if (fathom_line_init(&line, &line_config) != FATHOM_READY) GPIOR2 = 2;
    modbus = fathom_modbus_client(&line);
    const uint8_t units = (orders & ORDER_TWO_UNITS) != 0 ? 2 : 1;
    for (uint8_t i = 0; i < units; i++) {
        const fathom_hps167s_config_t config = {
            .modbus = &modbus,
            .clock = &fathom_avr_clock,
            .address = (uint8_t)(1 + i),
            .timeout_us = 100000,
            .retries = (orders & ORDER_RETRY) != 0,
        };
        if (fathom_hps167s_init(&hps[i], &config) != FATHOM_READY) GPIOR2 = 3;
        sensors[i] = fathom_hps167s_sensor(&hps[i]);
    }
    for (;;) {
        for (uint8_t i = 0; i < units; i++) {
            fathom_sample_t sample;
            const fathom_status_t status = fathom_poll(&sensors[i], &sample);
            if (status == FATHOM_READY) report_sample(&sample);
            if (status < 0) report_error(status);
        }
        if (GPIOR0 != 0) obey(GPIOR0);
        if ((orders & ORDER_SLOW_LOOP) != 0)
            _delay_ms(20);
        else
            fathom_avr_idle(NULL, fathom_due_us(sensors, units));
    }
}
