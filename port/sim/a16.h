/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_SIM_A16_H
#define FATHOM_SIM_A16_H

#include <stdbool.h>
#include <stdint.h>

#include "device.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * A16, one ultrasonic probe, 9600 8N1.
 *
 * Automatic: FF H L SUM every 100 ms (A16 2, 5; the datasheet prints no period). The first Modbus command
 * to its address or to 0xFF ends that until power-off or 0x0202 = 1 (A16 5(0), 6(3)).
 * Modbus (A16 6): function 03, one register a read, function 06:
 *   0x0100 processed distance    03; measured at the moment of the response
 *   0x0101 real-time distance    03; the same
 *   0x0200 address               03, 06 of 0x00..0xFE: obeyed at once
 *   0x0202 operating mode        06 of 0 (as it is then: controlled) and 1 (automatic again, the first frame a
 *                                period after the command); not kept. RS-485 has no automatic mode and
 *                                acknowledges both
 *   0x0205 switch polarity       03, 06 of 0 and 1
 *   0x0206 switch threshold      03, 06 of any number (no range is printed); mm
 *   0x0207 automatic data type   03, 06 of 0 (processed) and 1 (real-time): from the next frame, RS-232 only
 * Writes are echoed, from the old address. 0x0200, 0x0205, 0x0206 and 0x0207 are kept without power; each
 * write of them wears the flash (counters.flash_writes). 0x0205 to 0x0207 are there in every mode with Modbus,
 * though they act in one only. Everything else is silence: the datasheet knows no exceptions. 0xFF is obeyed
 * and not answered.
 * Switch (A16 4): measures every 500 ms; 3 in a row nearer than the threshold (0x0206) make its TX pin high, 5
 * farther low, or the other way round (0x0205 = 0); a distance that equals it ends a row, and low is what TX has
 * before the first decision. RX hears Modbus, and 06 of these two registers is obeyed at once; the responses leave by
 * TX. Where that rests low, the host's UART gets a break whenever it falls and before each response: 00 with
 * FATHOM_RX_FRAMING. The line is full-duplex; pin.h has the host's end of the pin.
 *
 * PWM and controlled: a falling edge at the RX pin (pin.h, or a break or byte of the host) begins a measurement, if
 * the cycle of the one before is over; else it is ignored and counted as unserved. PWM (A16 1): TX rests low and is
 * high once for the time of flight, never for less than 3 ms. Controlled (A16 3): one FF H L SUM, 90..110 ms after
 * the edge.
 * UART: RX low when a frame is sent makes it that of the real-time value, high or open of the processed one (A16 2).
 */
typedef enum {
    FATHOM_SIM_A16_AUTO = 1,   /* RS-232: automatic, then Modbus (A16 5) */
    FATHOM_SIM_A16_MODBUS = 2, /* RS-485: Modbus only (A16 5) */
    FATHOM_SIM_A16_UART = 3,   /* automatic for ever, hears nothing (A16 2) */
    FATHOM_SIM_A16_SWITCH = 4, /* a level on TX, and Modbus (A16 4) */
    /* One pulse a trigger (A16 1), one frame a trigger (UART controlled, A16 3). */
    FATHOM_SIM_A16_PWM = 5,
    FATHOM_SIM_A16_CONTROLLED = 6
} fathom_sim_a16_mode_t;

/* Zero means the default. Copied by init; what the scene and the faults point at stays the caller's. */
typedef struct {
    uint8_t address;                   /* Modbus address; default 1 */
    bool address_zero;                 /* its address is 0, and it answers there; `address` means nothing */
    uint8_t mode;                      /* fathom_sim_a16_mode_t; must be given */
    bool exceptions;                   /* responses 01, 02 or 03 where the default is silence */
    bool answers_broadcast;            /* answers 0xFF, from its own address */
    bool answers_from_new;             /* a new address is acknowledged from itself; default: from the old */
    bool real_time;                    /* 0x0207 is 1; UART: RX is held low (A16 2(2)) */
    uint16_t threshold_mm;             /* register 0x0206; default 1000 (A16 4(2)) */
    uint32_t seed;                     /* of the spread of the response times; any */
    fathom_sim_scene_t scene;          /* probe 1; no target when empty */
    fathom_sim_scene_t processed;      /* the processed value; as `scene` when empty */
    const fathom_sim_faults_t *faults; /* NULL: none */
    /* of automatic frames, from start to start; default 100 ms. Of the measurements of a switch; default 500 ms */
    uint32_t period_us;
    uint32_t start_us; /* from power-on, silent and deaf; default none */
    /* automatic frames still come for so long after the first command; default 150 ms; 1: none that has not begun */
    uint32_t linger_us;
    uint32_t realtime_us;  /* longest from the end of a request to the response: 0x0101; 120 ms */
    uint32_t processed_us; /* 0x0100; 520 ms (neither is in the datasheet) */
    uint32_t settings_us;  /* the other registers; 20 ms */
    /* An edge not later than this after the one before is ignored; PWM 220 ms (A16 1(2)), controlled 120 ms (3(2)). */
    uint32_t cycle_us;
    uint32_t pulse_us; /* PWM: from the edge to the pulse; 110 ms (A16 1(3)) */
    /* PWM: width of the pulse without a target, and of what would be longer; 94 ms (A16 1(2)). */
    uint32_t no_target_us;
    /* In what relatives differ: the rate; default 9600. Controlled: the time from the trigger to the response, 90 to
     * 110 ms, and the byte that is the trigger, if has_byte, in place of an edge. */
    uint32_t baud;
    uint32_t least_us;
    uint32_t most_us;
    bool has_byte;
    uint8_t byte;
    bool has_temperature;   /* it has register 0x0102 ... */
    int16_t temperature_dc; /* ... with tenths of a degree Celsius; default 200 */
} fathom_sim_a16_config_t;

typedef struct {
    fathom_sim_device_t device; /* for fathom_sim_attach; device.counters */
    uint32_t realtime_us;
    uint32_t processed_us;
    uint32_t settings_us;
    uint32_t cycle_us;
    uint32_t pulse_us;
    uint32_t no_target_us;
    uint32_t least_us;
    uint32_t most_us;
    bool has_byte;
    uint8_t byte;
    bool has_temperature;
    int16_t temperature_dc;
    uint8_t mode;
    uint16_t threshold_mm;
    uint8_t polarity;  /* 0x0205; 1 from the factory */
    uint8_t data_type; /* 0x0207; 0 processed, also what automatic frames of the UART say */
    bool exceptions;

    /* a switch's */
    uint32_t every_us;   /* measurements */
    uint32_t measure_us; /* the next one */
    uint8_t nearer;      /* in a row */
    uint8_t farther;
    bool is_near; /* what it has decided */
} fathom_sim_a16_t;

void fathom_sim_a16_init(fathom_sim_a16_t *a16, const fathom_sim_a16_config_t *config);

#ifdef __cplusplus
}
#endif

#endif
