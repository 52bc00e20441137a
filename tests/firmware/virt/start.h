/* SPDX-License-Identifier: MIT */
#ifndef VIRT_START_H
#define VIRT_START_H

/* The least that starts C on QEMU's virt. After main it ends, with main's value as its exit status; with START_FAULT
 * after an exception or an interrupt without a handler. */
enum { START_FAULT = 99 };

/* An image defines those that it enables; the others end it with START_FAULT. */
void external_interrupt(void);
void timer_interrupt(void);

#endif
