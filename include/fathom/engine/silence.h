/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_SILENCE_H
#define FATHOM_SILENCE_H

#include <stdint.h>

#include "fathom/hal.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief The silence between two frames of Modbus RTU, from the settings of a line.
 *
 * The bus of each port calls fathom_silence_us(). A program that names the parts of a line (line.h) uses
 * FATHOM_T3_5_US(), which costs no code.
 */

/**
 * @brief Returns the silence that ends a frame (t3.5), in microseconds.
 *
 * The silence is 3.5 characters up to 19200 baud and 1750 us above (MODBUS over Serial Line V1.02, 2.5.1.1; HPS-167S
 * 2.2.3). The result is a constant expression if both arguments are constants. Below 588 baud (11 bits a character) the
 * silence does not fit into 16 bits: the result is 65535, and fathom_line_init() refuses it.
 *
 * @param baud  Baud rate in bits per second.
 * @param bits  Bits of one character, including start, parity and stop bits: 10 for 8N1; 11 for 8E1, 8O1 and 8N2.
 */
#define FATHOM_T3_5_US(baud, bits)                                                                           \
    ((uint16_t)(((baud) > 19200uL) ? 1750uL                                                                  \
                : (((((bits)*3500000uL) + ((baud)-1uL)) / (baud)) > 65535uL)                                 \
                    ? 65535uL                                                                                \
                    : ((((bits)*3500000uL) + ((baud)-1uL)) / (baud))))

/**
 * @brief Returns the silence before a request on a line with these settings, in microseconds: t3.5 of 11 bits.
 *
 * The result is that of 19200 baud for all faster rates too, because an HPS-167S that was set to such a rate returns to
 * 19200 baud by its factory reset (#6), and the silence has to be right for the slowest rate that is used on the line. For
 * 9600 to 19199 baud it is that of 9600. No sensor has a slower rate: the result is 65535, and fathom_line_init() refuses
 * it. The function does not divide, so it costs a few bytes of flash.
 *
 * @param settings  The settings.
 */
static inline uint16_t fathom_silence_us(const fathom_line_settings_t *settings)
{
    if (settings->baud >= 19200u) return FATHOM_T3_5_US(19200u, 11u);
    return (settings->baud >= 9600u) ? FATHOM_T3_5_US(9600u, 11u) : UINT16_MAX;
}

#ifdef __cplusplus
}
#endif

#endif
