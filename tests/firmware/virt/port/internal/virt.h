/* SPDX-License-Identifier: MIT */
#ifndef VIRT_H
#define VIRT_H

#include <stdint.h>

/* Where things are on this board: QEMU, hw/riscv/virt.c. */
#define VIRT_UART ((volatile uint8_t *)0x10000000u)
enum { VIRT_UART_SOURCE = 10 };

#define VIRT_MTIMECMP ((volatile uint32_t *)0x02004000u) /* low, high */
#define VIRT_MTIME    ((volatile uint32_t *)0x0200BFF8u)

#define VIRT_PLIC_PRIORITY  ((volatile uint32_t *)0x0C000000u)
#define VIRT_PLIC_ENABLE    ((volatile uint32_t *)0x0C002000u) /* hart 0, machine mode */
#define VIRT_PLIC_THRESHOLD (*(volatile uint32_t *)0x0C200000u)
#define VIRT_PLIC_CLAIM     (*(volatile uint32_t *)0x0C200004u)

/* Bits of mstatus and mie (Privileged Architecture 3.1.6 and 3.1.9). */
enum { VIRT_MSTATUS_MIE = 1 << 3, VIRT_MIE_MTIE = 1 << 7, VIRT_MIE_MEIE = 1 << 11 };

/* The 64 bits of mtime. */
uint64_t fathom_virt_ticks(void);

#endif
