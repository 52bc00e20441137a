/* SPDX-License-Identifier: MIT */
/* The alarms of TIMER. Each alarm causes one interrupt after a time. */
#include "internal/alarm.h"

#include <stdbool.h>

#include "rp2040.h"

void fathom_rp2040_alarm_set(unsigned alarm, uint32_t in_us)
{
    const uint32_t bit = UINT32_C(1) << alarm;
    const uint32_t at_us = RP2040_TIMER_RAWL + in_us;
    RP2040_TIMER_ALARM(alarm) = at_us;
    const bool is_over = (uint32_t)(RP2040_TIMER_RAWL - at_us) <= (UINT32_MAX / 2u);
    if (is_over && ((RP2040_TIMER_ARMED & bit) != 0u)) rp2040_set(&RP2040_TIMER_INTF, bit);
}

void fathom_rp2040_alarm_clear(unsigned alarm)
{
    const uint32_t bit = UINT32_C(1) << alarm;
    RP2040_TIMER_ARMED = bit; /* Writing a 1 disarms the alarm. */
    RP2040_TIMER_INTR = bit;
    rp2040_clear(&RP2040_TIMER_INTF, bit);
}

void fathom_rp2040_alarm_enable(unsigned alarm)
{
    fathom_rp2040_alarm_clear(alarm);
    rp2040_set(&RP2040_TIMER_INTE, UINT32_C(1) << alarm);
    RP2040_NVIC_ISER = UINT32_C(1) << (RP2040_IRQ_TIMER_0 + alarm);
}
