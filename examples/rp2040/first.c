/* SPDX-License-Identifier: MIT */
/* An A05 at an RS-485 transceiver for 3.3 V: DI at GPIO 4, RO at 5, DE with /RE at 6. Text leaves at GPIO 0. */
#include <stdio.h>

#include "fathom/fathom.h"
#include "fathom_rp2040.h"

static fathom_rp2040_bus_t bus;
static fathom_a05_dyp_t bumper;

void uart1_irq(void) { fathom_rp2040_uart_interrupt(&bus.port); }
void timer_irq_0(void) { fathom_rp2040_uart_alarm(&bus.port); }
void timer_irq_1(void) { fathom_rp2040_idle_alarm(&bus.idle); }

int main(void)
{
    static const fathom_rp2040_wiring_t wiring = {
        .clk_peri_hz = 125000000, .number = 1, .tx = 4, .rx = 5, .has_driver = true, .driver = 6};
    fathom_rp2040_clock_init(12000000);
    if (!fathom_rp2040_bus_init(&bus, &wiring, &fathom_a05_factory_line)) return 1;
    if (fathom_a05_dyp_init(&bumper, &bus.line, NULL) != FATHOM_OK) return 1;
    for (;;) {
        fathom_sample_t sample;
        const fathom_status_t status = fathom_rp2040_bus_read(&bus, fathom_a05_dyp_sensor(&bumper), &sample);
        if (status != FATHOM_OK)
            printf("no reading (%s). %s\n", fathom_status_name(status), fathom_status_advice(status));
        else if (sample.kind == FATHOM_TARGET)
            printf("probe %u: %u mm\n", sample.probe, sample.distance_mm);
        else
            printf("probe %u: %s\n", sample.probe,
                   sample.kind == FATHOM_NO_TARGET ? "nothing in range" : "no distance");
    }
}
