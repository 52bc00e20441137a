/* SPDX-License-Identifier: MIT */
#include "interrupts_serial.h"

#include "../../interrupts/rp2040/calls.h"
#include "fathom_serial.h"

extern fathom_serial_t serial;
fathom_serial_t serial;
static uint8_t request[CALLS_SERIAL_REQUEST];
static fathom_line_settings_t settings;

void serial_begin(rp2040_uart_t *hardware, const fathom_line_settings_t *line)
{
    settings = *line;
    fathom_serial_init(&serial, request, sizeof request);
    rp2040_clear(&hardware->cr, RP2040_UART_CR_UARTEN);
    rp2040_clear(&hardware->lcr_h, RP2040_UART_LCR_H_FEN);
    rp2040_set(&hardware->cr, RP2040_UART_CR_UARTEN);
    hardware->imsc = RP2040_UART_INT_RX;
}

void serial_interrupt(rp2040_uart_t *hardware)
{
    const uint32_t pending = hardware->mis;
    uint8_t byte;
    if ((pending & RP2040_UART_INT_RX) != 0u) {
        const uint32_t entry = hardware->dr;
        unsigned flags = 0;
        if ((entry & RP2040_UART_DR_PE) != 0u) flags |= FATHOM_RX_PARITY;
        if ((entry & RP2040_UART_DR_FE) != 0u) flags |= FATHOM_RX_FRAMING;
        if ((entry & RP2040_UART_DR_OE) != 0u) flags |= FATHOM_RX_OVERRUN;
        fathom_serial_put(&serial, (uint8_t)entry, (uint8_t)flags);
    }
    if ((pending & RP2040_UART_INT_TX) == 0u) return;
    if (fathom_serial_next(&serial, &byte)) {
        hardware->dr = byte;
    } else {
        hardware->icr = RP2040_UART_INT_TX;
        rp2040_clear(&hardware->imsc, RP2040_UART_INT_TX);
        serial.leaving = false;
    }
}

int serial_read(uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    if (!fathom_serial_waits(&serial)) return 0;
    return fathom_serial_read(&serial, bytes, capacity, rx);
}

int serial_write(rp2040_uart_t *hardware, const uint8_t *bytes, size_t length)
{
    uint8_t byte;
    const int taken = fathom_serial_load(&serial, bytes, length);
    if ((taken > 0) && fathom_serial_next(&serial, &byte)) {
        hardware->dr = byte;
        rp2040_set(&hardware->imsc, RP2040_UART_INT_TX);
    }
    return taken;
}

/* It holds two; so that the bound by the length counts, too, three are said. */
uint32_t serial_leaves_in_us(void)
{
    return serial.leaving ? fathom_serial_leaves_in_us(&serial, &settings, 3) : 0u;
}
