/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_DYP_MODBUS_H
#define FATHOM_DYP_MODBUS_H

#include "fathom/engine/internal/modbus_setting.h"
#include "fathom/engine/sensor.h"
#include "fathom/sensor/internal/dyp.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What a16_modbus.h and a05_modbus.h are built on: an ultrasonic sensor whose registers of
 * distances are read. Their users need not know it. */
typedef struct {
    uint8_t probes; /* bit probe - 1: wanted of those that are read */
    uint8_t count;  /* of the registers that a measurement reads */
    uint16_t first; /* of these registers */
    uint16_t found; /* the register that a command reads */
    fathom_dyp_measurement_t measurement;
    uint32_t start_us;
    fathom_modbus_unit_t unit;
} fathom_dyp_modbus_t;

/* Both sensors have their address here (A05 3(3), A16 6(3)). */
enum { FATHOM_DYP_REGISTER_ADDRESS = 0x0200 };

/* How long after power-on silence is no error, where a driver's config says 0. Data comes after some 900 ms, as is
 * known of sister models; it is not in the datasheets. */
#define FATHOM_DYP_DEFAULT_START_US 1500000uL

/* After fathom_modbus_unit_begin(), the caller has set first, count, the probes, start_us (0: its default), and values, window, model
 * and first of the measurement; timeout_us and pace_us are the driver's, as of fathom_modbus_unit_init.
 * FATHOM_OK, or FATHOM_ERR_ARGUMENT: as fathom_modbus_unit_init, or min_mm over max_mm. */
fathom_status_t fathom_dyp_modbus_init(fathom_dyp_modbus_t *sensor, const fathom_modbus_config_t *config,
                                       uint32_t timeout_us, uint32_t pace_us);

/* Cancels what is under way. */
void fathom_dyp_modbus_deinit(fathom_dyp_modbus_t *sensor);

/* The sensor gets power now: for start_us its silence is FATHOM_ERR_WARMING_UP. */
void fathom_dyp_modbus_power_on(fathom_dyp_modbus_t *sensor);

/*
 * Commands, to be called until they are not FATHOM_PENDING; of registers that differ in their bits 0 to 3, 8 or 9, as
 * all of A16 and A05 do. get: FATHOM_OK with *value, or the errors of fathom_modbus_command; address: also
 * FATHOM_ERR_MALFORMED, where the register has more than 255. set: as fathom_modbus_set; set_address: the same, for
 * 1..254, else FATHOM_ERR_ARGUMENT; set_address_to_0 as the functions of that name of A16 and A05. At address 0 nothing
 * is written: FATHOM_ERR_ARGUMENT, since all units would obey. write: where nothing can be read back; FATHOM_OK is
 * the acknowledgement. The address is read first, which shows the line whether it echoes: without that an
 * acknowledgement proves nothing (line.h).
 */
fathom_status_t fathom_dyp_modbus_get_register(fathom_dyp_modbus_t *sensor, uint16_t address,
                                               uint16_t *value);
fathom_status_t fathom_dyp_modbus_set_register(fathom_dyp_modbus_t *sensor, uint16_t address, uint16_t value);
fathom_status_t fathom_dyp_modbus_write_register(fathom_dyp_modbus_t *sensor, uint16_t address,
                                                 uint16_t value);
fathom_status_t fathom_dyp_modbus_get_address(fathom_dyp_modbus_t *sensor, uint8_t *address);
fathom_status_t fathom_dyp_modbus_set_address(fathom_dyp_modbus_t *sensor, uint8_t address);
fathom_status_t fathom_dyp_modbus_set_address_0(fathom_dyp_modbus_t *sensor);

/* What get and set are made of, without fathom_modbus_unit_poll: look goes on with the read of a register; describe
 * fills in the setting of one to this value, all but its read. */
fathom_status_t fathom_dyp_modbus_look(fathom_dyp_modbus_t *sensor, uint16_t address, uint16_t *value);
void fathom_dyp_modbus_describe(fathom_dyp_modbus_t *sensor, fathom_modbus_setting_t *setting,
                                uint16_t address, uint16_t value);

/* ---- the one device on a line ---- */

/* In the caller's memory, all zero before the first call. */
typedef struct {
    fathom_modbus_request_t request;
    uint32_t polled_us; /* the clock at the last call */
    uint16_t value;
    bool is_asked;
} fathom_dyp_modbus_find_t;

/*
 * Finds the address of the A16 or A05 that is alone on a line: reads register 0x0200 at 255, "the
 * broadcast address" (A16 6(3), A05 3(3)), which changes nothing. Call it, with the loop going on in between, until it
 * is not FATHOM_PENDING; it polls the transport. The line's settings are as they are.
 * FATHOM_OK: *address, 0..254, is where the response came from, or its value, if that is 255. Each outcome comes
 * once; the next call begins anew. All units are quarantined for up to two seconds.
 * FATHOM_ERR_NO_RESPONSE: nothing in a second. The datasheets do not say whether a unit responds there.
 * FATHOM_ERR_CHECKSUM: what came was damaged; perhaps several responded at once. FATHOM_ERR_MALFORMED: no address.
 * Others: as fathom_transaction_t.
 */
fathom_status_t fathom_dyp_modbus_find(fathom_dyp_modbus_find_t *find, const fathom_modbus_t *transport,
                                       uint8_t *address);

/* Gives it up; the memory is the caller's again. */
void fathom_dyp_modbus_find_cancel(fathom_dyp_modbus_find_t *find, const fathom_modbus_t *transport);

/* For fathom_poll and fathom_due_us. A refused value does not affect the others: the CRC vouches for its place. */
fathom_sensor_t fathom_dyp_modbus_sensor(fathom_dyp_modbus_t *sensor);

#ifdef __cplusplus
}
#endif

#endif
