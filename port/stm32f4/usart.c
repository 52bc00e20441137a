/* SPDX-License-Identifier: MIT */
/*
 * USART1 to 3, UART4, UART5 and USART6 with their interrupt, and the driver enable of an RS-485 transceiver. Ring and
 * request are those of fathom_serial.h.
 */
#include <stddef.h>

#include "internal/stm32f4_port.h"

/* RM0090 30.6. */
enum { SR = 0x00 / 4, DR = 0x04 / 4, BRR = 0x08 / 4, CR1 = 0x0C / 4, CR2 = 0x10 / 4 };
enum { SR_PE = 1, SR_FE = 2, SR_NE = 4, SR_ORE = 8, SR_RXNE = 0x20, SR_TC = 0x40, SR_TXE = 0x80 };
enum {
    CR1_RE = 1 << 2,
    CR1_TE = 1 << 3,
    CR1_RXNEIE = 1 << 5,
    CR1_TCIE = 1 << 6,
    CR1_TXEIE = 1 << 7,
    CR1_PS = 1 << 9,
    CR1_PCE = 1 << 10,
    CR1_M = 1 << 12,
    CR1_UE = 1 << 13,
    CR2_STOP_2 = 2 << 12
};
enum { MIN_BRR = 16, MAX_BRR = 0xFFFF };
enum { HELD = 2 }; /* bytes: one in DR, one that leaves */

/* RM0090 2.3, 7.3 and table 62; the datasheet's table of alternate functions. */
typedef struct {
    volatile uint32_t *registers;
    volatile uint32_t *enable;
    uint8_t enable_bit;
    uint8_t interrupt;
    uint8_t alternate;
} place_t;
static const place_t places[] = {
    {(volatile uint32_t *)0x40011000u, &RCC_APB2ENR, 4, 37, 7},
    {(volatile uint32_t *)0x40004400u, &RCC_APB1ENR, 17, 38, 7},
    {(volatile uint32_t *)0x40004800u, &RCC_APB1ENR, 18, 39, 7},
    {(volatile uint32_t *)0x40004C00u, &RCC_APB1ENR, 19, 52, 8},
    {(volatile uint32_t *)0x40005000u, &RCC_APB1ENR, 20, 53, 8},
    {(volatile uint32_t *)0x40011400u, &RCC_APB2ENR, 5, 71, 8},
};
enum { PLACES = sizeof(places) / sizeof(places[0]) };

/* Returns BRR. With 16 samples a bit, BRR is the divider in sixteenths. Returns 0 if the rate cannot be reached within
 * 2.5 %. */
static uint32_t divider(uint32_t bus_hz, const fathom_line_settings_t *line)
{
    return fathom_serial_divider(bus_hz, line, MIN_BRR, MAX_BRR);
}

static void set_up(fathom_stm32f4_usart_t *usart, const fathom_line_settings_t *line, uint32_t by)
{
    uint32_t control = CR1_UE | CR1_TE | CR1_RE | CR1_RXNEIE;
    /* With M the word has 9 bits; one of them is the parity. */
    if (line->parity != FATHOM_PARITY_NONE) control |= CR1_M | CR1_PCE;
    if (line->parity == FATHOM_PARITY_ODD) control |= CR1_PS;
    usart->registers[CR1] = 0;
    usart->registers[BRR] = by;
    usart->registers[CR2] = (line->stop_bits == 2u) ? CR2_STOP_2 : 0;
    usart->registers[CR1] = control;
    usart->line = *line;
}

static void receive(fathom_stm32f4_usart_t *usart, uint32_t why)
{
    const uint8_t byte =
        (uint8_t)usart->registers
            [DR]; /* The cast drops the parity bit. This read after that of SR clears the flags of SR. */
    uint8_t flags = 0;
    if ((why & SR_PE) != 0u) flags |= FATHOM_RX_PARITY;
    if ((why & SR_FE) != 0u) flags |= FATHOM_RX_FRAMING;
    if ((why & SR_NE) != 0u) fathom_serial_count(&usart->noise);
    if ((why & SR_RXNE) != 0u) fathom_serial_put(&usart->serial, byte, flags);
    if ((why & SR_ORE) != 0u)
        fathom_serial_lose(&usart->serial); /* Bytes after this one were lost (RM0090 30.3.3). */
}

void fathom_stm32f4_usart_interrupt(fathom_stm32f4_usart_t *usart)
{
    volatile uint32_t *const registers = usart->registers;
    const uint32_t why = registers[SR];
    const uint32_t control = registers[CR1];
    uint8_t byte;
    if ((why & (SR_RXNE | SR_ORE)) != 0u) receive(usart, why);
    if (((control & CR1_TXEIE) != 0u) && ((why & SR_TXE) != 0u)) {
        if (fathom_serial_next(&usart->serial, &byte))
            registers[DR] = byte; /* This write after the read of SR clears TC. */
        else
            registers[CR1] = (control & ~(uint32_t)CR1_TXEIE) | CR1_TCIE;
    } else if (((control & CR1_TCIE) != 0u) && ((why & SR_TC) != 0u)) {
        fathom_stm32f4_pin_set(&usart->driver, false);
        registers[CR1] = control & ~(uint32_t)CR1_TCIE;
        usart->serial.leaving = false;
        fathom_stm32f4_happened = 1;
    }
}

static int usart_read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    return fathom_serial_read(&((fathom_stm32f4_usart_t *)ctx)->serial, bytes, capacity, rx);
}

static int usart_write(void *ctx, const uint8_t *bytes, size_t length)
{
    fathom_stm32f4_usart_t *const usart = ctx;
    if (usart->is_break) return 0;
    const int loaded = fathom_serial_load(&usart->serial, bytes, length);
    if (loaded > 0) {
        fathom_stm32f4_pin_set(&usart->driver, true);
        usart->registers[CR1] |=
            CR1_TXEIE; /* No request is being sent, so the interrupt does not write CR1. */
    }
    return loaded;
}

static bool usart_sent(void *ctx) { return !((const fathom_stm32f4_usart_t *)ctx)->serial.leaving; }

static uint32_t usart_leaves_in_us(void *ctx)
{
    const fathom_stm32f4_usart_t *const usart = ctx;
    return usart_sent(ctx) ? 0u : fathom_serial_leaves_in_us(&usart->serial, &usart->line, HELD);
}

static int usart_set_line(void *ctx, const fathom_line_settings_t *settings)
{
    fathom_stm32f4_usart_t *const usart = ctx;
    if (fathom_serial_is_same(settings, &usart->line)) return 1;
    const uint32_t by = divider(usart->bus_hz, settings);
    if (by == 0u) return -1;
    if (usart->serial.leaving) return 0;
    set_up(usart, settings, by);
    return 1;
}

static int usart_set_break(void *ctx, bool on)
{
    fathom_stm32f4_usart_t *const usart = ctx;
    if (usart->serial.leaving) return 0;
    if (on) {
        fathom_stm32f4_pin_set(&usart->driver, true);
        fathom_stm32f4_pin_set(&usart->tx, false);
    }
    fathom_stm32f4_pin_mode(&usart->tx, on ? GPIO_OUTPUT : GPIO_ALTERNATE);
    if (!on) fathom_stm32f4_pin_set(&usart->driver, false);
    usart->is_break = on;
    return 1;
}

bool fathom_stm32f4_usart_init(fathom_stm32f4_usart_t *usart, const fathom_stm32f4_usart_config_t *config)
{
    if ((config->number < 1u) || (config->number > PLACES) || (config->request == NULL) ||
        (config->request_size == 0u) || !fathom_stm32f4_is_pin(&config->tx) ||
        !fathom_stm32f4_is_pin(&config->rx))
        return false;
    const uint32_t by = divider(config->bus_hz, &config->line);
    if (by == 0u) return false;
    const place_t *const place = &places[config->number - 1u];
    *place->enable |= 1u << place->enable_bit;
    (void)*place->enable;
    fathom_serial_init(&usart->serial, config->request, config->request_size);
    usart->registers = place->registers;
    usart->bus_hz = config->bus_hz;
    usart->tx = config->tx;
    usart->driver = config->driver;
    usart->noise = 0;
    usart->is_break = false;
    if (fathom_stm32f4_pin_init(&config->driver, GPIO_OUTPUT, FATHOM_STM32F4_DOWN, 0))
        fathom_stm32f4_pin_set(&config->driver, false);
    set_up(usart, &config->line, by);
    (void)fathom_stm32f4_pin_init(&config->tx, GPIO_ALTERNATE, FATHOM_STM32F4_UP, place->alternate);
    (void)fathom_stm32f4_pin_init(&config->rx, GPIO_ALTERNATE, FATHOM_STM32F4_UP, place->alternate);
    fathom_stm32f4_enable_interrupt(place->interrupt);
    return true;
}

fathom_uart_t fathom_stm32f4_usart(fathom_stm32f4_usart_t *usart)
{
    const fathom_uart_t hal = {.read = usart_read,
                               .write = usart_write,
                               .sent = usart_sent,
                               .set_line = usart_set_line,
                               .set_break = usart_set_break,
                               .leaves_in_us = usart_leaves_in_us,
                               .ctx = usart};
    return hal;
}
