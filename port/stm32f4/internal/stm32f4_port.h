/* SPDX-License-Identifier: MIT */
#ifndef STM32F4_PORT_H
#define STM32F4_PORT_H

#include "fathom_stm32f4.h"

/* The declarations that the files of this port share. */

#define RCC_AHB1ENR (*(volatile uint32_t *)0x40023830u)
#define RCC_APB1ENR (*(volatile uint32_t *)0x40023840u)
#define RCC_APB2ENR (*(volatile uint32_t *)0x40023844u)

/* General-purpose timers (RM0090 18.4). */
#define TIM2 ((volatile uint32_t *)0x40000000u)
#define TIM5 ((volatile uint32_t *)0x40000C00u)
enum {
    TIM_CR1 = 0x00 / 4,
    TIM_DIER = 0x0C / 4,
    TIM_SR = 0x10 / 4,
    TIM_EGR = 0x14 / 4,
    TIM_CCMR1 = 0x18 / 4,
    TIM_CCER = 0x20 / 4,
    TIM_CNT = 0x24 / 4,
    TIM_PSC = 0x28 / 4,
    TIM_ARR = 0x2C / 4,
    TIM_CCR1 = 0x34 / 4,
    TIM_CCR2 = 0x38 / 4
};
enum { TIM_CR1_CEN = 1, TIM_CR1_URS = 4, TIM_CR1_OPM = 8, TIM_EGR_UG = 1 };
enum { RCC_TIM2 = 1, RCC_TIM5 = 8 };

/* True if an interrupt has done something for which the main loop may be waiting. A received byte does not set it,
 * because the ring shows that byte. idle.c clears it. */
extern volatile uint8_t fathom_stm32f4_happened;

void fathom_stm32f4_enable_interrupt(uint8_t number);

enum { GPIO_INPUT = 0, GPIO_OUTPUT = 1, GPIO_ALTERNATE = 2 };

/* Enables the clock of the port and selects the function of a pin. `alternate`: 0 to 15. Returns false if there is no
 * such pin. */
bool fathom_stm32f4_pin_init(const fathom_stm32f4_pin_t *pin, uint32_t mode, fathom_stm32f4_pull_t pull,
                             uint32_t alternate);
void fathom_stm32f4_pin_mode(const fathom_stm32f4_pin_t *pin, uint32_t mode);
void fathom_stm32f4_pin_set(const fathom_stm32f4_pin_t *pin,
                            bool high); /* Does nothing if there is no pin. */
bool fathom_stm32f4_is_pin(const fathom_stm32f4_pin_t *pin);

#endif
