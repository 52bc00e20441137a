/* SPDX-License-Identifier: MIT */
/* The text of printf(): UART0 at 115200 8N1, TX at GPIO 0. The UART is set up by the first character. */
#include "../start/newlib.h"
#include "board.h"
#include "fathom_rp2040.h"
#include "vectors.h"

static fathom_rp2040_uart_t port;

void uart0_irq(void) { fathom_rp2040_uart_interrupt(&port); }

static bool begin(void)
{
    static uint8_t request[1];
    static const fathom_rp2040_uart_config_t config = {
        .wiring = {.clk_peri_hz = BOARD_CLK_PERI_HZ, .number = 0, .tx = 0, .rx = 1},
        .line = {.baud = 115200, .parity = FATHOM_PARITY_NONE, .stop_bits = 1},
        .request = request,
        .request_size = sizeof request,
    };
    return fathom_rp2040_uart_init(&port, &config);
}

/* NOLINTNEXTLINE(bugprone-reserved-identifier,readability-identifier-naming): newlib's name */
int _write(int file, const char *text, int length)
{
    static bool is_ready;
    if (!is_ready) is_ready = begin();
    if (!is_ready) return -1;
    const fathom_uart_t uart = fathom_rp2040_uart(&port);
    for (int i = 0; i != length; i++)
        while (uart.write(uart.ctx, (const uint8_t *)&text[i], 1) == 0) {
        }
    return (void)file, length;
}
