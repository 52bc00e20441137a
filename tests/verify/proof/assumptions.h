/* SPDX-License-Identifier: MIT */
#ifndef ASSUMPTIONS_H
#define ASSUMPTIONS_H

#include <limits.h>

#include "__fc_builtin.h"
#include "fathom/hal.h"

/*
 * All that the proofs assume of what is outside of Fathom, to be held against include/fathom/hal.h, sentence by
 * sentence. What hal.h allows is possible here, at each call anew; where less is assumed than hal.h promises, it says
 * so. What Fathom has to keep towards a port is asserted: a call that breaks it is an alarm.
 *
 * Machines: 8-bit bytes, two's complement, long and pointers of 32 bits, int of 16 or 32 bits, either byte order, by
 * Frama-C's models. No interrupt: one context, as hal.h's rules have it (edges.h has its own, see pure/edges.c).
 *
 * `volatile`: EVA does not see the word (eva.py leaves it out), but in pure/edges.c: to EVA what is written through a
 * volatile pointer is any value from then on. In src/ it keeps compilers from making a loop a call of memcpy; the
 * objects are ordinary ones. Assumed is that nothing but Fathom writes to them: the caller leaves alone what the
 * headers say is Fathom's, and no interrupt has it but by edges.h.
 */

/* ---- values ---- */

static inline uint8_t any_8(void) { return Frama_C_unsigned_char_interval(0, UINT8_MAX); }
static inline uint16_t any_16(void) { return Frama_C_unsigned_short_interval(0, UINT16_MAX); }
static inline uint32_t any_32(void) { return (uint32_t)Frama_C_unsigned_long_interval(0, UINT32_MAX); }
static inline bool any_bool(void) { return Frama_C_interval(0, 1) != 0; }
static inline uint8_t any_8_in(uint8_t least, uint8_t most)
{
    return Frama_C_unsigned_char_interval(least, most);
}
static inline int any_negative(void) { return Frama_C_interval(INT_MIN, -1); }

/* `count` bytes that can be any; what lies behind them keeps what it had. Of a local that is nothing: to read it is an
 * alarm. any_memory: the same of a constant count, at once. */
static inline void any_bytes(uint8_t *bytes, size_t count)
{
    for (size_t i = 0; i < count; i++) bytes[i] = any_8();
}

static inline void any_memory(void *memory, size_t size) { Frama_C_make_unknown(memory, size); }

/* ---- fathom_clock_t ---- */

/* "`ctx` is the port's and is passed back untouched." */
static int assumed_ctx;

/* Less than hal.h promises: any time at each call, monotonic or not. */
static uint32_t assumed_now_us(void *ctx)
{
    /*@ assert ctx == &assumed_ctx; */
    return any_32();
}

static const fathom_clock_t assumed_clock = {assumed_now_us, &assumed_ctx};

/* ---- fathom_uart_t ---- */

/* 0..capacity bytes that can be any; any flags that there are; any stamp, whether it is said to be set or not. Less than
 * hal.h promises: a read may span what it knows of. */
static int assumed_read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    /*@ assert ctx == &assumed_ctx; */
    /*@ assert 1 <= capacity <= 255; */
    /*@ assert \valid(bytes + (0 .. capacity - 1)); */
    /*@ assert rx->flags == 0 && rx->last_us == 0; */ /* "`rx` comes zeroed." */
    if (any_bool()) return any_negative();
    const uint8_t count = Frama_C_unsigned_char_interval(0, (uint8_t)capacity);
    any_bytes(bytes, count);
    rx->flags = any_8_in(0, FATHOM_RX_TIMED | FATHOM_RX_SILENCE | FATHOM_RX_PARITY | FATHOM_RX_FRAMING |
                                FATHOM_RX_OVERRUN | FATHOM_RX_NO_RESPONSE);
    rx->last_us = any_32();
    return count;
}

/* All, none, or broken. */
static int assumed_write(void *ctx, const uint8_t *bytes, size_t length)
{
    /*@ assert ctx == &assumed_ctx; */
    /*@ assert 1 <= length <= 255; */
    /*@ assert \initialized(bytes + (0 .. length - 1)); */
    if (any_bool()) return any_negative();
    return any_bool() ? (int)length : 0;
}

/* Less than hal.h promises: it may be true, and false again. */
static bool assumed_sent(void *ctx)
{
    /*@ assert ctx == &assumed_ctx; */
    return any_bool();
}

/* "less than 2^31" */
static uint32_t assumed_leaves_in_us(void *ctx)
{
    /*@ assert ctx == &assumed_ctx; */
    return any_32() & INT32_MAX;
}

static int assumed_set_line(void *ctx, const fathom_line_settings_t *settings)
{
    /*@ assert ctx == &assumed_ctx; */
    /*@ assert \initialized(&settings->baud) && \initialized(&settings->parity) &&
               \initialized(&settings->stop_bits); */
    return any_bool() ? any_negative() : any_8_in(0, 1);
}

static int assumed_set_break(void *ctx, bool on)
{
    /*@ assert ctx == &assumed_ctx; */
    /*@ assert on == 0 || on == 1; */
    return any_bool() ? any_negative() : any_8_in(0, 1);
}

/* One that can all, and one that has NULL for what it cannot. */
static const fathom_uart_t assumed_uart = {assumed_read,     assumed_write,     assumed_sent,
                                           assumed_set_line, assumed_set_break, assumed_leaves_in_us,
                                           &assumed_ctx};
static const fathom_uart_t assumed_bare_uart = {assumed_read, assumed_write, assumed_sent, NULL,
                                                NULL,         NULL,          &assumed_ctx};

/* ---- fathom_pin_t ---- */

static void assumed_set(void *ctx, bool high)
{
    /*@ assert ctx == &assumed_ctx; */
    /*@ assert high == 0 || high == 1; */
}

static bool assumed_get(void *ctx)
{
    /*@ assert ctx == &assumed_ctx; */
    return any_bool();
}

static const fathom_pin_t assumed_input = {NULL, assumed_get, &assumed_ctx};
static const fathom_pin_t assumed_output = {assumed_set, NULL, &assumed_ctx};

/* ---- fathom_capture_t ---- */

static void assumed_arm(void *ctx)
{ /*@ assert ctx == &assumed_ctx; */
}

/* Less than hal.h promises: pulses of any width end at any time, and take may say so before arm. */
static int assumed_take(void *ctx, fathom_pulse_t *pulse)
{
    /*@ assert ctx == &assumed_ctx; */
    /*@ assert \valid(pulse); */
    if (any_bool()) return any_negative();
    pulse->is_high = any_bool();
    if (any_bool()) return 0; /* "only pulse->is_high is set" */
    pulse->width_us = any_32();
    pulse->end_us = any_32();
    return 1;
}

static const fathom_capture_t assumed_capture = {assumed_arm, assumed_take, &assumed_ctx};

#endif
