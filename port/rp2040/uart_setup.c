/* SPDX-License-Identifier: MIT */
/*
 * Sets up the registers of a UART: pins, divider, format and FIFO levels. It has no state and no interrupt, so a
 * reception by DMA can use it alone.
 */
#include "fathom_rp2040.h"
#include "rp2040.h"

enum {
    FRACTIONS = 64,         /* of one unit of the divider */
    MAX_DIVIDER = 65535,    /* with no fraction (4.2.7.1) */
    MAX_ERROR_DIVIDER = 40, /* 2.5 % */
    RESET_TRIES = 10000     /* a reset takes some cycles of clk_peri */
};

/* Returns the divider in 64ths. Returns 0 if no divider is within 2.5 %. */
static uint32_t divider(uint32_t clk_peri_hz, uint32_t baud)
{
    const uint32_t steps_hz = clk_peri_hz * (FRACTIONS / 16);
    const uint32_t fastest = steps_hz / FRACTIONS;
    if ((baud == 0u) || (baud > (fastest + (fastest / MAX_ERROR_DIVIDER)))) return 0;
    uint32_t result = (steps_hz + (baud / 2u)) / baud;
    if (result < FRACTIONS) result = FRACTIONS;
    if (result > ((uint32_t)MAX_DIVIDER * FRACTIONS)) result = (uint32_t)MAX_DIVIDER * FRACTIONS;
    const uint32_t hz = result * baud;
    uint32_t off_hz = hz - steps_hz;
    if (hz < steps_hz) off_hz = steps_hz - hz;
    return (off_hz > (hz / MAX_ERROR_DIVIDER)) ? 0u : result;
}

bool fathom_rp2040_uart_set_line(const fathom_rp2040_wiring_t *wiring, const fathom_line_settings_t *line)
{
    const uint32_t divide = divider(wiring->clk_peri_hz, line->baud);
    uint32_t format = RP2040_UART_LCR_H_WLEN_8 | RP2040_UART_LCR_H_FEN;
    if ((divide == 0u) || (line->parity > FATHOM_PARITY_ODD)) return false;
    if ((line->stop_bits != 1u) && (line->stop_bits != 2u)) return false;
    if (line->parity != FATHOM_PARITY_NONE) format |= RP2040_UART_LCR_H_PEN;
    if (line->parity == FATHOM_PARITY_EVEN) format |= RP2040_UART_LCR_H_EPS;
    if (line->stop_bits == 2u) format |= RP2040_UART_LCR_H_STP2;

    /* LCR_H must not change while the UART is enabled, and the write to LCR_H makes the divider effective (4.2.7.1).
     * FEN stays set, so the FIFO keeps its bytes. */
    rp2040_uart_t *const hardware = RP2040_UART(wiring->number);
    rp2040_clear(&hardware->cr, RP2040_UART_CR_UARTEN);
    hardware->ibrd = divide / FRACTIONS;
    hardware->fbrd = divide % FRACTIONS;
    hardware->lcr_h = format;
    rp2040_set(&hardware->cr, RP2040_UART_CR_UARTEN | RP2040_UART_CR_TXE | RP2040_UART_CR_RXE);
    return true;
}

/* 1.4.3, function 2: of every four GPIOs the first is TX and the second RX. These groups of four belong to UART0, 1, 1,
 * 0, and so on. */
static bool is_pin(const fathom_rp2040_wiring_t *wiring, unsigned gpio, unsigned of_four)
{
    return (gpio < FATHOM_RP2040_GPIOS) && ((gpio % 4u) == of_four) &&
           (((gpio + 4u) / 8u % 2u) == wiring->number);
}

bool fathom_rp2040_uart_setup(const fathom_rp2040_wiring_t *wiring, const fathom_line_settings_t *line)
{
    if ((wiring->number > 1u) || !is_pin(wiring, wiring->tx, 0) || !is_pin(wiring, wiring->rx, 1))
        return false;
    if (wiring->has_driver &&
        ((wiring->driver >= FATHOM_RP2040_GPIOS) || (wiring->alarm >= FATHOM_RP2040_ALARMS)))
        return false;

    rp2040_uart_t *const hardware = RP2040_UART(wiring->number);
    const uint32_t blocks =
        ((uint32_t)RP2040_RESETS_UART0 << wiring->number) | RP2040_RESETS_IO_BANK0 | RP2040_RESETS_PADS_BANK0;
    rp2040_set(&RP2040_RESETS_RESET, (uint32_t)RP2040_RESETS_UART0 << wiring->number);
    rp2040_clear(&RP2040_RESETS_RESET, blocks);
    for (unsigned tries = RESET_TRIES; (RP2040_RESETS_RESET_DONE & blocks) != blocks; tries--)
        if (tries == 0u) return false;

    if (wiring->has_driver) (void)fathom_rp2040_output(wiring->driver, false);
    hardware->imsc = 0;
    hardware->ifls = 0; /* Interrupts come at 4 or more received bytes, and at 4 or fewer bytes to send. */
    RP2040_PADS(wiring->rx) = RP2040_PADS_IE | RP2040_PADS_PUE | RP2040_PADS_SCHMITT;
    RP2040_IO_CTRL(wiring->rx) =
        RP2040_IO_FUNCSEL_UART; /* The pin is set before the UART is enabled, since a low level is a break. */
    if (!fathom_rp2040_uart_set_line(wiring, line)) return false;
    RP2040_PADS(wiring->tx) = RP2040_PADS_IE | RP2040_PADS_DRIVE_4MA | RP2040_PADS_SCHMITT;
    RP2040_IO_CTRL(wiring->tx) = RP2040_IO_FUNCSEL_UART; /* The level stays high, because the UART is idle. */
    return true;
}
