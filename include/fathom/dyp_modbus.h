/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_DYP_MODBUS_H
#define FATHOM_DYP_MODBUS_H

#include "fathom/dyp.h"
#include "fathom/modbus_unit.h"
#include "fathom/sensor.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What a16_modbus.h and a05_modbus.h are built on: an ultrasonic sensor that is asked for the registers of
 * its probes. Their users need not know it. */
typedef struct {
    fathom_modbus_unit_t unit;
    fathom_modbus_question_t question;
    fathom_dyp_answer_t answer;
    uint8_t probes; /* bit probe - 1: wanted of those that are read */
} fathom_dyp_modbus_t;

/* The caller has set the question and the probes, and values, window, model and first of the answer.
 * FATHOM_READY, or FATHOM_ERR_ARGUMENT: as fathom_modbus_unit_init, or a window that is upside down. */
fathom_status_t fathom_dyp_modbus_init(fathom_dyp_modbus_t *sensor, const fathom_modbus_t *modbus,
                                       const fathom_clock_t *clock, uint8_t address, uint16_t default_max_mm);

/* Cancels what is under way. */
void fathom_dyp_modbus_deinit(fathom_dyp_modbus_t *sensor);

/* For fathom_poll and fathom_due_us. A value that is not plausible is refused alone: the CRC vouches
 * for its place. */
fathom_sensor_t fathom_dyp_modbus_sensor(fathom_dyp_modbus_t *sensor);

#ifdef __cplusplus
}
#endif

#endif
