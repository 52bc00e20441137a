/* SPDX-License-Identifier: MIT */

/* Listens to an A16 or an A05 that sends by itself, and sleeps in between. */
#include <avr/interrupt.h>
#include <stddef.h>
#include <util/delay.h>

#include "fathom/a05_auto.h"
#include "fathom/a16_auto.h"
#include "fathom_avr.h"
#include "report.h"

static uint8_t request[8];
static uint8_t frame[16];
static fathom_line_t line;
static fathom_a16_auto_t a16;
static fathom_a05_auto_t a05;

static const fathom_avr_usart_config_t usart = {
    .request = request,
    .request_size = sizeof request,
    .line = {.baud = 9600, .parity = FATHOM_PARITY_NONE, .stop_bits = 1},
};
static const fathom_line_config_t line_config = {
    .uart = &fathom_avr_usart0,
    .clock = &fathom_avr_clock,
    .frame = frame,
    .frame_size = sizeof frame,
};
static const fathom_a16_auto_config_t a16_config = {.line = &line};
static const fathom_a05_auto_config_t a05_config = {.line = &line};

int main(void)
{
    fathom_avr_clock_begin();
    const uint8_t orders = await_orders();
    if (!fathom_avr_usart0_begin(&usart)) GPIOR2 = 1;
    sei();
    if (fathom_line_init(&line, &line_config) != FATHOM_READY) GPIOR2 = 2;
    fathom_sensor_t sensor;
    if ((orders & ORDER_A16) != 0) {
        if (fathom_a16_auto_init(&a16, &a16_config) != FATHOM_READY) GPIOR2 = 3;
        sensor = fathom_a16_auto_sensor(&a16);
    } else {
        if (fathom_a05_auto_init(&a05, &a05_config) != FATHOM_READY) GPIOR2 = 4;
        sensor = fathom_a05_auto_sensor(&a05);
    }
    for (;;) {
        fathom_sample_t sample;
        const fathom_status_t status = fathom_poll(&sensor, &sample);
        if (status == FATHOM_READY) {
            report_sample(&sample);
            continue;
        }
        if (status < 0) report_error(status);
        if ((orders & ORDER_20_MS) != 0)
            _delay_ms(20);
        else
            fathom_avr_idle(NULL, fathom_due_us(&sensor, 1));
    }
}
