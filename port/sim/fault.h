/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_SIM_FAULT_H
#define FATHOM_SIM_FAULT_H

#include <stdbool.h>
#include <stdint.h>

#include "device.h"
#include "sim.h"
#include "uart.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * Faults on the way from a simulated sensor to its host: one kind or many together, by chance or at a given
 * frame, the same every time for the same seed.
 *
 *     fathom_sim_fault_t fault;
 *     fathom_sim_fault_init(&fault, 1);
 *     fathom_sim_fault_add(&fault, FATHOM_SIM_FAULT_FLIP_BIT, 50000, 0);            5 % of the frames
 *     fathom_sim_fault_add(&fault, FATHOM_SIM_FAULT_LATE, 1000000, 7)->us = 700000; the 7th, by 0.7 s
 *     fathom_sim_fault_attach(&fault, &line, &a16.device);
 *
 * A frame here is what a device sends at a time: a response or an automatic frame. They are counted from 1,
 * those too that a fault keeps back. Several kinds may hit one frame; they are applied in the order of the
 * list below, and each is counted when it was. A kind that does not fit a frame (an exception instead of an
 * automatic frame) leaves it alone and is not counted; fathom_sim_fault_applies tells so beforehand.
 *
 * Each rule has its own random numbers, so that one more rule does not move the hits of the others.
 * One fathom_sim_fault_t a device. It costs nothing but the draws: millions of frames are no matter.
 *
 * Not here: damage on the way from the host to the device. The device is silent then, as with SILENCE.
 */
typedef enum {
    /* what is measured; all probes of the frame, or only probe `code` */
    FATHOM_SIM_FAULT_STUCK = 1,    /* the value of the frame before, though the scene has moved on */
    FATHOM_SIM_FAULT_INTERFERENCE, /* FATHOM_SIM_INTERFERENCE; A16, A05 */
    FATHOM_SIM_FAULT_FAULT,        /* FATHOM_SIM_FAULT: the abnormal packet; HPS-167S */
    FATHOM_SIM_FAULT_NO_TARGET,    /* FATHOM_SIM_NO_TARGET */

    /* another frame, with a right CRC or sum */
    FATHOM_SIM_FAULT_UNIT,     /* from another unit (1..254); not automatic */
    FATHOM_SIM_FAULT_FUNCTION, /* another function (1..127) or command (any); not automatic */
    /* one register or distance less, or more where there is one; in a response without any, one byte more */
    FATHOM_SIM_FAULT_COUNT,
    FATHOM_SIM_FAULT_EXCEPTION, /* the exception `code`, 0: any of 1..255; Modbus only */

    /* its bytes */
    FATHOM_SIM_FAULT_FLIP_BIT,  /* one bit */
    FATHOM_SIM_FAULT_FLIP_BYTE, /* another value in one byte */
    FATHOM_SIM_FAULT_DROP,      /* one byte is missing */
    FATHOM_SIM_FAULT_INSERT,    /* one byte more, between two others */
    FATHOM_SIM_FAULT_TRUNCATE,  /* it ends after 1..length-1 bytes */
    FATHOM_SIM_FAULT_TRAILING,  /* 1..4 random bytes more at its end, without a gap */

    /* what the host's UART reports of a byte (FATHOM_RX_...). To another device a marked byte is damaged */
    FATHOM_SIM_FAULT_PARITY,  /* one bit of one byte is wrong, and marked FATHOM_RX_PARITY */
    FATHOM_SIM_FAULT_FRAMING, /* another value in one byte, marked FATHOM_RX_FRAMING */
    FATHOM_SIM_FAULT_OVERRUN, /* one byte is missing; the next that comes is marked FATHOM_RX_OVERRUN */

    /* time, and whether it comes at all */
    FATHOM_SIM_FAULT_SPLIT,     /* a pause of `us` (default 10 ms) before one of its bytes but the first */
    FATHOM_SIM_FAULT_DUPLICATE, /* it comes twice, with `us` between (default 0: none) */
    FATHOM_SIM_FAULT_DELAY,     /* `us` later (default 20 ms), which is meant to be in time */
    /* `us` later (default 1.5 s), which is meant to be after a time-out; the device is deaf until it has left */
    FATHOM_SIM_FAULT_LATE,
    FATHOM_SIM_FAULT_SILENCE, /* it does not come */
    /* 0..length-1 bytes of it come, then the device is off for `us` (default 2 s) and starts anew */
    FATHOM_SIM_FAULT_POWER_CYCLE,

    /* around it */
    FATHOM_SIM_FAULT_NOISE, /* 1..8 random bytes before or after it, `us` from it (default 3 ms) */
    /* an unsolicited frame, before or after it, `us` from it (default 10 ms): what the device measures, in the same
     * protocol */
    FATHOM_SIM_FAULT_UNASKED,
    FATHOM_SIM_FAULT_BREAK, /* 00 with FATHOM_RX_FRAMING, `us` before it (default 1 ms) */
    /* the line repeats to the host what it sends, from the end of the frame before until this one; not automatic */
    FATHOM_SIM_FAULT_ECHO,
    /* the host's clock goes forward by `us` (default 10 s) at the beginning of the frame; needs `clock` */
    FATHOM_SIM_FAULT_CLOCK_JUMP,
    FATHOM_SIM_FAULT_END
} fathom_sim_fault_kind_t;

#define FATHOM_SIM_FAULT_ALWAYS_PPM UINT32_C(1000000)
enum { FATHOM_SIM_FAULT_RULES = 32 };

/* For the sets of kinds below. */
#define FATHOM_SIM_FAULT_BIT(kind) (UINT32_C(1) << (kind))

/* us, code, run and chance_ppm are the caller's to change; a new chance acts from the frame after the next. */
typedef struct {
    uint32_t chance_ppm; /* a frame; 1000000: always */
    uint32_t at_frame;   /* 0: any; else this one only (of the chance) */
    uint32_t run;        /* frames in a row that one hit lasts; 0: one */
    uint32_t us;         /* see the kinds; 0: the default */
    uint8_t code;        /* see the kinds; 0: the default */
    uint8_t kind;
    bool hit;      /* the next frame */
    uint32_t left; /* of the run */
    uint64_t random;
} fathom_sim_fault_rule_t;

typedef struct {
    /* to be read, and set to 0 at will */
    uint32_t counters[FATHOM_SIM_FAULT_END]; /* frames hit, by kind */
    uint32_t frames;                         /* in all */
    uint32_t frames_hit;                     /* by one kind or more */
    uint32_t last_kinds;                     /* set of kinds that hit the frame last sent */
    uint32_t seen_kinds;                     /* of all frames since fathom_sim_fault_take */

    /* the caller's: what CLOCK_JUMP moves; NULL: that kind is left out */
    fathom_sim_clock_t *clock;

    /* inside */
    fathom_sim_faults_t hooks;
    fathom_sim_line_t *line;
    fathom_sim_device_t *device;
    uint64_t seed;
    uint32_t number;         /* of the frame last sent */
    uint32_t measured_kinds; /* that the next frame's values have been hit by */
    uint8_t rules_used;
    uint8_t known; /* set of probes that have a last value */
    bool off;
    bool line_echo; /* the line's own */
    int32_t last[4];
    fathom_sim_fault_rule_t rules[FATHOM_SIM_FAULT_RULES];
} fathom_sim_fault_t;

void fathom_sim_fault_init(fathom_sim_fault_t *fault, uint32_t seed);

/* Adds a rule: chance_ppm of the frames, or (at_frame not 0) that frame alone with that chance. The same kind
 * may come several times. NULL: no such kind, or FATHOM_SIM_FAULT_RULES are there. At any time. */
fathom_sim_fault_rule_t *fathom_sim_fault_add(fathom_sim_fault_t *fault, uint8_t kind, uint32_t chance_ppm,
                                              uint32_t at_frame);

/* Puts the faults between an initialised device and the line that it hangs or will hang on. Replaces what the
 * device had in `faults`. `fault` may not be moved then, and lives as long as the device does. */
void fathom_sim_fault_attach(fathom_sim_fault_t *fault, fathom_sim_line_t *line, fathom_sim_device_t *device);

/* No more faults, or again. What is under way goes on: a late response, a device without power. Frames are
 * counted on. At the beginning they are on. */
void fathom_sim_fault_enable(fathom_sim_fault_t *fault, bool on);

/* The kinds that have hit any frame since this was last called, as FATHOM_SIM_FAULT_BIT(kind). */
uint32_t fathom_sim_fault_take(fathom_sim_fault_t *fault);

/* Can the kind hit frames of this (initialised) device, in any of the protocols that it speaks? */
bool fathom_sim_fault_applies(uint8_t kind, const fathom_sim_device_t *device);

/* "flip-bit" and a few words on it; NULL: no such kind. */
const char *fathom_sim_fault_name(uint8_t kind);
const char *fathom_sim_fault_text(uint8_t kind);

/* The kind of that name; 0: none. */
uint8_t fathom_sim_fault_find(const char *name);

#ifdef __cplusplus
}
#endif

#endif
