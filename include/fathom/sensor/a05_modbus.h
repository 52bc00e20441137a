/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_A05_MODBUS_H
#define FATHOM_A05_MODBUS_H

#include "fathom/codec/dyp_stream.h"
#include "fathom/sensor/internal/dyp_modbus.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * A05 by Modbus RTU (A05 3): the RS485 variant, and the UART variant, whose automatic output ends with
 * the first request until it is powered off. 9600 8N1. Each read starts a measurement of the probes it names,
 * one after the other, about 100 ms each.
 *
 * A sample a wanted probe and response, with one sequence number and one time: FATHOM_TARGET, or what the window
 * makes of the values 0, FFFD, FFFE and FFFF (dyp.h). The errors of fathom_poll, each of one attempt:
 *   FATHOM_ERR_NO_RESPONSE  nothing from the unit in timeout_us, retries included. The datasheet documents no
 *                           exceptions: a wrong register may be silence too
 *   FATHOM_ERR_CHECKSUM     its response was damaged
 *   FATHOM_ERR_EXCEPTION    it refused; fathom_a05_modbus_exception has the number
 *   FATHOM_ERR_MALFORMED    it sent something else, or this probe's value is refused: outside the window, or FFFF;
 *                           base.measurement.refused_probe and refused_raw tell which, and it is counted
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
 */

/* From one request to the next, at least, for each probe that it reads. */
#define FATHOM_A05_PROBE_US 100000uL

/* The first probe's register; the same four distances stand in two places (A05 3(3), remark 2). */
enum { FATHOM_A05_REGISTERS = 0x0106, FATHOM_A05_REGISTERS_ALIAS = 0x0010 };

/* Read by init only. Members that are 0 mean their defaults: a period of 100 ms a probe, and a time-out of 200 ms more
 * than that. */
typedef struct {
    fathom_modbus_config_t modbus;
    uint32_t start_us; /* after power_on silence is no error for so long; 0: 1.5 s, as sister models need */
    fathom_dyp_window_t window; /* the distances that are believed; 0: 1 and 6000 mm */
    uint16_t registers;         /* 0: FATHOM_A05_REGISTERS; or FATHOM_A05_REGISTERS_ALIAS */
    /* Bit probe - 1: wanted; 0: all four. One read measures the first to the last of them. */
    uint8_t probes;
} fathom_a05_modbus_config_t;

typedef struct {
    fathom_dyp_modbus_t base;
    uint16_t values[FATHOM_DYP_PROBES];
} fathom_a05_modbus_t;

/* FATHOM_OK, or FATHOM_ERR_ARGUMENT: no transport, address 255 or one beside address_zero,
 * other registers, a probe over 4, min_mm over max_mm, or a member outside its range; a frame buffer of the line that is
 * too small for the probes: 5 bytes and 2 for each register from the first to the last wanted probe.
 * Ranges: `modbus` as in fathom_modbus_config_t, `start_us` 0 to 2^31 - 1, `window` as in fathom_dyp_window_t. A refused
 * init zeroes *sensor; then each poll and command returns FATHOM_ERR_ARGUMENT. FATHOM_ERR_BUSY: a request of this driver is
 * still queued; nothing changed. Call the deinit function first. */
fathom_status_t fathom_a05_modbus_init(fathom_a05_modbus_t *sensor, const fathom_a05_modbus_config_t *config);

/* Cancels what is under way; the memory is the caller's again. */
void fathom_a05_modbus_deinit(fathom_a05_modbus_t *sensor);

/* To be called when the sensor gets power: for start_us its silence is FATHOM_ERR_WARMING_UP. */
void fathom_a05_modbus_power_on(fathom_a05_modbus_t *sensor);

/*
 * The address, register 0x0200 (A05 3(3)), read and set. Each function returns at once: call it, with the
 * loop going on in between, until it is not FATHOM_PENDING; fathom_poll rests meanwhile. A response takes
 * command_timeout_us (1 s) at most, a change some 3 s, since a read first shows that no unit is at the new address.
 *
 * address: FATHOM_OK with *address, or an error of fathom_poll.
 * set_address: 1..254. FATHOM_OK: the device was read at the new address, where the driver is from now on. Else,
 * with the driver at the old address:
 *   FATHOM_ERR_ARGUMENT     0 or 255
 *   FATHOM_ERR_IN_USE       a unit responds there already; nothing was changed
 *   FATHOM_ERR_UNCONFIRMED  it was sent, and the device responds at neither: it is at one of the two
 *   FATHOM_ERR_BUSY         another command is not finished
 *   others                  of fathom_poll: nothing was changed
 * is_written: has the last setting, or the one under way, been handed to the line?
 * Other drivers' requests that wait for the old address end with FATHOM_ERR_CANCELLED.
 */
fathom_status_t fathom_a05_modbus_get_address(fathom_a05_modbus_t *sensor, uint8_t *address);
fathom_status_t fathom_a05_modbus_set_address(fathom_a05_modbus_t *sensor, uint8_t address);
bool fathom_a05_modbus_is_written(const fathom_a05_modbus_t *sensor);

/* Sets the address to 0, which is in the datasheet's range and is the standard's broadcast: such a unit may not be
 * found again, since it need not respond there, and what is written to it would be written to all units. The driver
 * reads it there from then on, and sets nothing of it any more. Else as set_address. */
fathom_status_t fathom_a05_modbus_set_address_0(fathom_a05_modbus_t *sensor);

/* Gives up what is under way, also a measurement. An address that was being set may be set or not. */
void fathom_a05_modbus_cancel(fathom_a05_modbus_t *sensor);

/* The exception code that came with the last FATHOM_ERR_EXCEPTION, until the next request; 0: there was none. */
static inline uint8_t fathom_a05_modbus_exception(const fathom_a05_modbus_t *sensor)
{
    return fathom_modbus_unit_exception(&sensor->base.unit);
}

/* For fathom_modbus_unit_responses and fathom_modbus_unit_failures: how many requests succeeded, and how many not. */
static inline const fathom_modbus_unit_t *fathom_a05_modbus_unit(const fathom_a05_modbus_t *sensor)
{
    return &sensor->base.unit;
}

/* For fathom_poll. */
fathom_sensor_t fathom_a05_modbus_sensor(fathom_a05_modbus_t *sensor);

#ifdef __cplusplus
}
#endif

#endif
