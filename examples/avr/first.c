/* SPDX-License-Identifier: MIT */
#include <avr/interrupt.h>
#include <stdio.h>

#include "fathom/fathom.h"
#include "fathom_avr.h"

static fathom_avr_bus_t bus;
static fathom_a16_auto_t tank;

int main(void)
{
    fathom_avr_clock_init();
    if (!fathom_avr_bus_init_listening(&bus, &fathom_a16_factory_line)) return 1;
    if (fathom_a16_auto_init(&tank, &bus.line, NULL) != FATHOM_OK) return 1;
    sei();
    for (;;) {
        fathom_sample_t sample;
        char text[16];
        int length;
        const fathom_status_t status = fathom_avr_bus_read(fathom_a16_auto_sensor(&tank), &sample);
        if (status != FATHOM_OK)
            length = snprintf(text, sizeof text, "error %d\r\n", status); /* status.h has the numbers */
        else if (sample.kind == FATHOM_TARGET)
            length = snprintf(text, sizeof text, "%u mm\r\n", sample.distance_mm);
        else
            length = snprintf(text, sizeof text, "no distance\r\n");
        (void)fathom_avr_usart0.write(NULL, (const uint8_t *)text, (size_t)length);
    }
}
