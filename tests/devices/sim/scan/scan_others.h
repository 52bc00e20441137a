/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_SCAN_OTHERS_H
#define FATHOM_TESTS_SCAN_OTHERS_H

#include "scan_rig.h"

/* Devices on the rig's line that are none of the three. One of each kind at a time: what they say is static. */

/* Responses reads in Modbus. */
typedef struct {
    uint16_t value;    /* in every register, ... */
    uint16_t version;  /* ... but from 0001 on, where an HPS-167S has its interface version (#1) */
    uint16_t address;  /* ... and in 0200 */
    uint16_t only[2];  /* not 0: the only registers that it answers */
    uint8_t exception; /* not 0: what it answers instead */
} stranger_t;

extern stranger_t stranger;
void begin_stranger(uint8_t unit, const fathom_line_settings_t *line);

/* Says the same bytes over and over, or (period_us 0) in response to whatever it hears. unit, of the device that is
 * returned, not 0: only to frames that begin with it. */
fathom_sim_device_t *begin_speaker(const fathom_line_settings_t *line, uint32_t period_us,
                                   const uint8_t *bytes, uint8_t length);

/* HPS-167S #5, the example's response; A16 6, the first example: it asks address 1 for 0100; and what is no
 * protocol. */
extern const uint8_t hps_response[13];
extern const uint8_t a16_request[8];
extern const uint8_t junk[6];

#endif
