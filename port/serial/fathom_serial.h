/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_SERIAL_H
#define FATHOM_SERIAL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "fathom/hal.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief What the ports of 32-bit machines share: a receive ring and the request that is being sent.
 *
 * The interrupt of a UART puts received bytes into the ring, each with its flags FATHOM_RX_..., and takes the bytes of
 * the request. The main loop reads the ring and loads the request. This header has no registers, disables no
 * interrupts, never waits, and allocates no memory. A fathom_serial_t takes 280 bytes of
 * RAM on a 32-bit machine. port/README.md shows a port that uses it.
 *
 * **Why no lock is needed.** There is one core. Each member has one writer and one reader. Both read only single
 * volatile bytes of each other, and a byte of the ring is in place before `put` counts it. The indices use all 256
 * values of a byte and are taken modulo the size of the ring. The size must therefore divide 256 and be less than 256;
 * otherwise a full ring and an empty one would look the same.
 */

/** @brief Constants of the ring. */
enum {
    FATHOM_SERIAL_RING = 128 /**< Number of bytes that can wait for the main loop: 11 ms at 115200 baud. */
};

/** @brief A ring and a request, in the caller's memory. Only the counters and `leaving` are for the port; a port sets
 * `leaving` to false when the last stop bit has left. */
typedef struct {
    /** @brief Private: the received bytes. The interrupt writes them. */
    volatile uint8_t bytes[FATHOM_SERIAL_RING];
    /** @brief Private: the flags FATHOM_RX_... of each byte. The interrupt writes them. */
    volatile uint8_t flags[FATHOM_SERIAL_RING];
    /** @brief Private: count of bytes put into the ring; wraps. The interrupt writes it. */
    volatile uint8_t put;
    /** @brief Private: count of bytes of the request that the UART has. The interrupt writes it. */
    volatile uint8_t at;
    /** @brief Private: true if bytes were lost since the newest byte of the ring. The interrupt writes it. */
    bool lost;

    /** @brief Bytes with wrong parity since fathom_serial_init(). Stops at 65535. The caller may set it to 0. */
    volatile uint16_t parity;
    /** @brief Bytes without a stop bit: breaks, noise, or another baud rate. Counts like `parity`. */
    volatile uint16_t framing;
    /** @brief Losses that the UART reported, and bytes for which the ring had no space. Counts like `parity`. */
    volatile uint16_t overruns;

    /** @brief Private: count of bytes taken from the ring; wraps. The main loop writes it. */
    volatile uint8_t got;
    /** @brief Private: length of the request in bytes. The main loop writes it. */
    volatile uint8_t length;
    /** @brief True while a request is being sent. fathom_serial_load() sets it; the interrupt of the port sets it to
     * false. */
    volatile bool leaving;
    /** @brief Private: the buffer for the request. */
    uint8_t *request;
    /** @brief Private: size of `request` in bytes. */
    uint8_t size;
} fathom_serial_t;

/**
 * @brief Initialises a ring and its request. Call it before the interrupt is enabled.
 *
 * @param serial   The ring, with any content. Must stay valid as long as the interrupt is enabled.
 * @param request  Buffer for a copy of the longest request, which stays there while it is sent. Must stay valid as long
 *                 as `serial`.
 * @param size     Size of `request` in bytes, 1 to 255.
 */
static inline void fathom_serial_init(fathom_serial_t *serial, uint8_t *request, uint8_t size)
{
    serial->length = 0;
    serial->at = 0;
    serial->got = 0;
    serial->put = 0;
    serial->overruns = 0;
    serial->framing = 0;
    serial->parity = 0;
    serial->leaving = false;
    serial->lost = false;
    serial->request = request;
    serial->size = size;
}

/** @brief Increments a counter that stops at 65535. */
static inline void fathom_serial_count(volatile uint16_t *counter)
{
    if (*counter != UINT16_MAX) (*counter)++;
}

/* ---- for the interrupt ---- */

/**
 * @brief Counts a loss of bytes that the UART reported without a byte. The next byte gets FATHOM_RX_OVERRUN.
 *
 * Call it from the interrupt.
 */
static inline void fathom_serial_lose(fathom_serial_t *serial)
{
    fathom_serial_count(&serial->overruns);
    serial->lost = true;
}

/**
 * @brief Puts a received byte into the ring. If the ring is full, the byte is lost and counted.
 *
 * Call it from the interrupt.
 *
 * @param serial  The ring.
 * @param byte    The received byte.
 * @param flags   0, or FATHOM_RX_PARITY and FATHOM_RX_FRAMING of this byte, and FATHOM_RX_OVERRUN if other bytes were
 *                lost directly before it.
 */
static inline void fathom_serial_put(fathom_serial_t *serial, uint8_t byte, uint8_t flags)
{
    const uint8_t put = serial->put;
    if ((flags & FATHOM_RX_PARITY) != 0) fathom_serial_count(&serial->parity);
    if ((flags & FATHOM_RX_FRAMING) != 0) fathom_serial_count(&serial->framing);
    if ((flags & FATHOM_RX_OVERRUN) != 0) fathom_serial_lose(serial);
    if ((uint8_t)(put - serial->got) == FATHOM_SERIAL_RING) {
        fathom_serial_lose(serial);
        return;
    }
    if (serial->lost) flags |= FATHOM_RX_OVERRUN;
    serial->lost = false;
    serial->bytes[put % FATHOM_SERIAL_RING] = byte;
    serial->flags[put % FATHOM_SERIAL_RING] = flags;
    serial->put = (uint8_t)(put + 1u);
}

/**
 * @brief Takes the next byte of the request. Call it from the interrupt when the UART has space for a byte.
 *
 * @param serial  The ring.
 * @param byte    Receives the byte.
 * @return False if all bytes were taken. Then `byte` is unchanged.
 */
static inline bool fathom_serial_next(fathom_serial_t *serial, uint8_t *byte)
{
    const uint8_t at = serial->at;
    if (at == serial->length) return false;
    *byte = serial->request[at];
    serial->at = (uint8_t)(at + 1u);
    return true;
}

/* ---- for the main loop ---- */

/** @brief Returns true if a received byte waits in the ring. */
static inline bool fathom_serial_waits(const fathom_serial_t *serial) { return serial->put != serial->got; }

/**
 * @brief Reads received bytes: `read` of fathom_uart_t (hal.h).
 *
 * A read ends before and after a byte with a flag.
 *
 * @param serial    The ring.
 * @param bytes     Receives the bytes.
 * @param capacity  Size of `bytes`.
 * @param rx        Receives the flags. It is zeroed before the call.
 * @return Number of bytes; 0 if none waits.
 */
static inline int fathom_serial_read(fathom_serial_t *serial, uint8_t *bytes, size_t capacity,
                                     fathom_rx_t *rx)
{
    const uint8_t put = serial->put;
    uint8_t got = serial->got;
    size_t count = 0;
    while ((got != put) && (count < capacity)) {
        const uint8_t flags = serial->flags[got % FATHOM_SERIAL_RING];
        if ((flags != 0u) && (count != 0u)) break;
        bytes[count] = serial->bytes[got % FATHOM_SERIAL_RING];
        count++;
        got++;
        rx->flags |= flags;
        if (flags != 0u) break;
    }
    serial->got = got;
    return (int)count;
}

/**
 * @brief Copies a request: `write` of fathom_uart_t (hal.h), except that the port starts to send.
 *
 * If the result is positive, the port enables its transmit interrupt, or puts the first byte itself. `leaving` is true
 * from now on until the interrupt sets it to false.
 *
 * @param serial  The ring.
 * @param bytes   The request. Used only during the call.
 * @param length  Length of the request in bytes.
 * @return `length`; 0 if a request is still being sent; -1 if the request is empty or longer than the buffer.
 */
static inline int fathom_serial_load(fathom_serial_t *serial, const uint8_t *bytes, size_t length)
{
    if ((length == 0u) || (length > serial->size)) return -1;
    if (serial->leaving) return 0;
    /* The access is volatile, so the request is in place before `length` and `leaving` change. */
    volatile uint8_t *const kept = serial->request;
    for (size_t i = 0; i != length; i++) kept[i] = bytes[i];
    serial->length = (uint8_t)length;
    serial->at = 0;
    serial->leaving = true;
    return (int)length;
}

/**
 * @brief Returns the time until the request has left, in microseconds: `leaves_in_us` of fathom_uart_t (hal.h).
 *
 * Call it only while `leaving` is true.
 *
 * @param serial  The ring.
 * @param line    The line settings that are in force.
 * @param held    Largest number of bytes that the UART itself holds, including the byte that it sends.
 */
static inline uint32_t fathom_serial_leaves_in_us(const fathom_serial_t *serial,
                                                  const fathom_line_settings_t *line, uint32_t held)
{
    const uint32_t character_bits = 9u + ((line->parity != FATHOM_PARITY_NONE) ? 1u : 0u) + line->stop_bits;
    uint32_t left = serial->length - (uint32_t)serial->at + held;
    if (left > serial->length) left = serial->length;
    return ((left * character_bits * 1000000u) + line->baud - 1u) /
           line->baud; /* 255 characters of 12 bits fit into 32 bits. */
}

/* ---- for set_line ---- */

/**
 * @brief Returns true if two line settings are the same.
 *
 * @param a  Line settings.
 * @param b  Other line settings.
 */
static inline bool fathom_serial_is_same(const fathom_line_settings_t *a, const fathom_line_settings_t *b)
{
    return (a->baud == b->baud) && (a->parity == b->parity) && (a->stop_bits == b->stop_bits);
}

/**
 * @brief Returns the divider of a baud rate generator for line settings.
 *
 * @param clock_hz  The clock that is divided, in Hz.
 * @param line      The line settings.
 * @param least     Smallest divider of the hardware.
 * @param most      Largest divider of the hardware.
 * @return The divider, `least` to `most`. 0 if the rate cannot be reached within 2.5 %, if it is faster than
 *         `clock_hz / least`, or if the parity or the number of stop bits is not allowed.
 */
static inline uint32_t fathom_serial_divider(uint32_t clock_hz, const fathom_line_settings_t *line,
                                             uint32_t least, uint32_t most)
{
    const uint32_t baud = line->baud;
    if ((baud == 0u) || (baud > (clock_hz / least)) || (line->parity > FATHOM_PARITY_ODD) ||
        (line->stop_bits < 1u) || (line->stop_bits > 2u))
        return 0;
    const uint32_t by = (clock_hz + (baud / 2u)) / baud;
    const uint32_t real = clock_hz / by;
    uint32_t off = real - baud;
    if (real < baud) off = baud - real;
    return ((by > most) || (off > (baud / 40u))) ? 0u : by;
}

#ifdef __cplusplus
}
#endif

#endif
