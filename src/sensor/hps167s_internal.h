/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_HPS167S_INTERNAL_H
#define FATHOM_HPS167S_INTERNAL_H

#include "../common.h"
#include "fathom/sensor/hps167s.h"

/* What the parts of the HPS-167S's driver share. For no other source. */

/* volatile: or compilers make it a call of memcpy, which costs more. */
static inline void copy_4(volatile uint16_t *to, const uint16_t *from)
{
    for (uint8_t i = 0; i != 4u; i++) to[i] = from[i];
}

/* The id of a command is its address; with FATHOM_MODBUS_COMMAND, but for #5, which is repeated. */
static inline uint8_t fathom_hps167s_id(uint8_t command)
{
    return (uint8_t)(FATHOM_MODBUS_COMMAND | command);
}

/* Reads the `count` registers of a command as fathom_modbus_unit_ask does, after fathom_modbus_unit_poll: those of #5
 * into sensor->response, others into sensor->values. */
fathom_status_t fathom_hps167s_ask(fathom_hps167s_t *sensor, uint8_t id, uint8_t count);

/* A command that is sent once. */
static inline fathom_status_t fathom_hps167s_ask_once(fathom_hps167s_t *sensor, uint8_t command,
                                                      uint8_t count)
{
    return fathom_hps167s_ask(sensor, fathom_hps167s_id(command), count);
}

/* #2 until it is believed; then it is in sensor->values. After fathom_modbus_unit_poll, as well. */
fathom_status_t fathom_hps167s_read_configuration(fathom_hps167s_t *sensor);

#endif
