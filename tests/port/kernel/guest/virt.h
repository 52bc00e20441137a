/* SPDX-License-Identifier: MIT */
#ifndef VIRT_H
#define VIRT_H

#include "guest.h"

/* The cases of QEMU's `virt` machine. */

extern const guest_case_t virt_uart_cases[];
extern const size_t virt_uart_case_count;
extern const guest_case_t virt_pins_cases[];
extern const size_t virt_pins_case_count;

#endif
