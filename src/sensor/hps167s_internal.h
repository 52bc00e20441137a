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

/* Returns the id of a command: its address with FATHOM_MODBUS_COMMAND. The id of the repeated #5 is its address. */
static inline uint8_t fathom_hps167s_id(uint8_t command)
{
    return (uint8_t)(FATHOM_MODBUS_COMMAND | command);
}

/* Reads `count` registers as fathom_modbus_unit_ask() does. Call fathom_modbus_unit_poll() before. The registers of #5
 * go to sensor->measurement, all others to sensor->values. */
fathom_status_t fathom_hps167s_ask(fathom_hps167s_t *sensor, uint8_t id, uint8_t count);

/* The same for a command, which is sent once. */
static inline fathom_status_t fathom_hps167s_ask_once(fathom_hps167s_t *sensor, uint8_t command,
                                                      uint8_t count)
{
    return fathom_hps167s_ask(sensor, fathom_hps167s_id(command), count);
}

/* Reads #2 until it is believed; it is then in sensor->values. Call fathom_modbus_unit_poll() before. */
fathom_status_t fathom_hps167s_read_configuration(fathom_hps167s_t *sensor);

#endif
