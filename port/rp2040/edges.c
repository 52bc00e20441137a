/* SPDX-License-Identifier: MIT */
/* Edges of a GPIO by the interrupt of IO_BANK0. The time of an edge is the time at which the interrupt runs. */
#include "fathom_rp2040.h"
#include "rp2040.h"

void fathom_rp2040_edges_init(fathom_rp2040_edges_t *pin, fathom_edges_t *edges, unsigned gpio,
                              fathom_rp2040_idle_t *idle)
{
    pin->edges = edges;
    pin->idle = idle;
    pin->gpio = (uint8_t)gpio;
    __asm__ volatile("" ::: "memory");            /* The stores come before the interrupt is enabled. */
    RP2040_IO_INTR(gpio) = RP2040_IO_EDGES(gpio); /* Earlier edges are cleared by writing a 1. */
    rp2040_set(&RP2040_IO_PROC0_INTE(gpio), RP2040_IO_EDGES(gpio));
    RP2040_NVIC_ISER = UINT32_C(1) << RP2040_IRQ_IO_BANK0;
}

void fathom_rp2040_edges_interrupt(fathom_rp2040_edges_t *pin)
{
    const uint32_t now_us = RP2040_TIMER_RAWL; /* The time is read first. */
    const unsigned gpio = pin->gpio;
    if ((RP2040_IO_PROC0_INTS(gpio) & RP2040_IO_EDGES(gpio)) == 0u) return;
    /* The interrupt is cleared before the level is read. An edge in between shows in the level and interrupts again. In
     * the other order the edge would be lost. */
    RP2040_IO_INTR(gpio) = RP2040_IO_EDGES(gpio);
    fathom_edges_feed(pin->edges, ((RP2040_SIO_GPIO_IN >> gpio) & 1u) != 0u, now_us);
    if (pin->idle != NULL) pin->idle->has_news = true;
}
