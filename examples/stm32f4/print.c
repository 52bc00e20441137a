/* SPDX-License-Identifier: MIT */
/* The text of printf(): USART1 at 115200 8N1, TX on PA9. The USART is set up by the first character. */
#include "../start/newlib.h"
#include "fathom_stm32f4.h"
#include "start.h"

static fathom_stm32f4_usart_t port;

void usart1_interrupt(void) { fathom_stm32f4_usart_interrupt(&port); }

static bool begin(void)
{
    static uint8_t request[1];
    static const fathom_stm32f4_usart_config_t config = {
        .request = request,
        .request_size = sizeof request,
        .number = 1,
        .bus_hz = 16000000, /* after reset */
        .line = {115200, FATHOM_PARITY_NONE, 1},
        .tx = {'A', 9},
        .rx = {'A', 10},
    };
    return fathom_stm32f4_usart_init(&port, &config);
}

/* NOLINTNEXTLINE(bugprone-reserved-identifier,readability-identifier-naming): newlib's name */
int _write(int file, const char *text, int length)
{
    static bool is_ready;
    if (!is_ready) is_ready = begin();
    if (!is_ready) return -1;
    const fathom_uart_t uart = fathom_stm32f4_usart(&port);
    for (int i = 0; i != length; i++)
        while (uart.write(uart.ctx, (const uint8_t *)&text[i], 1) == 0) {
        }
    return (void)file, length;
}
