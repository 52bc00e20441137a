/* SPDX-License-Identifier: MIT */
#ifndef RP2040_H
#define RP2040_H

#include <stdint.h>

/*
 * The registers of the RP2040 that the port uses, by their names in its datasheet, whose sections stand beside them.
 * Not for applications, but for code that adds to the port: DMA, another timer.
 */

/* 2.1.2: at these distances each register of a peripheral (not of SIO or the core) has aliases that set and clear
 * single bits, so that an interrupt and the main loop may both change one. */
enum { RP2040_SET = 0x2000, RP2040_CLEAR = 0x3000 };

/* Registers from an address on, and one alone. */
#define RP2040_AT(address)        ((void *)(uintptr_t)(address)) // NOLINT(performance-no-int-to-ptr)
#define RP2040_REGISTERS(address) ((volatile uint32_t *)RP2040_AT(address))
#define RP2040_REGISTER(address)  (*RP2040_REGISTERS(address))

static inline void rp2040_set(volatile uint32_t *reg, uint32_t bits) { reg[RP2040_SET / sizeof *reg] = bits; }

static inline void rp2040_clear(volatile uint32_t *reg, uint32_t bits)
{
    reg[RP2040_CLEAR / sizeof *reg] = bits;
}

/* 2.14 resets */
#define RP2040_RESETS_RESET      RP2040_REGISTER(0x4000C000)
#define RP2040_RESETS_RESET_DONE RP2040_REGISTER(0x4000C008)
enum {
    RP2040_RESETS_IO_BANK0 = 1 << 5,
    RP2040_RESETS_PADS_BANK0 = 1 << 8,
    RP2040_RESETS_TIMER = 1 << 21,
    RP2040_RESETS_UART0 = 1 << 22 /* UART1 is the next bit */
};

/* 2.19.6.1 IO_BANK0: what drives a pin, and its interrupts, which are four bits for each of eight pins a register */
#define RP2040_IO_CTRL(gpio)       RP2040_REGISTERS(0x40014004)[2 * (gpio)]
#define RP2040_IO_INTR(gpio)       RP2040_REGISTERS(0x400140F0)[(gpio) / 8]
#define RP2040_IO_PROC0_INTE(gpio) RP2040_REGISTERS(0x40014100)[(gpio) / 8]
#define RP2040_IO_PROC0_INTS(gpio) RP2040_REGISTERS(0x40014120)[(gpio) / 8]
#define RP2040_IO_EDGES(gpio)      ((uint32_t)(RP2040_IO_EDGE_LOW | RP2040_IO_EDGE_HIGH) << (4 * ((gpio) % 8)))
enum {
    RP2040_IO_FUNCSEL_UART = 2,
    RP2040_IO_FUNCSEL_SIO = 5,
    RP2040_IO_EDGE_LOW = 1 << 2,
    RP2040_IO_EDGE_HIGH = 1 << 3
};

/* 2.19.6.3 PADS_BANK0 */
#define RP2040_PADS(gpio) RP2040_REGISTERS(0x4001C004)[gpio]
enum {
    RP2040_PADS_SCHMITT = 1 << 1,
    RP2040_PADS_PDE = 1 << 2,
    RP2040_PADS_PUE = 1 << 3,
    RP2040_PADS_DRIVE_4MA = 1 << 4,
    RP2040_PADS_IE = 1 << 6
};

/* 2.3.1.7 SIO: a bit for each pin */
#define RP2040_SIO_GPIO_IN      RP2040_REGISTER(0xD0000004)
#define RP2040_SIO_GPIO_OUT_SET RP2040_REGISTER(0xD0000014)
#define RP2040_SIO_GPIO_OUT_CLR RP2040_REGISTER(0xD0000018)
#define RP2040_SIO_GPIO_OE_SET  RP2040_REGISTER(0xD0000024)
#define RP2040_SIO_GPIO_OE_CLR  RP2040_REGISTER(0xD0000028)

/* 4.2.8 UART, ARM's PL011 */
typedef struct {
    volatile uint32_t dr;
    volatile uint32_t rsr;
    volatile uint32_t reserved_08[4];
    volatile uint32_t fr;
    volatile uint32_t reserved_1c;
    volatile uint32_t ilpr;
    volatile uint32_t ibrd;
    volatile uint32_t fbrd;
    volatile uint32_t lcr_h;
    volatile uint32_t cr;
    volatile uint32_t ifls;
    volatile uint32_t imsc;
    volatile uint32_t ris;
    volatile uint32_t mis;
    volatile uint32_t icr;
    volatile uint32_t dmacr;
    volatile uint32_t reserved_4c[0xFED];
} rp2040_uart_t;

#define RP2040_UART(number) (&((rp2040_uart_t *)RP2040_AT(0x40034000))[number])
enum {
    RP2040_UART_DR_FE = 1 << 8,
    RP2040_UART_DR_PE = 1 << 9,
    RP2040_UART_DR_BE = 1 << 10,
    RP2040_UART_DR_OE = 1 << 11,
    RP2040_UART_FR_BUSY = 1 << 3,
    RP2040_UART_FR_RXFE = 1 << 4,
    RP2040_UART_FR_TXFF = 1 << 5,
    RP2040_UART_LCR_H_BRK = 1 << 0,
    RP2040_UART_LCR_H_PEN = 1 << 1,
    RP2040_UART_LCR_H_EPS = 1 << 2,
    RP2040_UART_LCR_H_STP2 = 1 << 3,
    RP2040_UART_LCR_H_FEN = 1 << 4,
    RP2040_UART_LCR_H_WLEN_8 = 3 << 5,
    RP2040_UART_CR_UARTEN = 1 << 0,
    RP2040_UART_CR_TXE = 1 << 8,
    RP2040_UART_CR_RXE = 1 << 9,
    RP2040_UART_INT_RX = 1 << 4, /* imsc, ris, mis, icr */
    RP2040_UART_INT_TX = 1 << 5,
    RP2040_UART_INT_RT = 1 << 6
};

/* 4.6.5 TIMER */
#define RP2040_TIMER_ALARM(number) RP2040_REGISTERS(0x40054010)[number]
#define RP2040_TIMER_ARMED         RP2040_REGISTER(0x40054020)
#define RP2040_TIMER_RAWL          RP2040_REGISTER(0x40054028)
#define RP2040_TIMER_INTR          RP2040_REGISTER(0x40054034)
#define RP2040_TIMER_INTE          RP2040_REGISTER(0x40054038)
#define RP2040_TIMER_INTF          RP2040_REGISTER(0x4005403C)

/* 4.7.6 WATCHDOG, which makes the microseconds of TIMER out of clk_ref */
#define RP2040_WATCHDOG_SCRATCH(number) RP2040_REGISTERS(0x4005800C)[number]
#define RP2040_WATCHDOG_TICK            RP2040_REGISTER(0x4005802C)
enum { RP2040_WATCHDOG_TICK_ENABLE = 1 << 9 };

/* 2.3.2 interrupts, and the core's registers for them, 2.4.8 */
enum {
    RP2040_IRQ_TIMER_0 = 0, /* to TIMER_3 */
    RP2040_IRQ_DMA_0 = 11,
    RP2040_IRQ_IO_BANK0 = 13,
    RP2040_IRQ_UART0 = 20 /* and UART1 */
};
#define RP2040_NVIC_ISER        RP2040_REGISTER(0xE000E100)
#define RP2040_NVIC_IPR(number) RP2040_REGISTERS(0xE000E400)[number]

#endif
