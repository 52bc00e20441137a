/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_SIM_WIRE_H
#define FATHOM_SIM_WIRE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "fathom/hal.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * Characters on a wire in time: how long one lasts, and a sender that puts bytes on a line one after the
 * other, each for its true duration. Used by the line (sim.h) and by the devices; an application needs none
 * of this.
 *
 * A character is 1 start bit, 8 data bits, a parity bit where there is one, and 1 or 2 stop bits.
 */
enum {
    FATHOM_SIM_MAX_FRAME = 255, /* bytes of the longest frame that a device hears or sends */
    FATHOM_SIM_QUEUE = 256,     /* bytes that wait to leave */
    FATHOM_SIM_PAUSES = 6       /* in what a device sends at a time */
};

/* The rates of a line: beyond them the longest frame takes too long, or a bit less than the microsecond in which time
 * is counted here. */
#define FATHOM_SIM_LEAST_BAUD UINT32_C(1200)
#define FATHOM_SIM_MOST_BAUD  UINT32_C(1000000)

/* Silence before byte `at` of what is being sent. */
typedef struct {
    uint32_t us;
    uint16_t at;
} fathom_sim_pause_t;

/* What `characters` (0..256) last in a row, rounded up to a whole us. */
uint32_t fathom_sim_span_us(const fathom_line_settings_t *settings, uint16_t characters);

/* t1.5 and t3.5 (MODBUS over Serial Line 2.5.1.1; HPS-167S 2.2.3): of the real character up to 19200 baud,
 * 750 us and 1750 us above. */
uint32_t fathom_sim_gap_us(const fathom_line_settings_t *settings);
uint32_t fathom_sim_silence_us(const fathom_line_settings_t *settings);

/* Can the one hear the other? The same parity and rates within 2.5 %; a receiver minds one stop bit only. */
bool fathom_sim_same_settings(const fathom_line_settings_t *a, const fathom_line_settings_t *b);

/* How long until `at_us`; 0 when it is now or up to 35 minutes ago. Right across the wrap. */
uint32_t fathom_sim_until_us(uint32_t at_us, uint32_t now_us);

/* One sender on the wire. All zero: idle. */
typedef struct {
    fathom_line_settings_t settings; /* of what is leaving, whatever was set since */
    uint32_t begin_us;               /* start bit of bytes[0] */
    uint16_t length;                 /* bytes to send in all */
    uint16_t sent;                   /* so many of them have left */
    bool on_wire;                    /* bytes[sent] is leaving now */
    bool corrupted;                  /* another device sent at the same time */
    bool after_silence;              /* t3.5 had passed before it */
    uint8_t paused;                  /* used of `pauses` */
    bool marked;                     /* `marks` has any */
    fathom_sim_pause_t pauses[FATHOM_SIM_PAUSES];
    uint8_t marks[FATHOM_SIM_QUEUE]; /* FATHOM_RX_... that the host's UART will report of each byte */
    uint8_t bytes[FATHOM_SIM_QUEUE];
} fathom_sim_sender_t;

bool fathom_sim_sender_idle(const fathom_sim_sender_t *sender);

/* Appends up to `count` bytes without a gap; from idle they begin at `at_us`. Returns how many fitted. Pauses
 * and marks are set after this, from idle, and hold until the next bytes from idle; nothing is appended to
 * them. */
size_t fathom_sim_sender_put(fathom_sim_sender_t *sender, const fathom_line_settings_t *settings,
                             const uint8_t *bytes, size_t count, uint32_t at_us);

/* Time of the next thing: the end of the byte that is leaving, else the beginning of the next one.
 * Not for an idle one. */
uint32_t fathom_sim_sender_next_us(const fathom_sim_sender_t *sender);

/* The level that the bits of the byte on the wire make at this time: start bit low, data from the lowest bit on,
 * parity, stop bits high. Not for one that has none on the wire. */
bool fathom_sim_sender_level(const fathom_sim_sender_t *sender, uint32_t now_us);

#ifdef __cplusplus
}
#endif

#endif
