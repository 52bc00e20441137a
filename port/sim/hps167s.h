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
 * own function and length (HPS-167S 3):
 *   03   #1 0x0001 x3, #2 0x0002 x4, #3 0x0003 x11, #4 0x0004 x1, #5 0x0008 x4, #6 0x0009 x1
 *   06   #7 0x000A, #8 0x0010, #9 0x0011, #10 0x0012, #11 0x0013, #12 0x0014, #13 0x0015, #14 0x0016
 *   10   #15 0x0020 x2, the high word first
 * Another length or address: exception 02; a function that is none of 03, 06, 10: exception 01. A silence of
 * more than t1.5 inside a request drops it (2.2.3). Address 0 is obeyed and not answered (2.2.1).
 *
 * A value that a command does not have: exception 03, and nothing changes. "The corresponding address or
 * value does not exist in the slave device" (below table 39); table 39 itself says that 03 is not about
 * values, so it is an option. Refused are: #7 over 255 (#2 has a byte for it), #8 outside 1..32, #10, #11
 * and #13 other than 00 and FF, #15 no multiple of 18. Not refused: #9 outside 1..4, which means 19200 and is
 * code 1 afterwards ("the others are all 19200bps"), any #12 and any #14 (both signed).
 *
 * When they act, and what is kept without power:
 *   #7 warm-up          from the next power-on   kept
 *   #8 address          at once                  kept
 *   #9 rate             an option                kept (the text does not say so, but #2 has it)
 *   #10, #11            from the next power-on   kept; #2 says what was set, not what acts
 *   #12 offset          at once                  kept
 *   #13 00 or FF        at once: what #12 and #14 have set, or offset 0 and filter 0; kept which of them
 *   #14 filter          at once                  kept (the text does not say so; as user settings of #13)
 *   #15 reconnect time  at once                  kept
 * Each write that is obeyed wears the flash, also one that changes nothing (counters.flash_writes).
 *
 * It measures inside, 54 times a second, and sends nothing without a request (2.2.1). A measurement is handed out
 * once: so the response to #5 comes in 2.5 ms when there is one, and not less than a period after the last.
 * Where it sends by itself (unasked_us), each frame is a measurement that is handed out, t3.5 from others.
 *
 * #6, the factory reset of the interface, is carried out and counted (counters.resets) for exactly 0x0009 x1
 * and nothing else; with another length or function it is refused and counted (counters.resets_refused). It
 * leaves #12 and #14 alone, which are the sensor's.
 */

/* What #5 is met with during the warm-up: "the sensor will not output measurement data" (#7), which leaves
 * these. All other commands are answered. */
typedef enum {
    FATHOM_SIM_HPS167S_SILENCE = 0,
    FATHOM_SIM_HPS167S_EXCEPTION = 1, /* 04 */
    FATHOM_SIM_HPS167S_ABNORMAL = 2   /* the abnormal packet of #5, also unasked */
} fathom_sim_hps167s_warm_up_t;

/* What #5 has besides the distance, as it goes over the wire. */
typedef struct {
    uint16_t magnitude; /* of the reflected light: (magnitude << exponent) / 10000 */
    uint8_t exponent;
    uint8_t ambient;
    uint16_t precision;
} fathom_sim_optics_t;

/* Zero means the default. Copied by init; what the scene, the faults, the optics and the details point at
 * stays the caller's and may be changed. */
typedef struct {
    uint8_t address;      /* 1..32; default 1 */
    uint8_t baud_code;    /* as #9 has it: 1 = 19200 (default), 2 = 57600, 3, 4 = 230400 */
    uint8_t warm_up_s;    /* as #7 has it; default none (the factory's is 5); #2 reports it */
    uint8_t warm_up_says; /* fathom_sim_hps167s_warm_up_t; default silence */
    uint8_t wrong_length; /* exception to a known address with another length: default 2, or 3 */
    uint8_t wrong_value;  /* exception to a value that a command does not have: default 3, or any */
    bool no_termination;  /* #2 reports 00 (FF) */
    /* #2 reports 00 (FF); and each #5 takes a whole period from its request on, and nothing is sent unasked */
    bool no_auto_output;
    /* #9 acts from the next power-on; default: behind its acknowledgement, which leaves at the old rate */
    bool baud_at_power_on;
    bool offset_adds;      /* #12 is added to the offset that is there; default: it replaces that */
    bool no_baud_code;     /* #2 reports 00 for its rate, whatever that is: table 12 has no encoding */
    bool answers_from_new; /* #8 and #6 are answered from the new address; default: the old one */
    int16_t temperature_f; /* #4; default 77 degrees Fahrenheit */
    uint32_t reconnect_ms; /* #15, #2; default 180; any, also what #15 could not set */
    /* sends frames of the shape of #5 by itself, so often, when #10 was on at power-on ("continuous output", #15);
     * default never (2.2.1) */
    uint32_t unasked_us;
    uint32_t seed;                     /* of the spread of the response times; any */
    fathom_sim_scene_t scene;          /* no target when empty */
    const fathom_sim_faults_t *faults; /* NULL: none */
    const fathom_sim_optics_t *optics; /* NULL: DC B2 07, 01, 00 00 as in the datasheet's example of #5 */
    const uint8_t *details;            /* 22 bytes of #3; NULL: those of the datasheet's example */
    uint8_t number;                    /* added to the last byte of the UUID, so that units differ */
    const uint8_t *version;            /* 6 bytes of #1; NULL: 2020-09-27, 2.1.0 (no example is printed) */
    uint32_t period_us;                /* of its measuring; default 18519 us, 54 Hz; 166667 is 6 Hz */
    uint32_t reply_us;                 /* longest from the end of a request to the response; 2.5 ms */
} fathom_sim_hps167s_config_t;

/* Of the sensor behind the interface. */
typedef struct {
    int16_t offset_mm; /* #12: added to distances, 0 and 65529 are the ends */
    int16_t filter;    /* #14: here it does nothing */
} fathom_sim_hps167s_sensor_t;

typedef struct {
    fathom_sim_device_t device; /* for fathom_sim_attach; device.counters */
    const fathom_sim_optics_t *optics;
    const uint8_t *details;
    const uint8_t *version;
    uint32_t reconnect_ms;
    uint32_t unasked_us;
    uint32_t period_us;
    uint32_t reply_us;
    fathom_sim_hps167s_sensor_t sensor; /* what acts */
    fathom_sim_hps167s_sensor_t user;   /* what #13 = 00 brings back */
    int16_t temperature_f;              /* the caller may change it */
    uint8_t number;
    uint8_t warm_up_s;
    uint8_t warm_up_says;
    uint8_t wrong_length;
    uint8_t wrong_value;
    uint8_t baud_code;
    bool baud_at_power_on;
    bool offset_adds;
    bool no_baud_code;
    bool termination;
    bool auto_output;
    bool terminated; /* in truth, since power-on */
    bool measuring;  /* by itself, since power-on */
    bool lost;       /* no data from the sensor inside */
} fathom_sim_hps167s_t;

void fathom_sim_hps167s_init(fathom_sim_hps167s_t *hps, const fathom_sim_hps167s_config_t *config);

/*
 * The interface gets no more data from the sensor behind it (lost), or does again. For a device that hangs
 * on a line which has been run until now_us. Until the reconnect time of #15 is over there is nothing to
 * hand out: #5 waits so long, nothing is sent unasked; from then on both are the abnormal packet. Without
 * continuous measuring (#10) the abnormal packet comes as a measurement would. Power does not mend it, and
 * the time begins anew. Of a reconnect time of more than 30 minutes, 30 minutes count.
 */
void fathom_sim_hps167s_lose(fathom_sim_hps167s_t *hps, bool lost, uint32_t now_us);

#ifdef __cplusplus
}
#endif

#endif
