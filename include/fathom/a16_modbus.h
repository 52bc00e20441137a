/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_A16_MODBUS_H
#define FATHOM_A16_MODBUS_H

#include "fathom/dyp_modbus.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * A16 asked by Modbus RTU (A16 6): the RS485 variant, and the RS232 variant, whose automatic output ends with
 * the first request and does not come back by itself. 9600 8N1.
 *
 * One sample an answer, as often as polling and the pace allow: FATHOM_TARGET, or what the window says that the
 * values 0, FFFD, FFFE and FFFF are (dyp.h). The errors of fathom_poll, each of one attempt:
 *   FATHOM_ERR_NO_ANSWER  nothing from the unit in timeout_us, retries included. The datasheet documents no
 *                         exceptions: a wrong register may be silence too
 *   FATHOM_ERR_CHECKSUM   its answer was damaged
 *   FATHOM_ERR_EXCEPTION  it refused; base.unit.request.message.exception has the number
 *   FATHOM_ERR_MALFORMED  it answered something else, or a value that is refused: outside the window, or FFFF;
 *                         then it is in base.answer.refused_raw, and counted
 *   FATHOM_ERR_PORT       the HAL's port is broken; said by every poll until it works again
 * The other registers are in a16_settings.h.
 */

/* From one request to the next, at least. The datasheet gives 120 ms for a measurement (A16 3(2)). */
#define FATHOM_A16_MIN_PERIOD_US 120000ul

/* Register addresses (A16 6(3)). One register a read: no longer one is documented. */
enum { FATHOM_A16_REGISTER_PROCESSED = 0x0100, FATHOM_A16_REGISTER_REAL_TIME = 0x0101 };

typedef enum {
    FATHOM_A16_PROCESSED = 0, /* steady; sister models take up to 520 ms to answer */
    FATHOM_A16_REAL_TIME = 1  /* the last measurement; about 120 ms */
} fathom_a16_value_t;

/* Read by init only; modbus and clock outlive the sensor. Members that are 0 mean their defaults. */
typedef struct {
    const fathom_modbus_t *modbus;
    const fathom_clock_t *clock;
    const fathom_line_settings_t *settings; /* where those on one line differ (line.h); NULL: as they are */
    uint32_t backoff_us; /* how long a unit that does not answer is left alone at last; 0: 16 time-outs */
    uint32_t period_us;  /* from one request to the next; 0 and anything less: 120 ms */
    uint32_t timeout_us; /* 0: 1 s for the processed value, 300 ms for the real-time one */
    uint32_t command_timeout_us; /* of whatever else is asked; 0: 1 s */
    uint32_t start_us; /* after power_on silence is no error for so long; 0: 1.5 s, as sister models need */
    fathom_dyp_window_t window; /* the distances that are believed; 0: 1 and 16350 mm */
    uint8_t address;            /* 1..254; 0: 1, the factory's */
    bool address_zero; /* it is at address 0 and answers there; `address` is 0. It can be read, not set */
    uint8_t retries;   /* after a failed attempt; 0: none */
    uint8_t value;     /* fathom_a16_value_t */
} fathom_a16_modbus_config_t;

typedef struct {
    fathom_dyp_modbus_t base;
    uint16_t values[1];
} fathom_a16_modbus_t;

/* FATHOM_READY, or FATHOM_ERR_ARGUMENT: no modbus or clock, address 255 or one beside
 * address_zero, no such value, min_mm over max_mm. */
fathom_status_t fathom_a16_modbus_init(fathom_a16_modbus_t *sensor, const fathom_a16_modbus_config_t *config);

/* Cancels what is under way; the memory is the caller's again. */
void fathom_a16_modbus_deinit(fathom_a16_modbus_t *sensor);

/* To be called when the sensor gets power: for start_us its silence is FATHOM_ERR_WARMING_UP. */
void fathom_a16_modbus_power_on(fathom_a16_modbus_t *sensor);

/* For fathom_poll. */
fathom_sensor_t fathom_a16_modbus_sensor(fathom_a16_modbus_t *sensor);

#ifdef __cplusplus
}
#endif

#endif
