/* SPDX-License-Identifier: MIT */
#ifndef RP2040_ALARM_H
#define RP2040_ALARM_H

#include <stdint.h>

/* Sets one of the four alarms of TIMER. Its interrupt comes `in_us` microseconds from now, at most 2^31. If that time
 * has passed already, the interrupt comes at once. The hardware compares for equality and would be 71 minutes late. */
void fathom_rp2040_alarm_set(unsigned alarm, uint32_t in_us);

/* Cancels an alarm that is set or pending. The interrupt of the alarm calls this too. */
void fathom_rp2040_alarm_clear(unsigned alarm);

/* Enables the interrupt of an alarm. */
void fathom_rp2040_alarm_enable(unsigned alarm);

#endif
