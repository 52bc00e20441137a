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

/*
 * What the ports of 32-bit machines share between a UART's interrupt and the main loop: a ring of bytes that came,
 * each with its FATHOM_RX_ flags, and the one request that leaves. No registers here.
 *
 * One core, one writer and one reader of each member; what both look at is a single volatile byte, and a byte of the
 * ring is in place before `put` tells of it. So nothing has to be locked. The indices run freely through all 256
 * values of a byte and are taken modulo the size of the ring, which has to divide 256 and be less than it: else a
 * full ring and an empty one would look the same.
 */
enum {
    FATHOM_SERIAL_RING = 128 /* bytes that wait for the main loop: 11 ms of them at 115200 baud */
};

typedef struct {
    /* The interrupt's. */
    volatile uint8_t bytes[FATHOM_SERIAL_RING];
    volatile uint8_t flags[FATHOM_SERIAL_RING];
    volatile uint8_t put; /* bytes so far; wraps */
    volatile uint8_t at;  /* bytes of the request that have been handed to the UART */
    bool lost;            /* bytes were, since the last one that found room */

    /* Since init; each stops at 65535, and the caller may set it to 0. */
    volatile uint16_t parity;   /* bytes with wrong parity */
    volatile uint16_t framing;  /* bytes without a stop bit: breaks, noise, another rate */
    volatile uint16_t overruns; /* losses that the UART reported, and bytes that found the ring full */

    /* The main loop's, but for the end of `leaving`, which the interrupt sets to false. */
    volatile uint8_t got; /* bytes so far; wraps */
    volatile uint8_t length;
    volatile bool leaving;
    uint8_t *request;
    uint8_t size;
} fathom_serial_t;

/* request: memory for the longest request, which is kept there while it leaves. Before the interrupt is enabled. */
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

static inline void fathom_serial_count(volatile uint16_t *counter)
{
    if (*counter != UINT16_MAX) (*counter)++;
}

/* ---- for the interrupt ---- */

/* Bytes were lost, and none has come with that news: the next one is marked with it. */
static inline void fathom_serial_lose(fathom_serial_t *serial)
{
    fathom_serial_count(&serial->overruns);
    serial->lost = true;
}

/* A byte, with FATHOM_RX_PARITY and FATHOM_RX_FRAMING of its own, and FATHOM_RX_OVERRUN where others were lost just
 * before it. */
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

/* The next byte of the request, which the UART has room for. False: all have been taken. */
static inline bool fathom_serial_next(fathom_serial_t *serial, uint8_t *byte)
{
    const uint8_t at = serial->at;
    if (at == serial->length) return false;
    *byte = serial->request[at];
    serial->at = (uint8_t)(at + 1u);
    return true;
}

/* ---- for the main loop ---- */

static inline bool fathom_serial_waits(const fathom_serial_t *serial) { return serial->put != serial->got; }

/* As `read` of fathom_uart_t. A byte with a flag comes alone: a read ends before it and after it. */
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

/* As `write` of fathom_uart_t, but that the caller begins to hand out the bytes when the result is > 0. From then on
 * `leaving` is true until the interrupt ends it. */
static inline int fathom_serial_load(fathom_serial_t *serial, const uint8_t *bytes, size_t length)
{
    if ((length == 0u) || (length > serial->size)) return -1;
    if (serial->leaving) return 0;
    /* Volatile, so that it is in place before the rest tells of it. */
    volatile uint8_t *const kept = serial->request;
    for (size_t i = 0; i != length; i++) kept[i] = bytes[i];
    serial->length = (uint8_t)length;
    serial->at = 0;
    serial->leaving = true;
    return (int)length;
}

/* As `leaves_in_us` of fathom_uart_t while bytes leave: the UART itself holds up to `held` of those that it was given,
 * the one that it sends among them. */
static inline uint32_t fathom_serial_leaves_in_us(const fathom_serial_t *serial,
                                                  const fathom_line_settings_t *line, uint32_t held)
{
    const uint32_t character_bits = 9u + ((line->parity != FATHOM_PARITY_NONE) ? 1u : 0u) + line->stop_bits;
    uint32_t left = serial->length - (uint32_t)serial->at + held;
    if (left > serial->length) left = serial->length;
    return ((left * character_bits * 1000000u) + line->baud - 1u) / line->baud; /* 255 of 12 bits fit */
}

/* ---- for set_line ---- */

static inline bool fathom_serial_is_same(const fathom_line_settings_t *a, const fathom_line_settings_t *b)
{
    return (a->baud == b->baud) && (a->parity == b->parity) && (a->stop_bits == b->stop_bits);
}

/* What clock_hz is to be divided by for these settings, least..most; 0: that does not come within 2.5 %, is faster than
 * clock_hz / least, or there is no such parity or number of stop bits. */
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
