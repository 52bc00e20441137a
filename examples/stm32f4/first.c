/* SPDX-License-Identifier: MIT */
/* An HPS-167S at an RS-485 transceiver for 3.3 V: DI at PA2, RO at PA3, DE with /RE at PA1. Text leaves at PA9. */
#include <stdio.h>

#include "fathom/fathom.h"
#include "fathom_stm32f4.h"

static fathom_stm32f4_bus_t bus;
static fathom_hps167s_t gate;

void usart2_interrupt(void) { fathom_stm32f4_usart_interrupt(&bus.port); }
void tim5_interrupt(void) { fathom_stm32f4_tim5_interrupt(); }

int main(void)
{
    const fathom_stm32f4_usart_config_t wiring = {
        .number = 2, .bus_hz = 16000000, .tx = {'A', 2}, .rx = {'A', 3}, .driver = {'A', 1}};
    fathom_stm32f4_clock_init(16000000); /* the clock after reset */
    if (!fathom_stm32f4_bus_init(&bus, &wiring, &fathom_hps167s_factory_line)) return 1;
    if (fathom_hps167s_init(&gate, &bus.modbus, NULL) != FATHOM_OK) return 1;
    for (;;) {
        fathom_sample_t sample;
        const fathom_status_t status = fathom_stm32f4_bus_read(&bus, fathom_hps167s_sensor(&gate), &sample);
        if (status != FATHOM_OK)
            printf("no reading (%s). %s\n", fathom_status_name(status), fathom_status_advice(status));
        else if (sample.kind == FATHOM_TARGET)
            printf("%u mm\n", sample.distance_mm);
        else
            printf("%s\n", sample.kind == FATHOM_NO_TARGET ? "nothing in range" : "no distance");
    }
}
