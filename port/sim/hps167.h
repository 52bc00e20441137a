/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_SIM_HPS167_H
#define FATHOM_SIM_HPS167_H

#include "hps167s.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * HPS-167 or HPS-166 with a UART, 115200 8N1, a wire each way. No datasheet was at hand: what it does is what public
 * programs for it expect, and what they leave open is as in the HPS-167S.
 *   22   one measurement, a period after the request
 *   24   a measurement every period, until 30 or power-off; the first one a period after the request
 *   30   with 01: ends that, and is acknowledged
 *   3F   with 01: the temperature of the analog front end
 * Any other request with a right CRC is silence, as is one with a wrong CRC; 2E is among them, because the one response
 * that is printed has a CRC that does not fit. A period after its start it sends "Hypersen" once.
 * The three bytes before the distance, whose meaning is not certain, are drawn anew for each frame, or fixed.
 */

/* Zero means the default. Copied by init; what the scene, the faults, the optics and `unknown` point at stays the
 * caller's and may be changed. */
typedef struct {
    uint32_t seed;                     /* of the spread of the response times, and of the three bytes; any */
    fathom_sim_scene_t scene;          /* no target when empty: 65530, as the HPS-167S */
    const fathom_sim_faults_t *faults; /* NULL: none */
    const fathom_sim_optics_t *optics; /* NULL: DC B2 07, 01, 00 00, the HPS-167S's example */
    const uint8_t *unknown;            /* the three bytes; NULL: drawn */
    uint16_t temperature;              /* as it is sent; default 2500 */
    uint32_t period_us;                /* of its measuring; default 18519 us, 54 Hz */
    uint32_t reply_us;                 /* longest from the end of 30 and 3F to the response; default 2.5 ms */
    uint32_t start_us;                 /* from power-on, silent and deaf; default none */
    bool is_silent;                    /* it sends no text when power comes */
} fathom_sim_hps167_config_t;

typedef struct {
    fathom_sim_device_t device; /* for fathom_sim_attach; device.counters */
    const fathom_sim_optics_t *optics;
    const uint8_t *unknown;
    uint32_t measure_us;
    uint32_t reply_us;
    uint16_t temperature; /* the caller may change it */
    bool is_silent;
    bool is_sending;  /* measurements, by itself */
    bool is_greeting; /* the next frame that it sends by itself is the text */
} fathom_sim_hps167_t;

void fathom_sim_hps167_init(fathom_sim_hps167_t *hps, const fathom_sim_hps167_config_t *config);

#ifdef __cplusplus
}
#endif

#endif
