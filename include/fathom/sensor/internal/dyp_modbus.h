/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_DYP_MODBUS_H
#define FATHOM_DYP_MODBUS_H

#include "fathom/engine/internal/modbus_setting.h"
#include "fathom/engine/sensor.h"
#include "fathom/sensor/internal/dyp.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief What the Modbus drivers of A16 and A05 share: registers with distances are read again and again, and other
 * registers are read and set. Users of a16_modbus.h and a05_modbus.h need not know this file.
 *
 * fathom_dyp_modbus_find() is the exception: it finds the address of the only device on a line.
 */

/** @brief A driver of an ultrasonic sensor by Modbus. All members belong to the drivers. */
typedef struct {
    /** @brief Set of probes that the user reads: bit (probe - 1). */
    uint8_t probes;
    /** @brief Number of registers that a measurement reads. */
    uint8_t count;
    /** @brief Address of the first of these registers. */
    uint16_t first;
    /** @brief The register that a command has read. */
    uint16_t found;
    /** @brief The newest response. */
    fathom_dyp_measurement_t measurement;
    /** @brief Start-up time after power-on, in microseconds. */
    uint32_t start_us;
    /** @brief The unit. */
    fathom_modbus_unit_t unit;
} fathom_dyp_modbus_t;

/** @brief Registers of both sensors. */
enum { FATHOM_DYP_REGISTER_ADDRESS = 0x0200 /**< The address (A05 3(3), A16 6(3)). */ };

/**
 * @brief Default of the start-up time, in microseconds: how long after power-on a missing response is no error.
 *
 * The datasheets have no such time. Related models send data about 900 ms after power-on.
 */
#define FATHOM_DYP_DEFAULT_START_US 1500000uL

/**
 * @brief Initialises a driver after fathom_modbus_unit_begin().
 *
 * Before the call the driver sets `first`, `count`, `probes` and `start_us` (0 selects its default), and `values`,
 * `facts`, `model` and `first` of `measurement`.
 *
 * @param sensor      The driver.
 * @param transport   The transport, copied. Its line must stay valid as long as the driver.
 * @param config      The configuration of the unit. Read only during the call. Not NULL.
 * @param timeout_us  Default of the time-out, as in fathom_modbus_unit_init().
 * @param pace_us     Least time between two measurements, as in fathom_modbus_unit_init().
 * @retval FATHOM_OK            The driver can be used.
 * @retval FATHOM_ERR_ARGUMENT  As fathom_modbus_unit_init(), or `start_us` or a fact is outside its range.
 */
fathom_status_t fathom_dyp_modbus_init(fathom_dyp_modbus_t *sensor, const fathom_modbus_t *transport,
                                       const fathom_modbus_config_t *config, uint32_t timeout_us,
                                       uint32_t pace_us);

/** @brief Cancels what is in progress. */
void fathom_dyp_modbus_deinit(fathom_dyp_modbus_t *sensor);

/** @brief Reports that the sensor is powered now: for `start_us`, no response is FATHOM_ERR_WARMING_UP. */
void fathom_dyp_modbus_power_on(fathom_dyp_modbus_t *sensor);

/**
 * @brief Reads one register. Call it until it does not return FATHOM_PENDING.
 *
 * @param sensor   The driver.
 * @param address  The register. Registers that are used at the same time must differ in their bits 0 to 3, 8 or 9, as
 *                 all registers of A16 and A05 do.
 * @param value    Written on FATHOM_OK only.
 * @return FATHOM_OK, FATHOM_PENDING, or an error of fathom_modbus_command().
 */
fathom_status_t fathom_dyp_modbus_get_register(fathom_dyp_modbus_t *sensor, uint16_t address,
                                               uint16_t *value);

/**
 * @brief Sets one register as fathom_modbus_set() does. Call it until it does not return FATHOM_PENDING.
 *
 * @param sensor   The driver.
 * @param address  The register, as in fathom_dyp_modbus_get_register().
 * @param value    The wanted value.
 * @retval FATHOM_ERR_ARGUMENT  The unit has address 0, so all units would obey. Nothing is written.
 * @return All other values are those of fathom_modbus_set().
 */
fathom_status_t fathom_dyp_modbus_set_register(fathom_dyp_modbus_t *sensor, uint16_t address, uint16_t value);

/**
 * @brief Writes one register that cannot be read back. Call it until it does not return FATHOM_PENDING.
 *
 * The address of the unit is read first. This shows the line whether the adapter echoes; without that an acknowledgement
 * proves nothing (line.h). FATHOM_OK is the acknowledgement.
 *
 * @param sensor   The driver.
 * @param address  The register, as in fathom_dyp_modbus_get_register().
 * @param value    The value.
 * @retval FATHOM_ERR_ARGUMENT  The unit has address 0, so all units would obey. Nothing is written.
 * @return All other values are those of fathom_modbus_set().
 */
fathom_status_t fathom_dyp_modbus_write_register(fathom_dyp_modbus_t *sensor, uint16_t address,
                                                 uint16_t value);

/**
 * @brief Reads the address from its register. Call it until it does not return FATHOM_PENDING.
 * @param sensor   The driver.
 * @param address  Written on FATHOM_OK only.
 * @retval FATHOM_ERR_MALFORMED  The register has a value above 255.
 * @return All other values are those of fathom_dyp_modbus_get_register().
 */
fathom_status_t fathom_dyp_modbus_get_address(fathom_dyp_modbus_t *sensor, uint8_t *address);

/**
 * @brief Sets the address. Call it until it does not return FATHOM_PENDING.
 * @param sensor   The driver. It follows the unit to its new address.
 * @param address  The new address, 1 to 254.
 * @retval FATHOM_ERR_ARGUMENT  The address is outside this range, or the unit has address 0. Nothing is written.
 * @return All other values are those of fathom_modbus_set().
 */
fathom_status_t fathom_dyp_modbus_set_address(fathom_dyp_modbus_t *sensor, uint8_t address);

/**
 * @brief Sets the address 0, as fathom_a16_modbus_set_address_0() describes.
 * @param sensor  The driver.
 * @return As fathom_dyp_modbus_set_address().
 */
fathom_status_t fathom_dyp_modbus_set_address_0(fathom_dyp_modbus_t *sensor);

/**
 * @brief Reads one register as fathom_dyp_modbus_get_register() does, without fathom_modbus_unit_poll().
 * @param sensor   The driver.
 * @param address  The register.
 * @param value    Written on FATHOM_OK only.
 * @return As fathom_dyp_modbus_get_register().
 */
fathom_status_t fathom_dyp_modbus_look(fathom_dyp_modbus_t *sensor, uint16_t address, uint16_t *value);

/**
 * @brief Fills in all members of a setting of one register except `read`.
 * @param sensor   The driver.
 * @param setting  The setting.
 * @param address  The register.
 * @param value    The wanted value.
 */
void fathom_dyp_modbus_describe(fathom_dyp_modbus_t *sensor, fathom_modbus_setting_t *setting,
                                uint16_t address, uint16_t value);

/* ---- The only device on a line ---- */

/** @brief The state of fathom_dyp_modbus_find(), in the caller's memory. Zero it before the first call. */
typedef struct {
    /* private */
    fathom_modbus_request_t request;
    uint16_t value;
    bool is_asked;
} fathom_dyp_modbus_find_t;

/**
 * @brief Finds the address of an A16 or A05 that is the only device on its line.
 *
 * The function reads register 0x0200 at address 255, "the broadcast address" (A16 6(3), A05 3(3)), which changes
 * nothing. Call it until it does not return FATHOM_PENDING; it polls the line. The line settings stay as they are.
 * Each result is returned once; the next call starts again. All units are quarantined for up to two seconds.
 *
 * @param find       The state.
 * @param transport  The transport. Must stay valid until the result.
 * @param address    Written on FATHOM_OK only: the address that the response came from, 0 to 254; if that is 255, the
 *                   value of the register.
 * @retval FATHOM_OK               The address was found.
 * @retval FATHOM_PENDING          There is no result yet.
 * @retval FATHOM_ERR_NO_RESPONSE  Nothing arrived for a second. The datasheets do not say whether a unit responds.
 * @retval FATHOM_ERR_CHECKSUM     The response was damaged; perhaps several units responded at once.
 * @retval FATHOM_ERR_MALFORMED    The value is no address.
 * @return Other errors are those of fathom_transaction_t.
 */
fathom_status_t fathom_dyp_modbus_find(fathom_dyp_modbus_find_t *find, const fathom_modbus_t *transport,
                                       uint8_t *address);

/**
 * @brief Cancels the search. After the call the memory is the caller's.
 * @param find       The state.
 * @param transport  The transport of the search.
 */
void fathom_dyp_modbus_find_cancel(fathom_dyp_modbus_find_t *find, const fathom_modbus_t *transport);

/**
 * @brief The member `poll` of the fathom_sensor_t of a driver.
 *
 * A value that is refused does not affect the values of the other probes, because the CRC confirms their places.
 *
 * @param ctx     The driver, a fathom_dyp_modbus_t.
 * @param sample  Written with FATHOM_OK only.
 * @return As fathom_a16_modbus_poll(), fathom_a05_modbus_poll() and fathom_a05_dyp_poll().
 */
fathom_status_t fathom_dyp_modbus_sensor_poll(void *ctx, fathom_sample_t *sample);

/**
 * @brief The member `due_us` of the fathom_sensor_t of a driver.
 *
 * @param ctx  The driver, a fathom_dyp_modbus_t.
 * @return As fathom_due_us().
 */
uint32_t fathom_dyp_modbus_sensor_due_us(void *ctx);

/** @brief Returns the sensor for fathom_poll() and fathom_due_us(). */
static inline fathom_sensor_t fathom_dyp_modbus_sensor(fathom_dyp_modbus_t *sensor)
{
    return fathom_sensor_make(fathom_dyp_modbus_sensor_poll, fathom_dyp_modbus_sensor_due_us, sensor);
}

#ifdef __cplusplus
}
#endif

#endif
