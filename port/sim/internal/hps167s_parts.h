/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_SIM_HPS167S_PARTS_H
#define FATHOM_SIM_HPS167S_PARTS_H

#include "../hps167s.h"
#include "values.h"

/* hps167s.c reads and measures, and uses hps167s_settings.c, which changes and keeps. */

enum { FATHOM_SIM_HPS167S_RESET = 0x0009 }; /* #6 */
enum { FATHOM_SIM_HPS167S_UNIT = 1, FATHOM_SIM_HPS167S_BAUD_CODE = 1, FATHOM_SIM_HPS167S_RECONNECT_MS = 180 };

/* The device is the first member. */
static inline fathom_sim_hps167s_t *fathom_sim_hps167s_of(fathom_sim_device_t *device)
{
    return (fathom_sim_hps167s_t *)(void *)device;
}

/* The rate of baud_code acts. */
void fathom_sim_hps167s_set_rate(fathom_sim_hps167s_t *hps);

/* #6 */
void fathom_sim_hps167s_reset(fathom_sim_hps167s_t *hps);

/* #7 to #14, #15; message->exception has what is wrong with them, and nothing has changed then. */
void fathom_sim_hps167s_write(fathom_sim_hps167s_t *hps, fathom_modbus_message_t *message);
void fathom_sim_hps167s_write_many(fathom_sim_hps167s_t *hps, fathom_modbus_message_t *message);

/* LOST lasts so long from now on. */
void fathom_sim_hps167s_wait_for_data(fathom_sim_hps167s_t *hps, uint32_t now_us);

/* The four registers of #5: a distance, or FATHOM_SIM_NO_TARGET and so on. optics: NULL: the datasheet's example. */
void fathom_sim_hps167s_put(uint16_t *values, int32_t distance, const fathom_sim_optics_t *optics);

/* The model's. */
void fathom_sim_hps167s_power_on(fathom_sim_device_t *device, uint32_t now_us);

#endif
