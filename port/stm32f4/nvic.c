/* SPDX-License-Identifier: MIT */
/* Enables an interrupt in the NVIC. This file also has the flag by which interrupts wake the main loop. */
#include "internal/stm32f4_port.h"

#define NVIC_ISER ((volatile uint32_t *)0xE000E100u)

volatile uint8_t fathom_stm32f4_happened;

void fathom_stm32f4_enable_interrupt(uint8_t number) { NVIC_ISER[number / 32u] = 1u << (number % 32u); }
