/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_HAL_H
#define FATHOM_HAL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/*
 * What Fathom needs from a machine: one small struct of functions a peripheral. A port fills them in once
 * and they may be const. Rules for all of them:
 *  - every function returns at once; none waits, none calls back into Fathom;
 *  - the core calls them from one context (one task or the main loop). Interrupts belong to the port,
 *    which hands over what they gathered when the core calls it;
 *  - `ctx` is the port's and is passed back untouched.
 */

/* The settings of a line. Fathom's sensors all use 8 data bits. */
typedef enum { FATHOM_PARITY_NONE = 0, FATHOM_PARITY_EVEN = 1, FATHOM_PARITY_ODD = 2 } fathom_parity_t;

typedef struct {
    uint32_t baud;     /* bits per second */
    uint8_t parity;    /* fathom_parity_t */
    uint8_t stop_bits; /* 1 or 2 */
} fathom_line_settings_t;

/* What a port may know about the bytes that one read returned. All optional: no flag, no claim. */
enum {
    FATHOM_RX_TIMED = 1,   /* last_us is set */
    FATHOM_RX_SILENCE = 2, /* the line was idle before the first byte (idle-line interrupt, DMA time-out) */
    FATHOM_RX_PARITY = 4,  /* wrong parity in these bytes */
    FATHOM_RX_FRAMING = 8, /* no stop bit where one was due in these bytes: a break, noise, another rate */
    FATHOM_RX_OVERRUN = 16 /* bytes were lost just before these */
};

typedef struct {
    /* Clock at the end of the last byte, with FATHOM_RX_TIMED. The core reads the clock after each read that brought
     * bytes; a stamp that is later than that (another timer, rounded up), or 2^31 us or more ago, counts as "now". */
    uint32_t last_us;
    uint8_t flags; /* FATHOM_RX_... */
} fathom_rx_t;

/*
 * A serial line.
 *
 * read   Copies up to `capacity` received bytes and returns how many; 0 when none is waiting; < 0 when the
 *        port is broken (unplugged, closed). `rx` comes zeroed. One call never spans a silence or an error
 *        that the port knows of: what lies beyond it is for the next call.
 * write  Takes all `length` bytes (1..255) and returns `length`, or takes none and returns 0 because it is
 *        busy; < 0 when the port is broken. Bytes that were taken leave the pin without a gap: an HPS-167S
 *        drops a frame with a silence of 1.5 characters in it (HPS-167S 2.2.3). The port may not keep the
 *        pointer. On RS-485 the port drives the transceiver.
 * sent   True when the last stop bit of all that was written has left the pin. May turn true late (a USB
 *        adapter cannot know better): bytes that were read before it counts still count as a response.
 * leaves_in_us  In how many microseconds from now, at most, the last stop bit of all that was written will have left
 *        the pin: by the bytes that are left, their settings and the clock; less than 2^31. fathom_line_due_us is that
 *        while a request leaves or is not taken, so that a program that sleeps wakes once for it; `sent` is called
 *        then. 0: they have left, or should have; as long as `sent` is false all the same, the line looks each
 *        millisecond. NULL where the port does not know: the same. Too short costs looks; too long puts off what
 *        follows the request, the end of a broadcast and the beginning of a time-out; neither loses a byte. It may be
 *        called at any time and changes nothing.
 * set_line  Changes the line settings; what was received is kept. 1: they are in force (at once, if they
 *        were before; it is called before each request that names settings). 0: bytes are still leaving, call
 *        again. < 0: this port cannot reach them within 2.5 %, and nothing changed. NULL where they are fixed.
 * set_break  Holds TX low (true), or lets it go high again: the trigger and the mode select of modules whose RX
 *        pin is our TX. 1: done. 0: bytes are still leaving, call again; after a second of that the port counts as
 *        broken. < 0: the port is broken. NULL where it cannot.
 */
typedef struct {
    int (*read)(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx);
    int (*write)(void *ctx, const uint8_t *bytes, size_t length);
    bool (*sent)(void *ctx);
    int (*set_line)(void *ctx, const fathom_line_settings_t *settings);
    int (*set_break)(void *ctx, bool on);
    uint32_t (*leaves_in_us)(void *ctx);
    void *ctx;
} fathom_uart_t;

/*
 * A clock. now_us is monotonic, counts microseconds and wraps from 4294967295 to 0 (every 71.6 minutes).
 * It need not start at 0. Coarser steps are allowed; every deadline is then that much later.
 */
typedef struct {
    uint32_t (*now_us)(void *ctx);
    void *ctx;
} fathom_clock_t;

/*
 * A digital pin: a module's trigger or mode select, its switch output, a relay's contact.
 *
 * set    Drives it: true is high. NULL: it is an input.
 * get    Its level: true is high. Of a contact: what the board's pull resistor makes of it. NULL: an output.
 */
typedef struct {
    void (*set)(void *ctx, bool high);
    bool (*get)(void *ctx);
    void *ctx;
} fathom_pin_t;

/* A high pulse as it was captured. */
typedef struct {
    uint32_t width_us; /* from its rising to its falling edge */
    uint32_t end_us;   /* the clock at the falling edge */
    bool is_high;      /* the level now, also where there was no pulse: a line that never falls again */
} fathom_pulse_t;

/*
 * What measures high pulses: a timer's capture input, or the times of a pin's edges (edges.h makes one of those).
 *
 * arm    Begins to look for pulses; what was captured before is forgotten, and a pulse that has begun before does
 *        not count.
 * take   1: a pulse has ended since arm, the oldest that was not taken; *pulse is all set. 0: none has, and only
 *        pulse->is_high is set. < 0: the port is broken. It goes on looking after a pulse; one that comes while
 *        another waits to be taken may be lost.
 */
typedef struct {
    void (*arm)(void *ctx);
    int (*take)(void *ctx, fathom_pulse_t *pulse);
    void *ctx;
} fathom_capture_t;

/* "Nothing will happen without new bytes": what the due_us functions return instead of a time. */
#define FATHOM_NO_DEADLINE UINT32_MAX

/** @brief Longest time that a configuration may name, in microseconds: 2^31 - 1, which is 35 minutes and half of what the
 * clock counts. */
#define FATHOM_MAX_DURATION_US 0x7FFFFFFFuL

/* The only way in which Fathom compares times: correct across the wrap, for spans up to 71.6 minutes. So
 * whatever is polled must be polled at least that often. */
static inline uint32_t fathom_elapsed_us(uint32_t now_us, uint32_t since_us)
{
    return (uint32_t)(now_us - since_us);
}

/* Moves a count-down on by `by_us`; it stops at 0. True when it stands at 0. */
static inline bool fathom_count_down(uint32_t *left_us, uint32_t by_us)
{
    *left_us = (*left_us > by_us) ? (uint32_t)(*left_us - by_us) : 0u;
    return *left_us == 0u;
}

#ifdef __cplusplus
}
#endif

#endif
