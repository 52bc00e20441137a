/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_SIM_HPS167S_H
#define FATHOM_SIM_HPS167S_H

#include <stdbool.h>
#include <stdint.h>

#include "device.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * HPS-167S, infrared time of flight, RS-485, 19200 8E1. What looks like registers are commands, each with its
 * own length (HPS-167S 3):
 *   #1 0x0001 x3, #2 0x0002 x4, #3 0x0003 x11, #4 0x0004 x1, #5 0x0008 x4, #6 0x0009 x1 (function 03)
 * Another length or address: exception 02; a function that is none of 03, 06, 10: exception 01. A silence of
 * more than t1.5 inside a request drops it (2.2.3). Address 0 is obeyed and not answered (2.2.1).
 *
 * It measures inside, 54 times a second, and says nothing unless asked. A measurement is handed out once: so
 * the answer to #5 comes in 2.5 ms when there is one, and not less than a period after the last.
 *
 * #6, the factory reset, is carried out and counted (counters.resets) for exactly 0x0009 x1 and nothing
 * else; with another length it is refused and counted (counters.resets_refused).
 *
 * Not yet, silence: functions 06 and 10 (#7 to #15). Unasked frames neither.
 */

/* What #5 says besides the distance, as it goes over the wire. */
typedef struct {
    uint16_t magnitude; /* of the reflected light: (magnitude << exponent) / 10000 */
    uint8_t exponent;
    uint8_t ambient;
    uint16_t precision;
} fathom_sim_optics_t;

/* Zero means the default. Copied by init; what the scene, the faults, the optics and the details point at
 * stays the caller's and may be changed. */
typedef struct {
    uint8_t unit;                      /* 1..32; default 1 */
    uint8_t baud_code;                 /* as #9 has it: 1 = 19200 (default), 2 = 57600, 3, 4 = 230400 */
    uint8_t warm_up_s;                 /* after power-on #5 is met with silence for so long; default none
                                          (the factory's is 5); #2 reports it */
    uint8_t wrong_length;              /* exception to a known address with another length: default 2, or 3 */
    bool no_termination;               /* #2 reports 00 (FF) */
    bool no_auto_output;               /* #2 reports 00 (FF); and each #5 takes a whole period from when it
                                          was asked */
    int16_t temperature_f;             /* #4; default 77 degrees Fahrenheit */
    uint32_t reconnect_ms;             /* #2; default 180; a multiple of 18 */
    uint32_t seed;                     /* of the spread of the answer times; any */
    fathom_sim_scene_t scene;          /* no target when empty */
    const fathom_sim_faults_t *faults; /* NULL: none */
    const fathom_sim_optics_t *optics; /* NULL: DC B2 07, 01, 00 00 as in the datasheet's example of #5 */
    const uint8_t *details;            /* 22 bytes of #3; NULL: those of the datasheet's example */
    const uint8_t *version;            /* 6 bytes of #1; NULL: 2020-09-27, 2.1.0 (no example is printed) */
    uint32_t period_us;                /* of its measuring; default 18519 us, 54 Hz; 166667 is 6 Hz */
    uint32_t reply_us;                 /* longest from the end of a request to the answer; 2.5 ms */
} fathom_sim_hps167s_config_t;

typedef struct {
    fathom_sim_device_t device; /* for fathom_sim_attach; device.counters */
    const fathom_sim_optics_t *optics;
    const uint8_t *details;
    const uint8_t *version;
    uint32_t reconnect_ms;
    uint32_t period_us;
    uint32_t reply_us;
    int16_t temperature_f; /* the caller may change it */
    uint8_t warm_up_s;
    uint8_t wrong_length;
    uint8_t baud_code;
    bool termination;
    bool auto_output;
    bool measuring; /* by itself, since power-on */
} fathom_sim_hps167s_t;

void fathom_sim_hps167s_init(fathom_sim_hps167s_t *hps, const fathom_sim_hps167s_config_t *config);

#ifdef __cplusplus
}
#endif

#endif
