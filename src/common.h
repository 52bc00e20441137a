/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_COMMON_H
#define FATHOM_COMMON_H

#include "fathom/engine/sensor.h"
#include "fathom/hal.h"

/*
 * A check of a programming mistake, for those who compile the sources: for example
 * -include assert.h -DFATHOM_ASSERT=assert. Empty by default. The function returns its error all the same.
 * FATHOM_ASSERT_NOTE is a statement that only such a check needs.
 */
#ifdef FATHOM_ASSERT
#define FATHOM_ASSERT_NOTE(statement) statement
#endif
#ifndef FATHOM_ASSERT
#define FATHOM_ASSERT(condition)      ((void)0)
#define FATHOM_ASSERT_NOTE(statement) ((void)0)
#endif

/* What several sources need and no user does. Inline: each is less code than a call of it. */

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

/* How much of `us` is left when so much of it has passed. */
static inline uint32_t rest_us(uint32_t us, uint32_t passed_us)
{
    if (us <= passed_us) return 0;
    return us - passed_us;
}

/* A member of a config of which 0 means its default. */
static inline uint32_t or_default(uint32_t value, uint32_t default_value)
{
    return (value != 0u) ? value : default_value;
}

/* A counter that stops at 65535. */
static inline void count_one(uint16_t *counter)
{
    *counter = (uint16_t)(*counter + (*counter != UINT16_MAX));
}

/* All bytes 0. volatile: or compilers make it a call of memset, which costs more. */
static inline void clear(void *object, size_t size)
{
    volatile uint8_t *at = object;
    for (; size != 0u; size--) {
        *at = 0;
        at++;
    }
}

/* All bytes of one into another, which may be the same; volatile for the same reason. */
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

static inline fathom_sensor_t sensor_of(fathom_status_t (*poll)(void *ctx, fathom_sample_t *sample),
                                        uint32_t (*due_us)(void *ctx), void *driver)
{
    fathom_sensor_t sensor;
    sensor.poll = poll;
    sensor.due_us = due_us;
    sensor.ctx = driver;
    return sensor;
}

#endif
