/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_AUTO_RIG_H
#define FATHOM_TESTS_AUTO_RIG_H

#include "fake.h"
#include "fathom/line.h"
#include "fathom/sensor.h"

/* A fake UART, a real line on it, and a driver that listens there, with what its polls said. At 9600 8N1. */
enum { RIG_BYTE_US = 1042, RIG_PERIOD_US = 100000, RIG_GAP_US = 5000, RIG_START_US = 1000 };

typedef struct {
    fake_t fake;
    uint8_t frame[13];
    fathom_line_config_t line_config;
    fathom_line_t line;
    fathom_sensor_t sensor;  /* the test's, after it has started the line */
    fathom_sample_t sample;  /* the last one */
    fathom_sample_t last[4]; /* the last one of each probe */
    uint32_t silent_us;      /* of the next period, which rig_send has used up */
    unsigned samples;
    unsigned stales;
    unsigned malformed;
    unsigned ports;
} rig_t;

extern rig_t rig;

/* All begins anew, with a line that has just been made at this time. */
void rig_start(uint32_t now_us);

/* Polls the driver once; without a sample it must not write one. */
fathom_status_t rig_poll(void);

/* Time goes on in steps; after each the driver is polled until it has nothing more to say, as its header
 * advises. */
void rig_run(uint32_t for_us, uint32_t step_us);

/* One period of 100 ms: silence, with a frame at its end, byte by byte; and the first 5 ms of the next one, which end
 * the frame. */
void rig_send(const uint8_t *frame, size_t length, uint32_t step_us);

#endif
