/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_CONFORMANCE_H
#define FATHOM_CONFORMANCE_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/hal.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * Does a HAL keep what fathom/hal.h says? Link the C files of this folder with it, but host.c, which is a program for
 * Linux; join TX and RX (an RS-485 transceiver hears itself where its receiver stays on), and look at what is reported.
 *
 * It can be seen so that bytes are lost, early, late, truncated or out of order, and that bytes which waited in the
 * port look new. A loop-back has the same rate and
 * the same parity at both ends, so it cannot show that the rate is the right one, nor what another's wrong parity does:
 * for that, `damage`, a sensor, or an oscilloscope.
 *
 * It waits, for some seconds in all, allocates nothing, writes nothing, and needs 4 KiB of stack. Nothing else may use
 * the UART meanwhile.
 */
typedef enum {
    FATHOM_KEPT = 1,
    FATHOM_NOT_KEPT = 2,
    FATHOM_NOT_SEEN = 3 /* this wire, this port or what else is not kept does not show it */
} fathom_verdict_t;

typedef struct {
    const char *name;   /* of the item: "sent_not_early" */
    const char *clause; /* of hal.h, in its words or shorter */
    fathom_verdict_t verdict;
    uint32_t figure;
    const char *of; /* what the figure counts */
} fathom_finding_t;

/* Names the members: one that is NULL or 0 is not looked at. */
typedef struct {
    const fathom_uart_t *uart;
    const fathom_clock_t *clock;
    fathom_line_settings_t line; /* that hold now, and afterwards */
    /* That the port can be set to: at least 20 % faster or slower. baud 0: none. */
    fathom_line_settings_t other;
    uint8_t longest; /* bytes that one write may have, 8..255 */
    uint8_t marks;   /* FATHOM_RX_... that the port tells of */

    /* How late a byte may be handed over, by a USB adapter (20000), an operating system or a simulator. 0 on a
     * microcontroller. What is shorter than that is not seen. */
    uint32_t late_us;

    bool (*driver)(void *ctx);                     /* the level of the driver-enable pin */
    void (*set_clock)(void *ctx, uint32_t now_us); /* puts the counter of the clock there */
    /* The far end sends 11 22 33 (hex), the second one with this fault: FATHOM_RX_PARITY or _FRAMING. False: it
     * cannot. */
    bool (*damage)(void *ctx, uint8_t mark);

    void (*report)(void *ctx, const fathom_finding_t *finding); /* once for each item, in turn */
    void *ctx;
} fathom_conformance_t;

enum { FATHOM_CONFORMANCE_ITEMS = 26 };

/* Returns how many of the items are not kept. */
unsigned fathom_conformance_run(const fathom_conformance_t *bench);

/* "kept", "NOT KEPT", "not seen". */
const char *fathom_verdict_name(fathom_verdict_t verdict);

#ifdef __cplusplus
}
#endif

#endif
