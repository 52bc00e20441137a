/* SPDX-License-Identifier: MIT */
/* examples/avr/first.c with the parts of the bus set up by hand, for the figure that compares both. */
#include <avr/interrupt.h>
#include <stdio.h>

#include "fathom/fathom.h"
#include "fathom_avr.h"

static uint8_t request[16], frame[32];
static const fathom_line_parts_t parts = {.uart = &fathom_avr_usart0,
                                          .clock = &fathom_avr_clock,
                                          .frame = frame,
                                          .frame_size = sizeof frame,
                                          .silence_us = FATHOM_T3_5_US(9600, 10),
                                          .marks = fathom_line_marks};
static fathom_line_t line;
static fathom_a16_auto_t tank;

int main(void)
{
    const fathom_avr_usart_config_t usart = {
        .request = request, .request_size = sizeof request, .line = fathom_a16_factory_line};
    fathom_avr_clock_init();
    sei();
    if (!fathom_avr_usart0_init(&usart)) return 1;
    if (fathom_line_init_listening(&line, &parts) != FATHOM_OK) return 1;
    if (fathom_a16_auto_init(&tank, &line, NULL) != FATHOM_OK) return 1;
    const fathom_sensor_t sensor = fathom_a16_auto_sensor(&tank);
    for (;;) {
        fathom_sample_t sample;
        char text[16];
        int length;
        const fathom_status_t status = fathom_wait(&sensor, &sample, fathom_avr_idle, NULL);
        if (status != FATHOM_OK)
            length = snprintf(text, sizeof text, "error %d\r\n", status);
        else if (sample.kind == FATHOM_TARGET)
            length = snprintf(text, sizeof text, "%u mm\r\n", sample.distance_mm);
        else
            length = snprintf(text, sizeof text, "no distance\r\n");
        (void)fathom_avr_usart0.write(NULL, (const uint8_t *)text, (size_t)length);
    }
}
