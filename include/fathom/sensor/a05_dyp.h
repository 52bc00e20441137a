/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_A05_DYP_H
#define FATHOM_A05_DYP_H

#include <stdint.h>

#include "fathom/codec/dyp_stream.h"
#include "fathom/engine/dyp_client.h"
#include "fathom/engine/line.h"
#include "fathom/engine/sensor.h"
#include "fathom/sensor/internal/dyp.h"
#include "fathom/sensor/internal/dyp_modbus.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * A05 on RS-485 with the 55 AA frames of its "DYP protocol" (A05 2). 9600 8N1. One command measures all
 * four probes (200..210 ms) or one (65..75 ms).
 *
 * The same unit speaks Modbus on the same wires (a05_modbus.h), and Modbus is to be preferred: its checksum has 16
 * bits instead of 8; and one flipped bit in a response (command 01 to 03) makes it a request that gives its
 * address to every other A05 that hears it. So use these frames with one A05 on the line.
 *
 * Samples and errors of fathom_poll are those of a05_modbus.h, but for FATHOM_ERR_EXCEPTION, which this protocol
 * does not have. FATHOM_ERR_CHECKSUM stands for a wrong sum. The longest time until an outcome is the same formula.
 */

/* From one command to the next, at least (A05 2(3)1). */
#define FATHOM_A05_DYP_ALL_PROBES_US 250000uL
#define FATHOM_A05_DYP_ONE_PROBE_US  100000uL

/* Read by init only. Members that are 0 mean their defaults: the two periods above, and a time-out of 500 ms for all
 * probes, 200 ms for one, which is twice the datasheet's and more. */
typedef struct {
    /* Its transport is made by fathom_dyp_client; no address_zero: the protocol has 1..254 (A05 2(3)2). */
    fathom_modbus_config_t modbus;
    uint32_t start_us; /* after power_on silence is no error for so long; 0: 1.5 s, as sister models need */
    fathom_dyp_window_t window; /* the distances that are believed; 0: 1 and 6000 mm */
    /* Bit probe - 1: wanted; 0: all four. One bit alone: only that probe is measured, which is faster. */
    uint8_t probes;
} fathom_a05_dyp_config_t;

typedef struct {
    fathom_dyp_modbus_t base;
    uint16_t values[FATHOM_DYP_PROBES];
} fathom_a05_dyp_t;

/* FATHOM_OK, or FATHOM_ERR_ARGUMENT: no transport, address 255, address_zero, a probe over 4, min_mm over max_mm, or a
 * member outside its range; a frame buffer of the line below 13 bytes.
 * Ranges: `modbus` as in fathom_modbus_config_t, `start_us` 0 to 2^31 - 1, `window` as in fathom_dyp_window_t. A refused
 * init zeroes *sensor; then each poll and command returns FATHOM_ERR_ARGUMENT. FATHOM_ERR_BUSY: a request of this driver is
 * still queued; nothing changed. Call the deinit function first. */
fathom_status_t fathom_a05_dyp_init(fathom_a05_dyp_t *sensor, const fathom_a05_dyp_config_t *config);

/* Cancels what is under way; the memory is the caller's again. */
void fathom_a05_dyp_deinit(fathom_a05_dyp_t *sensor);

/* For fathom_modbus_unit_responses and fathom_modbus_unit_failures: how many requests succeeded, and how many not. */
static inline const fathom_modbus_unit_t *fathom_a05_dyp_unit(const fathom_a05_dyp_t *sensor)
{
    return &sensor->base.unit;
}

/* For fathom_poll. */
fathom_sensor_t fathom_a05_dyp_sensor(fathom_a05_dyp_t *sensor);

/* To be called when the sensor gets power: for start_us its silence is FATHOM_ERR_WARMING_UP. */
void fathom_a05_dyp_power_on(fathom_a05_dyp_t *sensor);

/*
 * Gives EVERY A05 that hears it this address: the command (A05 2(3)5) has the new address in it and no old one. Have
 * one unit on the line; where there are several, fathom_a05_modbus_set_address reaches one of them.
 *
 * Call it, with the loop going on in between, until it is not FATHOM_PENDING; fathom_poll rests meanwhile. First the
 * driver's own address is read, then the new one, where no unit may respond; the command is sent once; then the new
 * address is read. Some 2 s.
 *   FATHOM_OK            the device was read at the address, where the driver is from now on
 *   FATHOM_ERR_ARGUMENT     0 or 255
 *   FATHOM_ERR_IN_USE       a unit responds there already; nothing was sent
 *   FATHOM_ERR_UNCONFIRMED  it was sent, and the device responds at neither address: it is at one of the two
 *   FATHOM_ERR_BUSY         another command is not finished
 *   others                  of fathom_poll: nothing was changed
 * is_written: has the last command, or the one under way, been handed to the line?
 * Its response equals the request, and so counts for nothing here: only the reading at the new address does.
 */
fathom_status_t fathom_a05_dyp_broadcast_address(fathom_a05_dyp_t *sensor, uint8_t address);
bool fathom_a05_dyp_is_written(const fathom_a05_dyp_t *sensor);

/* Gives up what is under way, also a measurement. An address that was being set may be set or not. */
void fathom_a05_dyp_cancel(fathom_a05_dyp_t *sensor);

/* ---- the address of the one A05 on a line ---- */

/* In the caller's memory, all zero before the first call. */
typedef struct {
    fathom_modbus_request_t request;
    uint16_t value;
    bool is_asked;
} fathom_a05_dyp_find_t;

/*
 * Sends the request to measure the first probe, which changes nothing, to all units (FF), and takes the address from
 * the first response. Call it, with the loop going on in between, until it is not FATHOM_PENDING; it polls the line.
 * FATHOM_OK: *address is where the response came from. Each outcome comes once; the next call begins anew.
 * FATHOM_ERR_NO_RESPONSE: nothing in 200 ms. The datasheet does not say whether a unit responds to FF (A05 2(3)2).
 * FATHOM_ERR_CHECKSUM: what came was damaged; perhaps several responded at once. Others: as fathom_transaction_t.
 */
fathom_status_t fathom_a05_dyp_find(fathom_a05_dyp_find_t *find, fathom_line_t *line, uint8_t *address);

/* Gives it up; the memory is the caller's again. */
void fathom_a05_dyp_find_cancel(fathom_a05_dyp_find_t *find, fathom_line_t *line);

#ifdef __cplusplus
}
#endif

#endif
