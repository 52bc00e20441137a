/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_CONTROLLED_RIG_H
#define FATHOM_TESTS_CONTROLLED_RIG_H

#include "auto_rig.h"
#include "fake_pin.h"
#include "fathom/engine/line_pins.h"
#include "fathom/sensor/a16_controlled.h"

/* auto_rig.h with an A16 that is triggered, by the fake UART's break unless the config names the pin. */
enum { FRAME_US = 4 * RIG_BYTE_US };

typedef struct {
    fathom_output_t trigger; /* this and the config are the test's to change before it starts anew */
    fathom_a16_controlled_config_t config;
    fathom_a16_controlled_t a16;
    fake_pin_t pin;
} controlled_t;

extern controlled_t controlled;

extern const uint8_t controlled_1953[4]; /* A16 3(5) */
extern const uint8_t controlled_511[4];  /* FF + 01 + FF = 1FF */

/* For cmocka: the default config. */
int controlled_set_up(void **state);

/* Initialises the driver as it is. */
fathom_status_t controlled_init(void);

/* All but the trigger and the config begins anew. */
void controlled_start(void);
void controlled_start_at(uint32_t now_us);

/* Until so many breaks have begun since the start. */
void controlled_run_to_break(unsigned breaks, uint32_t step_us);

/* A frame whose last byte comes so long after now. */
void controlled_response(const uint8_t frame[4], uint32_t after_us);

/* Polls until something comes of the trigger, and no other trigger may before. */
fathom_status_t controlled_outcome(uint32_t step_us);

#endif
