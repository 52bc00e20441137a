/* SPDX-License-Identifier: MIT */
/* Digital inputs and outputs of the HAL. A change of a port register disables interrupts meanwhile. */
#include "internal/avr_port.h"

/* PINx, DDRx and PORTx stand in this order (ATmega328P, 14.4). */
static volatile uint8_t *pin_of(const fathom_avr_pin_t *pin) { return pin->port - 2; }
static volatile uint8_t *ddr_of(const fathom_avr_pin_t *pin) { return pin->port - 1; }

/* An interrupt may change another bit of the same register. */
static void change(volatile uint8_t *port, uint8_t mask, bool high)
{
    const uint8_t sreg = SREG;
    cli();
    *port = (uint8_t)(high ? (*port | mask) : (*port & ~mask));
    SREG = sreg;
}

static void set(void *ctx, bool high)
{
    const fathom_avr_pin_t *pin = ctx;
    change(pin->port, pin->mask, high);
}

static bool get(void *ctx)
{
    const fathom_avr_pin_t *pin = ctx;
    return (*pin_of(pin) & pin->mask) != 0;
}

fathom_pin_t fathom_avr_output(const fathom_avr_pin_t *pin)
{
    change(pin->port, pin->mask, true);
    change(ddr_of(pin), pin->mask, true);
    return (fathom_pin_t){.set = set, .ctx = (void *)(uintptr_t)pin};
}

fathom_pin_t fathom_avr_input(const fathom_avr_pin_t *pin, bool pull_up)
{
    change(ddr_of(pin), pin->mask, false);
    change(pin->port, pin->mask, pull_up);
    return (fathom_pin_t){.get = get, .ctx = (void *)(uintptr_t)pin};
}
