/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_SAMPLE_H
#define FATHOM_SAMPLE_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What the device reported. An error of the line is no sample: it is a fathom_status_t. */
typedef enum {
    FATHOM_TARGET = 1,    /* something is distance_mm away */
    FATHOM_NO_TARGET = 2, /* the device works and sees nothing in range */
    /* the device reports that it is broken (HPS-167S #5), or its output does what that of a working one cannot */
    FATHOM_FAULT = 3,
    FATHOM_NEAR = 4, /* a switch or a contact: something is nearer than its threshold; no distance */
    FATHOM_FAR = 5,  /* the same: nothing is; no distance */
    /* a value without a known meaning, or only pulses below the range: it is in raw. No distance */
    FATHOM_UNKNOWN = 6
} fathom_sample_kind_t;

typedef enum { FATHOM_A16 = 1, FATHOM_A05 = 2, FATHOM_HPS167S = 3 } fathom_model_t;

/*
 * One reading, the same for every sensor and every mode. The last four members are the HPS-167S's and 0
 * for the others.
 */
typedef struct {
    uint32_t time_us;   /* the HAL's clock when the last byte of the response came; wraps */
    uint32_t magnitude; /* strength of the reflected light * 10000: 7231744 is 723.1744 (HPS-167S #5) */
    /* what the device sent, whatever it means: 16 bits, the width of a pulse in us, the level of a switch */
    uint32_t raw;
    uint16_t sequence;    /* of the response; wraps; the probes of one A05 response share it */
    uint16_t distance_mm; /* 0 unless kind is FATHOM_TARGET */
    uint16_t precision;   /* the device's accuracy figure: the smaller the better, no unit (HPS-167S #5) */
    uint8_t kind;         /* fathom_sample_kind_t */
    uint8_t model;        /* fathom_model_t */
    uint8_t address;      /* Modbus address; 0 from a sensor that sends by itself */
    uint8_t probe;        /* 1..4; 1 where there is one */
    uint8_t ambient;      /* infrared light of the surroundings, relative (HPS-167S #5) */
    bool interference;    /* with FATHOM_NO_TARGET: another unit of the same frequency disturbs */
} fathom_sample_t;

#ifdef __cplusplus
}
#endif

#endif
