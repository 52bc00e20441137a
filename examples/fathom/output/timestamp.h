/* SPDX-License-Identifier: MIT */
#ifndef TIMESTAMP_H
#define TIMESTAMP_H

#include <stdint.h>

/* The clock's 64 bits at a moment of which it gave the lower 32, in the last 71 minutes. What is up to half a minute in the
 * future, by another clock's stamp, is now. */
#define TIME_LONGEST_US 4260000000u
uint64_t time_extend(uint64_t now_us, uint32_t then_us);

/* "2025-11-21T09:43:12.123456Z", in a buffer of the caller's. */
enum { UTC_TEXT = 48 };
const char *utc_text(uint64_t utc_us, char text[UTC_TEXT]);

#endif
