/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_COMMON_H
#define FATHOM_COMMON_H

/*
 * What the sources of engines, processing and drivers share. It includes no engine.
 */

#include "fathom/hal.h"

/*
 * A check of a programming mistake, for those who compile the sources: for example
 * -include assert.h -DFATHOM_ASSERT=assert. Empty by default. The function returns its error all the same.
 * FATHOM_ASSERT_NOTE is a statement that only such a check needs.
 */
#ifdef FATHOM_ASSERT
#define FATHOM_HAS_ASSERT
#define FATHOM_ASSERT_NOTE(statement) statement
#endif
#ifndef FATHOM_ASSERT
#define FATHOM_ASSERT(condition)      ((void)0)
#define FATHOM_ASSERT_NOTE(statement) ((void)0)
#endif

/* Short functions that several sources share. They are inline, because each is smaller than a call. */

static inline uint32_t clock_us(const fathom_clock_t *clock) { return clock->now_us(clock->ctx); }

static inline uint32_t least_us(uint32_t a, uint32_t b) { return (a < b) ? a : b; }

/*
 * Returns the time from `since_us` to `now_us`. A clock that was set back by up to 100 ms counts as a clock that stood
 * still: without this rule the difference would be 71 minutes, and every wait would be over.
 */
static inline uint32_t time_since_us(uint32_t now_us, uint32_t since_us)
{
    const uint32_t passed_us = fathom_elapsed_us(now_us, since_us);
    return (passed_us > (UINT32_MAX - 100000u)) ? 0u : passed_us;
}

static inline bool is_clock(const fathom_clock_t *clock)
{
    return (clock != NULL) && (clock->now_us != NULL);
}

/* Returns what is left of `us` after `passed_us`. */
static inline uint32_t rest_us(uint32_t us, uint32_t passed_us)
{
    if (us <= passed_us) return 0;
    return us - passed_us;
}

/* Returns a member of a config, or its default if the member is 0. */
static inline uint32_t or_default(uint32_t value, uint32_t default_value)
{
    return (value != 0u) ? value : default_value;
}

/* Increments a counter, which stops at 65535. */
static inline void count_one(uint16_t *counter)
{
    const uint16_t incremented = (uint16_t)(*counter + 1u);
    /* cppcheck-suppress knownConditionTrueFalse ; the sum is 0 if the counter was 65535 */
    if (incremented != 0u) *counter = incremented;
}

/* Sets all bytes of an object to 0. Without volatile, compilers would call memset, which costs more flash. */
static inline void clear(void *object, size_t size)
{
    volatile uint8_t *at = object;
    for (; size != 0u; size--) {
        *at = 0;
        at++;
    }
}

/*
 * Returns the config of an init function, or `zeroed`, all bytes of which are 0 then, if the program has no config. An
 * AVR keeps a constant in RAM, so init functions have `zeroed` on their stack, which is deeper in a poll.
 */
static inline const void *config_or_zeroed(const void *config, void *zeroed, size_t size)
{
    if (config != NULL) return config;
    clear(zeroed, size);
    return zeroed;
}

/* Copies an object onto another one, which may be the same. Volatile for the same reason as in clear(). */
static inline void copy(void *to, const void *from, size_t size)
{
    volatile uint8_t *at = to;
    const uint8_t *of = from;
    for (; size != 0u; size--) {
        *at = *of;
        at++;
        of++;
    }
}

#endif
