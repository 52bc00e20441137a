/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_SIM_A05_H
#define FATHOM_SIM_A05_H

#include <stdbool.h>
#include <stdint.h>

#include "device.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * A05, four ultrasonic probes, 9600 8N1.
 *
 * Automatic: FF 1H 1L 2H 2L 3H 3L 4H 4L SUM every 300 ms (A05 1; the datasheet prints no period). The first
 * Modbus command to its address or to 0xFF ends that until power-off (A05 1(1)). The level of its RX pin
 * when power came chooses real-time or processed values for them; all other ways to ask give real-time ones.
 * Modbus (A05 3): function 03 of
 *   0x0106..0x0109 probes 1..4 and the same at 0x0010..0x0013, 1..4 in a read but not past the last; about
 *   100 ms a probe (all are measured at the moment of the response)
 *   0x0200 address, by itself
 * and function 06 of 0x0200, 0x00..0xFE: echoed from the old address, obeyed at once. Everything else is
 * silence: the datasheet knows no exceptions. 0xFF is obeyed and not answered. The address is kept without
 * power, however it was set; each time wears the flash (counters.flash_writes).
 * 55 AA (A05 2), 01..FE as address: 01 all probes, 10..13 one, measured at the moment of the response; 03 sets
 * the address, which is the only one in it, so that every unit obeys that hears it, also when what it hears
 * is another unit's response, which has the same bytes: several units may then respond to each other for ever.
 * 0xFF is obeyed, and answered from its own address (whether it is, is not in the datasheet). Silence: 00 or
 * FF as a new address, another command, another length, a wrong sum. A frame ends with t3.5 of silence.
 * Relay (A05 4): measures all probes every 300 ms (the datasheet prints no period) and hears nothing. The relay
 * closes when one is nearer than the threshold, opens when all are farther, and does not move again for 1 s. Its
 * contact is at the host's TX pin of the device (pin.h), pulled up: low is conducting.
 */
typedef enum {
    FATHOM_SIM_A05_AUTO = 1,   /* UART: automatic, then Modbus (A05 1) */
    FATHOM_SIM_A05_MODBUS = 2, /* RS-485 (A05 3) */
    FATHOM_SIM_A05_DYP = 3,    /* RS-485, 55 AA, and "Modbus at the same time" (A05 2(2)) */
    FATHOM_SIM_A05_RELAY = 4   /* a contact (A05 4) */
} fathom_sim_a05_mode_t;

/* Zero means the default. Copied by init; what the scene and the faults point at stays the caller's. */
typedef struct {
    uint8_t address;        /* Modbus address; default 1 */
    bool address_zero;      /* its address is 0, and it answers there; `address` means nothing */
    uint8_t mode;           /* fathom_sim_a05_mode_t; must be given */
    bool exceptions;        /* responses 01, 02 or 03 where the default is silence */
    bool answers_broadcast; /* answers 0xFF in Modbus, from its own address */
    /* acknowledges a new address from itself; default: from the old. In 55 AA it does so anyway (A05 2(3)5) */
    bool answers_from_new;
    /* RX is low in the first second after power-on (A05 1(1)), also where neither its pin (pin.h) nor a break of the
     * host holds it */
    bool real_time;
    bool dyp_silent_broadcast;         /* obeys 0xFF in 55 AA, but does not answer it */
    uint32_t seed;                     /* of the spread of the response times; any */
    fathom_sim_scene_t scene;          /* probes 1..4; no target when empty */
    fathom_sim_scene_t processed;      /* their processed values; as `scene` when empty */
    const fathom_sim_faults_t *faults; /* NULL: none */
    /* of automatic frames, from start to start, and of a relay's measurements; default 300 ms */
    uint32_t period_us;
    uint32_t start_us; /* from power-on, silent and deaf; default none */
    /* automatic frames still come for so long after the first command; default 150 ms; 1: none that has not begun */
    uint32_t linger_us;
    uint32_t probe_us;     /* longest time a probe of a read takes; default 100 ms (A05 3(3)) */
    uint32_t settings_us;  /* register 0x0200, and 55 AA 03; 20 ms */
    uint32_t all_us;       /* 55 AA 01, longest, at least 10 ms; it is up to 10 ms less; 210 ms */
    uint32_t one_us;       /* 55 AA 10..13; 75 ms */
    uint32_t hold_us;      /* relay: it does not move again before; default 1 s (A05 4(1)) */
    uint16_t threshold_mm; /* relay: as it was taught on the board; default 1000 (A05 4(2)) */
    uint8_t probes;        /* relay: bit probe - 1, fitted; default all */
    uint8_t bounces; /* relay: edges too many when it moves, 0.7 ms apart; even, up to 200; default none */
    bool normally_closed; /* relay: which contact is wired */
} fathom_sim_a05_config_t;

typedef struct {
    fathom_sim_device_t device; /* for fathom_sim_attach; device.counters */
    uint32_t probe_us;
    uint32_t settings_us;
    uint32_t all_us;
    uint32_t one_us;
    bool exceptions;
    bool real_time; /* the level; the caller may change it, for the next power-on */
    bool selected;  /* real-time, since power-on */

    /* a relay's */
    uint32_t every_us;   /* measurements */
    uint32_t measure_us; /* the next one */
    uint32_t hold_us;
    uint32_t moved_us; /* with is_young: less than hold_us ago */
    uint16_t threshold_mm;
    uint8_t probes;
    uint8_t bounces;
    uint8_t bounces_left;
    bool normally_closed;
    bool is_closed;
    bool is_young;
} fathom_sim_a05_t;

void fathom_sim_a05_init(fathom_sim_a05_t *a05, const fathom_sim_a05_config_t *config);

#ifdef __cplusplus
}
#endif

#endif
