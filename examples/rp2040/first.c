/* SPDX-License-Identifier: MIT */
#include <stdio.h>

#include "fathom/fathom.h"
#include "fathom_rp2040.h"

static fathom_rp2040_bus_t bus;
static fathom_hps167s_t gate;

void uart1_irq(void) { fathom_rp2040_uart_interrupt(&bus.port); }
void timer_irq_0(void) { fathom_rp2040_uart_alarm(&bus.port); }
void timer_irq_1(void) { fathom_rp2040_idle_alarm(&bus.idle); }

int main(void)
{
    static const fathom_rp2040_wiring_t wiring = {
        .clk_peri_hz = 125000000, .number = 1, .tx = 4, .rx = 5, .has_driver = true, .driver = 6};
    fathom_rp2040_clock_init(12000000);
    if (!fathom_rp2040_bus_init(&bus, &wiring, &fathom_hps167s_factory_line)) return 1;
    if (fathom_hps167s_init(&gate, &bus.modbus, NULL) != FATHOM_OK) return 1;
    for (;;) {
        fathom_sample_t sample;
        const fathom_status_t status = fathom_rp2040_bus_read(&bus, fathom_hps167s_sensor(&gate), &sample);
        if (status != FATHOM_OK)
            printf("no reading (%s). %s\n", fathom_status_name(status), fathom_status_advice(status));
        else if (sample.kind == FATHOM_TARGET)
            printf("%u mm\n", sample.distance_mm);
        else
            printf("%s\n", sample.kind == FATHOM_NO_TARGET ? "nothing in range" : "no distance");
    }
}
