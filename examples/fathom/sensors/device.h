/* SPDX-License-Identifier: MIT */
#ifndef DEVICE_H
#define DEVICE_H

#include "sim/a05.h"
#include "sim/a16.h"
#include "sim/hps167s.h"

/* Traits of a simulated sensor; 0: it does not have the trait. commands/sim explains them, and model_t.traits has those
 * that a model can have. */
typedef enum {
    DEVICE_EXCEPTIONS,
    DEVICE_ANSWERS_BROADCAST,
    DEVICE_REAL_TIME,
    DEVICE_ANSWERS_FROM_NEW,
    DEVICE_WARM_UP, /* seconds */
    DEVICE_WARM_UP_REFUSES,
    DEVICE_WARM_UP_ABNORMAL,
    DEVICE_UNASKED, /* microseconds */
    DEVICE_NO_OUTPUT,
    DEVICE_NO_TERMINATION,
    DEVICE_BAUD_LATER,
    DEVICE_OFFSET_ADDS,
    DEVICE_RECONNECT, /* milliseconds */
    DEVICE_NO_BAUD_CODE,
    DEVICE_COUNT_EXCEPTION,
    DEVICE_TRAITS
} device_trait_t;

typedef struct {
    uint8_t address;
    uint32_t baud; /* 0: the factory setting; for sensors with several rates */
    uint32_t seed;
    uint8_t number; /* of the unit among those of its model that have a number of their own */
    uint32_t traits[DEVICE_TRAITS];
    fathom_sim_scene_t scene;
} device_settings_t;

/* Any simulated sensor. */
typedef struct {
    fathom_sim_device_t *base; /* for fathom_sim_attach */
    union {
        fathom_sim_a16_t a16;
        fathom_sim_a05_t a05;
        fathom_sim_hps167s_t hps167s;
    } simulator;
} device_t;

#endif
