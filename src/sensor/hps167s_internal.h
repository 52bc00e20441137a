/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_HPS167S_INTERNAL_H
#define FATHOM_HPS167S_INTERNAL_H

#include "../common.h"
#include "fathom/sensor/hps167s.h"

/* What the source files of the HPS-167S's driver share. No other file includes this one. */

/* Copies 4 registers. Without volatile, compilers replace the loop by a call of memcpy(), which costs more flash. */
static inline void copy_4(volatile uint16_t *to, const uint16_t *from)
{
    for (uint8_t i = 0; i != 4u; i++) to[i] = from[i];
}

/* Reports the end of a request to the search for the baud rate of the sensor (hps167s_settings.c). */
static inline void fathom_hps167s_follow(fathom_hps167s_t *sensor, fathom_status_t status)
{
    if ((status != FATHOM_PENDING) && (sensor->follow != NULL)) sensor->follow(sensor, status);
}

/* Returns the id of a command: its address with FATHOM_MODBUS_COMMAND. The id of the repeated #5 is its address. */
static inline uint8_t fathom_hps167s_id(uint8_t command)
{
    return (uint8_t)(FATHOM_MODBUS_COMMAND | command);
}

/* Reads the `count` registers of a command into sensor->values. Call fathom_modbus_unit_poll() before this function, and
 * both functions until the result differs from FATHOM_PENDING. */
fathom_status_t fathom_hps167s_ask_once(fathom_hps167s_t *sensor, uint8_t command, uint8_t count);

/* Reads #2 until it is believed; it is then in sensor->values. Call fathom_modbus_unit_poll() before. */
fathom_status_t fathom_hps167s_read_configuration(fathom_hps167s_t *sensor);

#endif
