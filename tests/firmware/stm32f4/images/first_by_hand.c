/* SPDX-License-Identifier: MIT */
/* examples/stm32f4/first.c with the parts of the bus set up by hand, for the figure that compares both. */
#include <stdio.h>

#include "fathom/fathom.h"
#include "fathom_stm32f4.h"
#include "start.h"

static fathom_stm32f4_usart_t port;
static fathom_uart_t uart;
static uint8_t request[16], frame[32];
static const fathom_line_parts_t parts = {.uart = &uart,
                                          .clock = &fathom_stm32f4_clock,
                                          .frame = frame,
                                          .frame_size = sizeof frame,
                                          .silence_us = FATHOM_T3_5_US(19200, 11),
                                          .find_echo = fathom_line_find_echo,
                                          .senders = &fathom_line_senders,
                                          .marks = fathom_line_marks};
static fathom_line_t line;
static fathom_modbus_t modbus;
static fathom_hps167s_t gate;

void usart2_interrupt(void) { fathom_stm32f4_usart_interrupt(&port); }
void tim5_interrupt(void) { fathom_stm32f4_tim5_interrupt(); }

int main(void)
{
    static const fathom_stm32f4_usart_config_t config = {.request = request,
                                                         .request_size = sizeof request,
                                                         .number = 2,
                                                         .bus_hz = 16000000,
                                                         .line = {19200, FATHOM_PARITY_EVEN, 1},
                                                         .tx = {'A', 2},
                                                         .rx = {'A', 3},
                                                         .driver = {'A', 1}};
    fathom_stm32f4_clock_init(16000000);
    if (!fathom_stm32f4_usart_init(&port, &config)) return 1;
    uart = fathom_stm32f4_usart(&port);
    if (fathom_line_init(&line, &parts) != FATHOM_OK) return 1;
    modbus = fathom_modbus_client(&line);
    if (fathom_hps167s_init(&gate, &modbus, NULL) != FATHOM_OK) return 1;
    const fathom_sensor_t sensor = fathom_hps167s_sensor(&gate);
    fathom_stm32f4_idle_t idle = {&port, 1};
    for (;;) {
        fathom_sample_t sample;
        const fathom_status_t status = fathom_wait(&sensor, &sample, fathom_stm32f4_idle, &idle);
        if (status != FATHOM_OK)
            printf("no reading (%s). %s\n", fathom_status_name(status), fathom_status_advice(status));
        else if (sample.kind == FATHOM_TARGET)
            printf("%u mm\n", sample.distance_mm);
        else
            printf("%s\n", sample.kind == FATHOM_NO_TARGET ? "nothing in range" : "no distance");
    }
}
