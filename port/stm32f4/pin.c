/* SPDX-License-Identifier: MIT */
/*
 * Digital inputs and outputs of the HAL, and the functions of pins for the other files. Each output change is a single
 * write to BSRR.
 */
#include <stddef.h>

#include "internal/stm32f4_port.h"

/* RM0090 8.4. */
enum { MODER = 0x00 / 4, PUPDR = 0x0C / 4, IDR = 0x10 / 4, BSRR = 0x18 / 4, AFRL = 0x20 / 4 };

static volatile uint32_t *registers_of(const fathom_stm32f4_pin_t *pin)
{
    return (volatile uint32_t *)0x40020000u + (0x100 * (pin->port - 'A'));
}

bool fathom_stm32f4_is_pin(const fathom_stm32f4_pin_t *pin)
{
    return (pin->port >= 'A') && (pin->port <= 'I') && (pin->number < 16u);
}

static void set_field(volatile uint32_t *where, uint32_t at, uint32_t mask, uint32_t value)
{
    *where = (*where & ~(mask << at)) | (value << at);
}

void fathom_stm32f4_pin_mode(const fathom_stm32f4_pin_t *pin, uint32_t mode)
{
    set_field(&registers_of(pin)[MODER], 2u * pin->number, 3, mode);
}

bool fathom_stm32f4_pin_init(const fathom_stm32f4_pin_t *pin, uint32_t mode, fathom_stm32f4_pull_t pull,
                             uint32_t alternate)
{
    if (!fathom_stm32f4_is_pin(pin)) return false;
    volatile uint32_t *const gpio = registers_of(pin);
    RCC_AHB1ENR |= 1u << (pin->port - 'A');
    (void)
        RCC_AHB1ENR; /* The read takes the two clock periods until the registers can be written (RM0090 7.2, erratum
                       2.1.13). */
    set_field(&gpio[AFRL + (pin->number / 8u)], 4u * (pin->number % 8u), 15, alternate);
    set_field(&gpio[PUPDR], 2u * pin->number, 3, pull);
    fathom_stm32f4_pin_mode(pin, mode);
    return true;
}

void fathom_stm32f4_pin_set(const fathom_stm32f4_pin_t *pin, bool high)
{
    /* This is one write, which no interrupt can divide. */
    if (pin->port != 0) registers_of(pin)[BSRR] = high ? (1u << pin->number) : (1u << (pin->number + 16u));
}

static void pin_set(void *ctx, bool high) { fathom_stm32f4_pin_set(ctx, high); }

static bool pin_get(void *ctx)
{
    const fathom_stm32f4_pin_t *const pin = ctx;
    return ((registers_of(pin)[IDR] >> pin->number) & 1u) != 0u;
}

fathom_pin_t fathom_stm32f4_output(const fathom_stm32f4_pin_t *pin)
{
    const fathom_pin_t hal = {pin_set, NULL, (void *)pin};
    if (fathom_stm32f4_is_pin(pin)) {
        RCC_AHB1ENR |= 1u << (pin->port - 'A');
        (void)RCC_AHB1ENR;
        fathom_stm32f4_pin_set(pin, true); /* The level is set before the pin is driven. */
        (void)fathom_stm32f4_pin_init(pin, GPIO_OUTPUT, FATHOM_STM32F4_FLOATS, 0);
    }
    return hal;
}

fathom_pin_t fathom_stm32f4_input(const fathom_stm32f4_pin_t *pin, fathom_stm32f4_pull_t pull)
{
    const fathom_pin_t hal = {NULL, pin_get, (void *)pin};
    (void)fathom_stm32f4_pin_init(pin, GPIO_INPUT, pull, 0);
    return hal;
}
