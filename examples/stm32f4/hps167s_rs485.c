/* SPDX-License-Identifier: MIT */
/*
 * An HPS-167S behind an RS-485 transceiver for 3.3 V, as the MAX3485, 19200 8E1: USART2, TX (DI) on PA2, RX (RO) on
 * PA3, DE and /RE on PA1, with 10 kOhm to ground that keep it quiet until this runs. The loop ends after 10 readings so
 * that it can be tested; a machine's does not.
 */
#include "board.h"
#include "fathom/fathom.h"
#include "fathom_stm32f4.h"
#include "start.h"

static fathom_stm32f4_usart_t usart;
static uint8_t request[8];
static uint8_t frame[32];

void usart2_interrupt(void) { fathom_stm32f4_usart_interrupt(&usart); }
void tim5_interrupt(void) { fathom_stm32f4_tim5_interrupt(); }

int main(void)
{
    const board_clocks_t *const clocks = board_begin();
    fathom_stm32f4_clock_init(clocks->timer_hz);
    const fathom_stm32f4_usart_config_t port = {
        .request = request,
        .request_size = sizeof request,
        .number = 2,
        .bus_hz = clocks->pclk1_hz,
        .line = {19200, FATHOM_PARITY_EVEN, 1},
        .tx = {'A', 2},
        .rx = {'A', 3},
        .driver = {'A', 1},
    };
    if (!fathom_stm32f4_usart_init(&usart, &port)) return 2;
    const fathom_uart_t uart = fathom_stm32f4_usart(&usart);
    const fathom_line_parts_t parts = {
        .uart = &uart,
        .clock = &fathom_stm32f4_clock,
        .frame = frame,
        .frame_size = sizeof frame,
        .echo = FATHOM_LINE_ECHO_OFF,
        .marks = fathom_line_marks,
        .senders = &fathom_line_senders, /* with factory settings the sensor sends measurements unasked */
        .silence_us = FATHOM_T3_5_US(19200, 11),
    };
    fathom_line_t line;
    if (fathom_line_init(&line, &parts) != FATHOM_OK) return 2;
    const fathom_modbus_t modbus = fathom_modbus_client(&line);
    fathom_hps167s_t gate;
    if (fathom_hps167s_init(&gate, &modbus, NULL) != FATHOM_OK) return 2;

    const fathom_sensor_t sensor = fathom_hps167s_sensor(&gate);
    fathom_stm32f4_idle_t idle = {&usart, 1};
    for (int readings = 0; readings != 10;) {
        fathom_sample_t sample;
        const fathom_status_t status = fathom_wait(&sensor, &sample, fathom_stm32f4_idle, &idle);
        if (status == FATHOM_OK) {
            readings++;
            board_use(&sample);
        } else {
            board_fail(status);
        }
    }
    return 0;
}
