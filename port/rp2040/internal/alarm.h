/* SPDX-License-Identifier: MIT */
#ifndef RP2040_ALARM_H
#define RP2040_ALARM_H

#include <stdint.h>

/* One of TIMER's four alarms. Its interrupt comes `in_us` from now, up to 2^31, at once if that has passed meanwhile:
 * the hardware compares for equality, and would come 71 minutes late. */
void fathom_rp2040_alarm_set(unsigned alarm, uint32_t in_us);

/* Takes back what is set or pending; the interrupt calls it too. */
void fathom_rp2040_alarm_clear(unsigned alarm);

/* Lets its interrupt through to the core. */
void fathom_rp2040_alarm_enable(unsigned alarm);

#endif
