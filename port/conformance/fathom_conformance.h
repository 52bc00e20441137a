/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_CONFORMANCE_H
#define FATHOM_CONFORMANCE_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/hal.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief Checks whether a HAL keeps the clauses of fathom/hal.h.
 *
 * Link the C files of this folder with your HAL, except host.c, which is a program for Linux. Join TX and RX; an RS-485
 * transceiver receives what it sends if its receiver stays enabled. Then call fathom_conformance_run() and read its
 * reports. The kit waits, a few seconds in all. It allocates no memory, prints nothing, and needs 4 KiB of stack.
 * Nothing else may use the UART meanwhile.
 *
 * @code
 * static void report(void *ctx, const fathom_finding_t *finding)
 * {
 *     print(finding->name, fathom_verdict_name(finding->verdict), finding->figure, finding->of);
 * }
 *
 * const fathom_conformance_t bench = {.uart = &uart, .clock = &clock, .line = {9600, FATHOM_PARITY_NONE, 1},
 *                                     .other = {19200, FATHOM_PARITY_NONE, 1}, .longest = 8, .report = report};
 * return fathom_conformance_run(&bench) == 0;
 * @endcode
 *
 * The kit can see that bytes are lost, early, late, truncated or out of order, and that bytes that waited in the port
 * look new. A loop-back has the same rate and the same parity at both ends. It therefore cannot show that the rate is
 * right, nor what wrong parity of another device does. For these use `damage`, a sensor, or an oscilloscope.
 */

/** @brief The result of one item. */
typedef enum {
    FATHOM_KEPT = 1,     /**< The HAL keeps the clause. */
    FATHOM_NOT_KEPT = 2, /**< The HAL does not keep the clause. */
    FATHOM_NOT_SEEN =
        3 /**< The item could not be checked: this wire or this port does not show it, or another clause
                            is not kept. */
} fathom_verdict_t;

/** @brief The report of one item. Its texts are constant. */
typedef struct {
    /** @brief Name of the item, such as "sent_not_early". */
    const char *name;
    /** @brief The clause of hal.h, in its words or shorter. */
    const char *clause;
    /** @brief The result. */
    fathom_verdict_t verdict;
    /** @brief A figure that belongs to the result. */
    uint32_t figure;
    /** @brief What `figure` counts, such as "us after write". */
    const char *of;
} fathom_finding_t;

/** @brief What is checked, and how. If an optional member is NULL or 0, the kit does not check the items that need it.
 * */
typedef struct {
    /** @brief The UART. */
    const fathom_uart_t *uart;
    /** @brief The clock. */
    const fathom_clock_t *clock;
    /** @brief The line settings that are in force. The kit restores them. */
    fathom_line_settings_t line;
    /** @brief Optional: other settings that the port can reach, at least 20 % faster or slower. `baud` 0: none. */
    fathom_line_settings_t other;
    /** @brief Largest number of bytes in one write, 8 to 255. */
    uint8_t longest;
    /** @brief The flags FATHOM_RX_... that the port reports. */
    uint8_t marks;

    /** @brief How late the port may return a byte, in microseconds: 20000 for a USB adapter, 0 on a microcontroller. An
     * operating system and a simulator need a value too. The kit does not see shorter times. */
    uint32_t late_us;

    /** @brief Optional: returns the level of the driver-enable pin. */
    bool (*driver)(void *ctx);
    /** @brief Optional: sets the counter of the clock to `now_us`. */
    void (*set_clock)(void *ctx, uint32_t now_us);
    /** @brief Optional: makes the far end send the bytes 11 22 33 (hex), the second one with the fault `mark`:
     * FATHOM_RX_PARITY or FATHOM_RX_FRAMING. Returns false if the far end cannot do this. */
    bool (*damage)(void *ctx, uint8_t mark);

    /** @brief Called once for each item, in order. `finding` is valid during the call. */
    void (*report)(void *ctx, const fathom_finding_t *finding);
    /** @brief Passed to these functions. */
    void *ctx;
} fathom_conformance_t;

/** @brief Constants of the kit. */
enum {
    FATHOM_CONFORMANCE_ITEMS = 26 /**< Number of items. */
};

/**
 * @brief Checks all items and reports each.
 *
 * @param bench  What is checked. Must stay valid during the call.
 * @return Number of items that are not kept.
 */
unsigned fathom_conformance_run(const fathom_conformance_t *bench);

/** @brief Returns the name of a result: "kept", "NOT KEPT" or "not seen". */
const char *fathom_verdict_name(fathom_verdict_t verdict);

#ifdef __cplusplus
}
#endif

#endif
