/* SPDX-License-Identifier: MIT */
#ifndef RP2040_VECTORS_H
#define RP2040_VECTORS_H

/* The interrupts that these images use, by the datasheet's names (2.3.2). An image defines those that it enables; the
 * others end in start_fault. */
void timer_irq_0(void);
void timer_irq_1(void);
void timer_irq_2(void);
void timer_irq_3(void);
void io_irq_bank0(void);
void dma_irq_0(void);
void uart0_irq(void);
void uart1_irq(void);

#endif
