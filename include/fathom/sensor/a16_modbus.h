/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_A16_MODBUS_H
#define FATHOM_A16_MODBUS_H

#include "fathom/sensor/internal/dyp_modbus.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * A16 by Modbus RTU (A16 6): the RS485 variant, and the RS232 variant, whose automatic output ends with
 * the first request and does not come back by itself. 9600 8N1.
 *
 * One sample a response, as often as polling and the pace allow: FATHOM_TARGET, or what the window makes of the
 * values 0, FFFD, FFFE and FFFF (dyp.h). The errors of fathom_poll, each of one attempt:
 *   FATHOM_ERR_NO_RESPONSE  nothing from the unit in timeout_us, retries included. The datasheet documents no
 *                           exceptions: a wrong register may be silence too
 *   FATHOM_ERR_CHECKSUM     its response was damaged
 *   FATHOM_ERR_EXCEPTION    it refused; fathom_a16_modbus_exception has the number
 *   FATHOM_ERR_MALFORMED    it sent something else, or a value that is refused: outside the window, or FFFF;
 *                           then it is in base.measurement.refused_raw, and counted
 *   FATHOM_ERR_PORT         the HAL's port is broken; returned by every poll until it works again
 *   FATHOM_ERR_LINE_BUSY    the line was never silent. Says nothing about the unit (status.h)
 *   FATHOM_ERR_OTHER_MASTER another master asked the same unit. Says nothing about the unit
 *   FATHOM_ERR_CANCELLED    the line was initialised again, or another driver moved the unit
 *   FATHOM_ERR_ARGUMENT     the driver is not initialised
 *
 * The longest time until fathom_poll() returns an outcome is that of modbus_unit.h:
 *
 *     period_us + least(16 * timeout_us, backoff_us) + B(timeout_us, retries) + S + P
 *
 * Here B is the bound of a transaction alone on its line (line.h), S the sum of the bounds of the line's other
 * transactions, and P the polling interval. While a command or setting of this driver is in progress, its time is added.
 * The other registers are in a16_settings.h.
 */

/* From one request to the next, at least. The datasheet gives 120 ms for a measurement (A16 3(2)). */
#define FATHOM_A16_MIN_PERIOD_US 120000uL

/* Register addresses (A16 6(3)). One register a read: no longer one is documented. */
enum { FATHOM_A16_REGISTER_PROCESSED = 0x0100, FATHOM_A16_REGISTER_REAL_TIME = 0x0101 };

/* Read by init only. Members that are 0 mean their defaults: a period of 120 ms, a time-out of 1 s for the processed
 * value and 300 ms for the real-time one. */
typedef struct {
    fathom_modbus_config_t modbus;
    uint32_t start_us; /* after power_on silence is no error for so long; 0: 1.5 s, as sister models need */
    fathom_dyp_window_t window; /* the distances that are believed; 0: 1 and 16350 mm */
    /* fathom_dyp_value_t. Processed: sister models take up to 520 ms to respond; real-time: about 120 ms. */
    uint8_t value;
} fathom_a16_modbus_config_t;

typedef struct {
    fathom_dyp_modbus_t base;
    uint16_t values[1];
} fathom_a16_modbus_t;

/* FATHOM_OK, or FATHOM_ERR_ARGUMENT: no transport, address 255 or one beside address_zero,
 * no such value, min_mm over max_mm, or a member outside its range; `value` is 0 or 1.
 * Ranges: `modbus` as in fathom_modbus_config_t, `start_us` 0 to 2^31 - 1, `window` as in fathom_dyp_window_t. A refused
 * init zeroes *sensor; then each poll and command returns FATHOM_ERR_ARGUMENT. FATHOM_ERR_BUSY: a request of this driver is
 * still queued; nothing changed. Call the deinit function first. */
fathom_status_t fathom_a16_modbus_init(fathom_a16_modbus_t *sensor, const fathom_a16_modbus_config_t *config);

/* Cancels what is under way; the memory is the caller's again. */
void fathom_a16_modbus_deinit(fathom_a16_modbus_t *sensor);

/* To be called when the sensor gets power: for start_us its silence is FATHOM_ERR_WARMING_UP. */
void fathom_a16_modbus_power_on(fathom_a16_modbus_t *sensor);

/* The exception code that came with the last FATHOM_ERR_EXCEPTION, until the next request; 0: there was none. */
static inline uint8_t fathom_a16_modbus_exception(const fathom_a16_modbus_t *sensor)
{
    return fathom_modbus_unit_exception(&sensor->base.unit);
}

/* For fathom_modbus_unit_responses and fathom_modbus_unit_failures: how many requests succeeded, and how many not. */
static inline const fathom_modbus_unit_t *fathom_a16_modbus_unit(const fathom_a16_modbus_t *sensor)
{
    return &sensor->base.unit;
}

/* For fathom_poll. */
fathom_sensor_t fathom_a16_modbus_sensor(fathom_a16_modbus_t *sensor);

#ifdef __cplusplus
}
#endif

#endif
