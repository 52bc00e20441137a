/* SPDX-License-Identifier: MIT */
/* Digital inputs and outputs of the HAL, by SIO. The init functions take the pads and the function of the GPIO. */
#include "fathom_rp2040.h"
#include "rp2040.h"

/* `ctx` is the bit of the pin, not an address. */
static uint32_t mask_of(void *ctx) { return (uint32_t)(uintptr_t)ctx; }

static void set(void *ctx, bool high)
{
    if (high)
        RP2040_SIO_GPIO_OUT_SET = mask_of(ctx);
    else
        RP2040_SIO_GPIO_OUT_CLR = mask_of(ctx);
}

static bool get(void *ctx) { return (RP2040_SIO_GPIO_IN & mask_of(ctx)) != 0u; }

static void *begin(unsigned gpio)
{
    const uint32_t blocks = RP2040_RESETS_IO_BANK0 | RP2040_RESETS_PADS_BANK0;
    rp2040_clear(&RP2040_RESETS_RESET, blocks);
    while ((RP2040_RESETS_RESET_DONE & blocks) != blocks) { /* some cycles of clk_sys */
    }
    return (void *)(uintptr_t)(UINT32_C(1) << gpio); // NOLINT(performance-no-int-to-ptr): a mask, no address
}

fathom_pin_t fathom_rp2040_output(unsigned gpio, bool high)
{
    fathom_pin_t pin;
    pin.ctx = begin(gpio);
    pin.set = set;
    pin.get = NULL;
    set(pin.ctx, high); /* The level is set before SIO drives the pin. */
    RP2040_SIO_GPIO_OE_SET = mask_of(pin.ctx);
    RP2040_PADS(gpio) = RP2040_PADS_IE | RP2040_PADS_DRIVE_4MA | RP2040_PADS_SCHMITT;
    RP2040_IO_CTRL(gpio) = RP2040_IO_FUNCSEL_SIO;
    return pin;
}

fathom_pin_t fathom_rp2040_input(unsigned gpio, bool pull_up)
{
    fathom_pin_t pin;
    pin.ctx = begin(gpio);
    pin.set = NULL;
    pin.get = get;
    RP2040_SIO_GPIO_OE_CLR = mask_of(pin.ctx);
    RP2040_PADS(gpio) = RP2040_PADS_IE | RP2040_PADS_SCHMITT | (pull_up ? RP2040_PADS_PUE : 0u);
    RP2040_IO_CTRL(gpio) = RP2040_IO_FUNCSEL_SIO;
    return pin;
}
