/* SPDX-License-Identifier: MIT */
/*
 * Edges by the captures of TIM2, with the time of the hardware. This code has never run except on memory in place of
 * the registers: no available simulator has a timer with captures.
 */
#include <stddef.h>

#include "internal/stm32f4_port.h"

/* RM0090 18.3.6, PWM input mode without the reset of the counter: both captures use TI1, the first at its rise, the
 * second at its fall. */
enum { CCMR1_IC1_TI1 = 1, CCMR1_IC2_TI1 = 2 << 8 };
/* Eight samples at the clock of the timer must agree. Both edges are 0.1 us late, and ringing causes no edges. */
enum { CCMR1_IC1F_8 = 3 << 4, CCMR1_IC2F_8 = 3 << 12 };
enum { CCER_CC1E = 1 << 0, CCER_CC2E = 1 << 4, CCER_CC2P = 1 << 5 };
enum {
    CC1 = 1 << 1,
    CC2 = 1 << 2,
    CC1OF = 1 << 9,
    CC2OF = 1 << 10
}; /* Bits of SR. The first two are in DIER too. */
enum { TIM2_INTERRUPT = 28, TIM2_ALTERNATE = 1 };
enum { OVERTAKEN_US = 1000 }; /* longer than any interrupt between the reads of SR and CCR */

static fathom_edges_t *captured; /* TIM2 exists once */
static uint32_t fed_us;

/* Feeds an edge that is not older than the newest edge. Between the reads of SR and CCR1 a spike may store a new rise.
 * The fall before that rise comes with the next interrupt and is dropped. */
static void feed(bool high, uint32_t time_us)
{
    const uint32_t behind_us = fed_us - time_us;
    if ((behind_us != 0u) && (behind_us < OVERTAKEN_US)) return;
    fed_us = time_us;
    fathom_edges_feed(captured, high, time_us);
}

void fathom_stm32f4_tim2_interrupt(void)
{
    const uint32_t why = TIM2[TIM_SR];
    uint32_t rise_us = 0;
    uint32_t fall_us = 0;
    if ((why & CC1) != 0u) rise_us = TIM2[TIM_CCR1]; /* The read clears CC1. */
    if ((why & CC2) != 0u) fall_us = TIM2[TIM_CCR2];
    TIM2[TIM_SR] = ~(why & (CC1OF | CC2OF)); /* edges.h notices that an overwritten edge is missing. */
    if ((captured == NULL) || ((why & (CC1 | CC2)) == 0u)) return;
    fathom_stm32f4_happened = 1;
    /* If both have the same time, the level before shows which was first. */
    const bool is_fall_first =
        (rise_us == fall_us) ? captured->is_high : ((rise_us - fall_us) < (UINT32_MAX / 2u));
    const bool fall_first = ((why & (CC1 | CC2)) == (CC1 | CC2)) && is_fall_first;
    if (fall_first) feed(false, fall_us);
    if ((why & CC1) != 0u) feed(true, rise_us);
    if (((why & CC2) != 0u) && !fall_first) feed(false, fall_us);
}

bool fathom_stm32f4_capture_init(const fathom_stm32f4_pin_t *pin, fathom_edges_t *edges)
{
    if ((pin->port != 'A') || ((pin->number != 0u) && (pin->number != 5u) && (pin->number != 15u)))
        return false;
    TIM2[TIM_DIER] = 0;
    captured = edges;
    fed_us = TIM2[TIM_CNT];
    (void)fathom_stm32f4_pin_init(pin, GPIO_ALTERNATE, FATHOM_STM32F4_DOWN, TIM2_ALTERNATE);
    TIM2[TIM_CCER] = 0; /* The input can be selected only while the channel is off. */
    TIM2[TIM_CCMR1] = CCMR1_IC1_TI1 | CCMR1_IC2_TI1 | CCMR1_IC1F_8 | CCMR1_IC2F_8;
    TIM2[TIM_CCER] = CCER_CC1E | CCER_CC2E | CCER_CC2P;
    TIM2[TIM_SR] = 0;
    TIM2[TIM_DIER] = CC1 | CC2;
    fathom_stm32f4_enable_interrupt(TIM2_INTERRUPT);
    return true;
}
