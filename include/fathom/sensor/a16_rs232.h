/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_A16_RS232_H
#define FATHOM_A16_RS232_H

#include <stdint.h>

#include "fathom/sensor/a16_auto.h"
#include "fathom/sensor/a16_settings.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief Returns an A16 with RS232 output (A16 5) from Modbus to automatic output.
 *
 * The module sends frames without a request until its first Modbus request. From then on it only responds. A power
 * cycle, or 1 in register 0x0202, starts the frames again; the register is not kept over power-off (A16 6(3)). Two
 * drivers on one line read the module: a16_auto.h and a16_modbus.h. The first poll of the second driver stops the
 * automatic output. This header is the way back; it reads no distance by Modbus and never waits. include/COST.md has
 * the size of all three in the row `a16_rs232`.
 *
 * @code
 * fathom_a16_rs232_init(&rs232, &modbus, &automatic);       // both drivers are initialised, on one line
 * do status = fathom_a16_rs232_return_to_automatic(&rs232, &sample);
 * while (status == FATHOM_PENDING);
 * @endcode
 *
 * A response to a Modbus request may arrive among frames. The line passes those frames to the automatic driver.
 */

/**
 * @brief Default of fathom_a16_rs232_t::return_us: 10 s, in microseconds.
 *
 * The datasheet prints no period of the frames. The processed value settles within 2.5 to 7.5 s (A16 2(2)), and the
 * first frame may be that late.
 */
#define FATHOM_A16_RS232_DEFAULT_RETURN_US 10000000uL

/** @brief The state of the return, in the caller's memory. Call fathom_a16_rs232_init() before use. */
typedef struct {
    /** @brief The Modbus driver. Set by fathom_a16_rs232_init(). */
    fathom_a16_modbus_t *modbus;

    /** @brief The automatic driver. Set by fathom_a16_rs232_init(). */
    fathom_a16_auto_t *automatic;

    /**
     * @brief Longest time from the write to the first frame, in microseconds. The caller may change it after
     * fathom_a16_rs232_init(), which sets 10 s.
     */
    uint32_t return_us;

    /* private */
    uint32_t since_us;  /* the clock at the acknowledgement, later by each pause that does not count */
    uint32_t polled_us; /* the clock at the last call */
    bool is_listening;  /* the write is done, and the first frame is awaited */
} fathom_a16_rs232_t;

/**
 * @brief Initialises the state. Sends nothing.
 *
 * @param rs232      The state.
 * @param modbus     The Modbus driver, initialised. Must stay valid as long as `rs232`.
 * @param automatic  The automatic driver, initialised on the same line. Must stay valid as long as `rs232`.
 */
void fathom_a16_rs232_init(fathom_a16_rs232_t *rs232, fathom_a16_modbus_t *modbus,
                           fathom_a16_auto_t *automatic);

/**
 * @brief Starts the automatic output again: reads the address, writes 1 to register 0x0202, and waits for a frame.
 *
 * Call this function until its result differs from FATHOM_PENDING. In the meantime poll neither driver. The frame is
 * the proof, because a read would stop the output again. A lost or damaged acknowledgement is therefore no error.
 *
 * A program may pause between two calls. If the pause is longer than the `stale_us` of the automatic driver and
 * FATHOM_LINE_LATE_US together, the line drops the bytes of the pause. Only `stale_us` of this pause then counts
 * against `return_us`.
 *
 * @param rs232   The state.
 * @param sample  Written with FATHOM_OK only: the first reading of the automatic output.
 * @retval FATHOM_OK               The automatic output is back. From now on poll the automatic driver only.
 * @retval FATHOM_PENDING          The return is not finished.
 * @retval FATHOM_ERR_UNCONFIRMED  The register was written, and no frame arrived within `return_us`.
 * @retval FATHOM_ERR_EXCEPTION    The unit refused the write. It is probably no RS232 variant.
 * @retval FATHOM_ERR_BUSY         Another command is not finished.
 * @retval FATHOM_ERR_PORT         The port is broken.
 * @return All other errors: as fathom_a16_modbus_set_operating_mode(). Nothing was written.
 */
fathom_status_t fathom_a16_rs232_return_to_automatic(fathom_a16_rs232_t *rs232, fathom_sample_t *sample);

/** @brief Cancels the return. The register may be written or not. The next return starts from the beginning. */
void fathom_a16_rs232_cancel(fathom_a16_rs232_t *rs232);

/**
 * @brief Returns the time in microseconds until fathom_a16_rs232_return_to_automatic() must be called again if no byte
 * arrives.
 */
uint32_t fathom_a16_rs232_due_us(const fathom_a16_rs232_t *rs232);

#ifdef __cplusplus
}
#endif

#endif
