/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_VIRT_H
#define FATHOM_VIRT_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/hal.h"
#include "fathom_serial.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * The HAL on RISC-V, on QEMU's board "virt": the timer that every RISC-V has (mtime), the interrupt controller that
 * most have (PLIC) and an NS16550. Another chip has them at other addresses, see virt.h in internal/. It runs on
 * QEMU, where the tests run it; not seen on a chip.
 *
 *   clock.c   mtime                                  no interrupt
 *   uart.c    NS16550, PLIC source 10                fathom_uart_t
 *   idle.c    mtimecmp, the machine timer interrupt  sleep until bytes come or time is up
 *
 * "The RISC-V Instruction Set Manual, Volume II: Privileged Architecture" 20211203; "RISC-V Platform-Level Interrupt
 * Controller Specification" 1.0.0; the datasheet of the PC16550D. All in machine mode, hart 0. All functions but the
 * interrupts belong to the main loop; the caller sets mtvec and enables machine interrupts (MIE of mstatus).
 */

#define FATHOM_VIRT_TIMER_HZ 10000000u /* of mtime; the device tree's timebase-frequency */

/* mtime runs from reset on. us since then; it wraps at 2^32 us, as hal.h has it, not where the counter does. */
extern const fathom_clock_t fathom_virt_clock;

/* What the clock makes of mtime. */
static inline uint32_t fathom_virt_us(uint64_t ticks)
{
    return (uint32_t)(ticks / (FATHOM_VIRT_TIMER_HZ / 1000000u));
}

/* Read by begin only. */
typedef struct {
    /* memory for the longest request; outlives the use of the UART. 8 bytes for all reads and single writes */
    uint8_t *request;
    uint8_t request_size; /* 1..255 */
    /* of the UART, 16 times the highest rate. QEMU 7.2 counts with FATHOM_VIRT_UART_HZ, whatever its device tree has */
    uint32_t clock_hz;
    fathom_line_settings_t line; /* to begin with */
} fathom_virt_uart_config_t;
#define FATHOM_VIRT_UART_HZ (399193u * 16)

/* The port's; `serial` has counters that the caller may read. */
typedef struct {
    fathom_serial_t serial;
    uint32_t clock_hz;
    fathom_line_settings_t line;
    uint8_t next_errors; /* errors of the byte that is next */
    bool is_break;
} fathom_virt_uart_t;

/* Makes it ready and enables its source in the PLIC and external interrupts (MEIE of mie). false, and nothing has
 * changed: these settings cannot be reached, or there is no memory for a request. */
bool fathom_virt_uart_begin(fathom_virt_uart_t *uart, const fathom_virt_uart_config_t *config);

/* For the machine external interrupt (mcause 0x8000000B): serves the UART until the PLIC has nothing more. Sources
 * that are not the UART's are claimed and completed, and nothing else. */
void fathom_virt_external_interrupt(fathom_virt_uart_t *uart);

/*
 * By value; it points to `uart`. FATHOM_RX_PARITY, _FRAMING and _OVERRUN are reported byte by byte; a read ends before
 * and after such a byte. No FATHOM_RX_TIMED, no FATHOM_RX_SILENCE.
 * write       takes 1 to request_size bytes; of none or more it returns < 0. It begins with up to 16 bytes at once.
 * sent        is exact: TEMT. No interrupt comes with it, so this UART drives no RS-485 transceiver: take one that
 *             switches over by itself, or another UART.
 * set_line    within 2.5 %: 8 data bits, any parity, 1 or 2 stop bits.
 * set_break   as long as it is on (bit 6 of LCR). Meanwhile write returns 0.
 */
fathom_uart_t fathom_virt_uart(fathom_virt_uart_t *uart);

/*
 * For fathom_wait, or a main loop that has nothing to do: sleeps (WFI) until an interrupt is there or max_us have
 * passed, and returns; at once if a byte waits already. A byte that comes while it goes to sleep wakes it. ctx: the
 * fathom_virt_uart_t that ends it, or NULL. Machine interrupts are enabled afterwards.
 */
void fathom_virt_idle(void *ctx, uint32_t max_us);

/* For the machine timer interrupt (mcause 0x80000007), which idle enables. */
void fathom_virt_timer_interrupt(void);

#ifdef __cplusplus
}
#endif

#endif
