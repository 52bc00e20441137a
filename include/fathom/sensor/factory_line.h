/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_FACTORY_LINE_H
#define FATHOM_FACTORY_LINE_H

#include "fathom/hal.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief The line settings with which each sensor leaves the factory.
 *
 * A program passes them to the port of its line, or names them as `line_settings` of a sensor whose line has sensors with
 * other settings. A constant that a program does not name is not linked, if the linker drops unused data.
 *
 * @code
 * const fathom_modbus_config_t modbus = {.line_settings = &fathom_hps167s_factory_line};
 * @endcode
 */

/** @brief HPS-167S: 19200 baud, even parity, 1 stop bit (HPS-167S 2.3). A command sets the rate (#9). */
extern const fathom_line_settings_t fathom_hps167s_factory_line;

/** @brief HPS-167 and HPS-166 with a UART: 115200 baud, no parity, 1 stop bit (hps167_uart.h says how certain that is). */
extern const fathom_line_settings_t fathom_hps167_factory_line;

/** @brief A16: 9600 baud, no parity, 1 stop bit, in each mode with a UART (A16 2(2), 4(3), 5(2)). They are fixed. */
extern const fathom_line_settings_t fathom_a16_factory_line;

/**
 * @brief A05: 9600 baud, no parity, 1 stop bit, in each mode with a UART (A05 1(1), 2(1)). They are fixed.
 *
 * The table of the UART mode leaves the parity open (A05 1(1)); the one of RS-485 has none (A05 2(1)).
 */
extern const fathom_line_settings_t fathom_a05_factory_line;

#ifdef __cplusplus
}
#endif

#endif
