/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_HAL_H
#define FATHOM_HAL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief What Fathom needs from a machine: one small struct of functions for each peripheral.
 *
 * A port is the code of one machine that fills in these structs, which may be const. Fathom never touches a register,
 * an interrupt or an operating system itself. This header declares types and three inline functions, so a program pays
 * only for what it calls. port/README.md shows how to write a port, and fathom_conformance.h tests one.
 *
 * @code
 * static uint32_t now_us(void *ctx) { (void)ctx; return TIMER->COUNT; }       // a 32-bit timer at 1 MHz
 * static const fathom_clock_t clock = {.now_us = now_us};
 * @endcode
 *
 * Rules for all functions of a port:
 *
 * 1. **No waiting.** Each function returns at once. No function calls Fathom.
 *
 * 2. **One context.** Fathom calls the functions of a struct only from the task or main loop that polls its user, such
 *    as a line. Two tasks may poll two lines; both then call the clock that the lines share. Interrupts belong to the
 *    port. The port stores the bytes that an interrupt received until Fathom reads them.
 *
 * 3. **Context and lifetime.** `ctx` belongs to the port. Fathom passes `ctx` to each function of its struct and never
 *    uses it. Fathom keeps pointers to the structs, so a struct must stay valid as long as an object uses it.
 *
 * 4. **Time.** Times wrap. Compare two times only by fathom_elapsed_us().
 *
 * 5. **Broken ports.** A negative result of `read` reports a broken port. Fathom calls `read` again at each poll, so
 *    the port works again as soon as `read` returns 0 or more.
 */

/** @brief The parity of a line. The sensors of Fathom all have 8 data bits. */
typedef enum {
    FATHOM_PARITY_NONE = 0, /**< No parity bit. A16 and A05. */
    FATHOM_PARITY_EVEN = 1, /**< Even parity. HPS-167S with factory settings. */
    FATHOM_PARITY_ODD = 2   /**< Odd parity. */
} fathom_parity_t;

/** @brief The settings of a line. */
typedef struct {
    /** @brief Baud rate in bits per second. */
    uint32_t baud;

    /** @brief Parity: a fathom_parity_t. */
    uint8_t parity;

    /** @brief Number of stop bits: 1 or 2. */
    uint8_t stop_bits;
} fathom_line_settings_t;

/** @brief Returns the number of bits of a character: start, 8 data, parity and stop bits. 10 for 8N1, 11 for 8E1. */
static inline uint8_t fathom_character_bits(const fathom_line_settings_t *settings)
{
    return (uint8_t)(9u + ((settings->parity != FATHOM_PARITY_NONE) ? 1u : 0u) + settings->stop_bits);
}

/**
 * @brief Flags of fathom_rx_t: what a port knows about the bytes of one read. A flag that is not set claims nothing.
 *
 * A line always uses FATHOM_RX_TIMED. It uses the other flags only if its parts name `marks` (line.h).
 */
enum {
    FATHOM_RX_TIMED = 1, /**< `last_us` is set. */
    /** The line was idle for a character or more before the first byte (idle-line interrupt, DMA time-out). */
    FATHOM_RX_SILENCE = 2,
    FATHOM_RX_PARITY = 4, /**< A byte of this read has a wrong parity. All bytes of the read count as bad. */
    FATHOM_RX_FRAMING =
        8, /**< A byte has no stop bit (break, noise, other baud rate). All bytes of the read count as bad. */
    FATHOM_RX_OVERRUN = 16, /**< Bytes were lost directly before the first byte of this read. */
    /** No response to the newest request will arrive: a gateway reported that. The bytes of this read are no part of a
     * frame; the port returns at least one. A line uses this flag only if its parts name fathom_line_refusals(). */
    FATHOM_RX_NO_RESPONSE = 32
};

/** @brief What a port reports about the bytes of one read. Fathom clears the struct before each read. */
typedef struct {
    /**
     * @brief Clock at the end of the last byte, in microseconds. Used with FATHOM_RX_TIMED only.
     *
     * Fathom reads the clock after each read that returned bytes. If `last_us` is later than this time, or 2^31 us or
     * more before it, this time counts instead. `last_us` can be later if it is of another timer, or rounded up.
     */
    uint32_t last_us;

    /** @brief Flags: FATHOM_RX_... */
    uint8_t flags;
} fathom_rx_t;

/**
 * @brief A serial line. On RS485 the port also drives the transceiver.
 *
 * `read`, `write` and `sent` are required. Each other function may be NULL. If the receiver stays on while the port
 * sends, `read` returns the sent bytes too: name FATHOM_LINE_ECHO_ON in the parts of the line (line.h).
 */
typedef struct {
    /**
     * @brief Copies received bytes.
     *
     * If the port sets FATHOM_RX_SILENCE, one call returns the bytes before the silence, and the next call returns the
     * bytes after it, with this flag. A byte that the port knows to be bad is returned alone. For example, if the third
     * of five bytes has a wrong parity, three calls return 2 bytes, 1 byte with FATHOM_RX_PARITY, and 2 bytes.
     *
     * @param bytes     The memory for the bytes. Valid only during the call.
     * @param capacity  Size of `bytes` in bytes, at least 1.
     * @param rx        What the port knows about the bytes. All members are 0 before the call.
     * @return The number of bytes, at most `capacity`. 0 if no byte waits. Negative if the port is broken (unplugged,
     *         closed).
     */
    int (*read)(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx);

    /**
     * @brief Sends all bytes or none.
     *
     * Between two bytes the pin is idle for less than 1.5 characters. A device such as the HPS-167S discards a frame
     * with a longer silence in it (HPS-167S 2.2.3).
     *
     * @param bytes   The bytes. Valid only during the call, so the port copies them.
     * @param length  Number of bytes: 1 to `frame_size` of the line (line.h). The drivers of Fathom send at most 13.
     * @return `length` if the port accepted all bytes. 0 if the port is busy and accepted none: Fathom calls again.
     *         After 1 s of that, the port counts as broken (line.h). Negative if the port is broken.
     */
    int (*write)(void *ctx, const uint8_t *bytes, size_t length);

    /**
     * @brief Returns true if the last stop bit of all accepted bytes has left the pin.
     *
     * If the result is false for 1 s after `write`, the port counts as broken (line.h). The result may become true
     * late, because a USB adapter does not know the exact time. Bytes that are read before that still count as a
     * response. A port that drives a transceiver lets it receive again at the latest 3 characters after the last stop
     * bit, because a unit may respond then.
     */
    bool (*sent)(void *ctx);

    /**
     * @brief Changes the line settings and keeps the received bytes.
     *
     * Fathom calls this function before each request that names line settings, even if they are in force already. If
     * the function is NULL, each request that names line settings ends with FATHOM_ERR_UNSUPPORTED.
     *
     * @param settings  The new settings. Valid only during the call.
     * @retval 1  The settings are in force.
     * @retval 0  Bytes are still leaving. Fathom calls again. After 1 s of that, the port counts as broken (line.h).
     * @return Negative: the port cannot make these settings within 2.5 %, and nothing has changed; or the port is
     *         broken. The request ends with FATHOM_ERR_UNSUPPORTED. `read` reports a broken port.
     */
    int (*set_line)(void *ctx, const fathom_line_settings_t *settings);

    /**
     * @brief Holds TX low, or releases it. NULL: the port cannot do this.
     *
     * Modules whose RX pin is connected to our TX use this level as their trigger or mode select. Fathom may call this
     * function if TX has the state already. Fathom never calls `write` while TX is low.
     *
     * @param on  True to hold TX low. False to release it, so that TX becomes high.
     * @retval 1  TX has this state.
     * @retval 0  TX cannot change yet, for example because bytes are still leaving. The caller repeats the call. A port
     *            that does not release TX for 1 s counts as broken. The wait for a low TX has no limit, except in a
     *            trigger (trigger.h).
     * @return Negative: the port is broken, or its driver cannot hold TX low.
     */
    int (*set_break)(void *ctx, bool on);

    /**
     * @brief Returns the longest time in microseconds until the last stop bit of all accepted bytes has left the pin.
     *
     * NULL: the port does not know the time. A port calculates it from the remaining bytes, their settings and the
     * clock. The time is less than 2^31. 0 means that the bytes have left, or should have left.
     *
     * Only fathom_line_due_us() uses this time, while a request leaves or the port is busy. So a program that sleeps
     * until then wakes once, and its poll calls `sent`. If the function is NULL, or if it returns 0 while `sent` is
     * still false, the program wakes every millisecond. If the time is too short, the program wakes more often. If the
     * time is too long, the sleep delays the end of a broadcast, or the beginning of a time-out. No byte is lost. The
     * function changes nothing.
     */
    uint32_t (*leaves_in_us)(void *ctx);

    /** @brief Passed to the functions. */
    void *ctx;
} fathom_uart_t;

/** @brief A clock. */
typedef struct {
    /**
     * @brief Returns the time in microseconds. Wraps from 4294967295 to 0, which is every 71.6 minutes.
     *
     * The clock need not start at 0. The clock never goes back; otherwise waits may end at once. A clock that counts in
     * coarser steps is allowed. A wait is then up to one step longer or shorter, so add one step to `silence_us` and
     * `gap_us` of a line.
     */
    uint32_t (*now_us)(void *ctx);

    /** @brief Passed to the function. */
    void *ctx;
} fathom_clock_t;

/** @brief A digital pin: the trigger or mode select of a module, its switch output, or the contact of a relay. */
typedef struct {
    /** @brief Drives the pin: true is high. NULL: the pin is an input. */
    void (*set)(void *ctx, bool high);

    /**
     * @brief Returns the level of the pin: true is high. NULL: the pin is an output.
     *
     * An open contact has the level to which the board pulls the pin.
     */
    bool (*get)(void *ctx);

    /** @brief Passed to the functions. */
    void *ctx;
} fathom_pin_t;

/** @brief A captured high pulse. */
typedef struct {
    /** @brief Time from the rising to the falling edge, in microseconds. */
    uint32_t width_us;

    /** @brief Clock at the falling edge, in microseconds. */
    uint32_t end_us;

    /** @brief Level of the pin now: true is high. Set also if there is no pulse, to show a line that stays high. */
    bool is_high;
} fathom_pulse_t;

/**
 * @brief A device that measures high pulses: the capture input of a timer, or a pin interrupt (edges.h).
 *
 * The capture continues after a pulse. If a pulse ends while an older one waits to be fetched, the capture may lose the
 * new one.
 */
typedef struct {
    /**
     * @brief Starts to search for pulses.
     *
     * The capture discards all pulses from before. A pulse that began before this call does not count.
     */
    void (*arm)(void *ctx);

    /**
     * @brief Fetches the oldest pulse that has ended since `arm`. Each pulse is returned once.
     * @retval 1  There is a pulse. All members of `*pulse` are written.
     * @retval 0  There is no pulse. Only `pulse->is_high` is written.
     * @return Negative: the port is broken.
     */
    int (*take)(void *ctx, fathom_pulse_t *pulse);

    /** @brief Passed to the functions. */
    void *ctx;
} fathom_capture_t;

/** @brief A result of the `..._due_us()` functions: nothing will happen before a byte arrives or a pin changes. */
#define FATHOM_NO_DEADLINE UINT32_MAX

/** @brief Longest time that a configuration may name, in microseconds: 2^31 - 1, which is 35 minutes. */
#define FATHOM_MAX_DURATION_US 0x7FFFFFFFuL

/**
 * @brief Returns the time from `since_us` to `now_us`, in microseconds. Correct across the wrap of the clock.
 *
 * Differences of up to 71.6 minutes are correct. Poll each object of Fathom at least that often. alarm.h, debounce.h
 * and median.h name a shorter time.
 *
 * @param now_us    The later time.
 * @param since_us  The earlier time.
 */
static inline uint32_t fathom_elapsed_us(uint32_t now_us, uint32_t since_us)
{
    return (uint32_t)(now_us - since_us);
}

/**
 * @brief Returns true if a count-down has reached 0, after it was reduced by `by_us`. The count-down stops at 0.
 *
 * @param left_us  The count-down in microseconds. Reduced by the call.
 * @param by_us    The time that has passed, in microseconds.
 */
static inline bool fathom_count_down(uint32_t *left_us, uint32_t by_us)
{
    *left_us = (*left_us > by_us) ? (uint32_t)(*left_us - by_us) : 0u;
    return *left_us == 0u;
}

#ifdef __cplusplus
}
#endif

#endif
