/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_A05_MODBUS_H
#define FATHOM_A05_MODBUS_H

#include "fathom/codec/dyp_stream.h"
#include "fathom/sensor/internal/dyp_modbus.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief Measures with an A05, a module with four ultrasonic probes, by Modbus RTU (datasheet A05 3).
 *
 * The driver reads the distance registers of the wanted probes again and again, and each response is one sample for
 * each wanted probe. It is for the RS485 variant and for the UART variant, both at 9600 baud and 8N1. It never waits
 * and never allocates memory. include/COST.md has its flash, RAM and stack (`a05_modbus`). For an A05 that sends
 * without a request see a05_auto.h, and for its other protocol a05_dyp.h.
 *
 * @warning The first Modbus request stops the automatic output of the UART variant until the module is powered off and
 * on (A05 1(1)).
 *
 * @code
 * static fathom_a05_modbus_t bumper;                 // `modbus` is a transport: see hps167s.h
 * const fathom_a05_modbus_config_t config = {.modbus = {.address = 1}, .probes = 0x03};
 * fathom_a05_modbus_init(&bumper, &modbus, &config);
 * const fathom_sensor_t sensor = fathom_a05_modbus_sensor(&bumper);
 *
 * fathom_sample_t near;                              // in the loop: probes 1 and 2 are one sample each
 * while (fathom_poll(&sensor, &near) == FATHOM_OK)
 *     if (near.kind == FATHOM_TARGET) use(near.distance_mm);
 * @endcode
 *
 * 1. **Samples.** `kind` is FATHOM_TARGET if the value is inside the range (1 to 6000 mm by default). The facts of
 *    the model give the values 0, FFFB, FFFD, FFFE and FFFF their meaning (dyp.h). By default FFFD is FATHOM_NO_TARGET,
 *    FFFE is FATHOM_NO_TARGET with `interference`, 0 is FATHOM_UNKNOWN, and FFFF is refused.
 *
 * 2. **Errors of fathom_poll().** Each is the result of one request after its retries (line.h, rule 8). A refused
 *    value (rule 3) is not retried. The driver continues after each error. The datasheet documents no exceptions, so a
 *    unit may respond with silence to a register that it does not have.
 *
 *    | error                   | cause                                                                     |
 *    |-------------------------|---------------------------------------------------------------------------|
 *    | FATHOM_ERR_NO_RESPONSE  | The unit did not respond within `timeout_us`. Check power and wiring.     |
 *    | FATHOM_ERR_CHECKSUM     | A response was damaged. Check baud rate, parity, termination and ground.  |
 *    | FATHOM_ERR_EXCEPTION    | The unit refused the request: see fathom_a05_modbus_exception().          |
 *    | FATHOM_ERR_MALFORMED    | The unit sent another frame, or the value of one probe is refused (rule 3). |
 *    | FATHOM_ERR_WARMING_UP   | The unit was powered a short time ago: see fathom_a05_modbus_power_on().  |
 *    | FATHOM_ERR_PORT         | The port is broken. Returned by every poll while it cannot be read.       |
 *    | FATHOM_ERR_LINE_BUSY    | The line was never silent. This says nothing about the unit (status.h).   |
 *    | FATHOM_ERR_OTHER_MASTER | Another master sent the unit a request. This says nothing about the unit. |
 *    | FATHOM_ERR_CANCELLED    | The line was initialised again. Or another driver changed the address of  |
 *    |                         | this unit: initialise this driver with the new address.                   |
 *    | FATHOM_ERR_UNSUPPORTED  | `line_settings` cannot be set, or the line only listens.                  |
 *    | FATHOM_ERR_ARGUMENT     | The driver is not initialised.                                            |
 *
 * 3. **Refused values.** A value outside the range, or FFFF, is no sample. The driver counts it in
 *    `base.measurement.implausible` and stores it in `refused_raw` and `refused_probe` there. The other probes of this
 *    response are returned, because the CRC vouches for their place.
 *
 * 4. **What `sequence` promises.** All samples of one response have one `sequence` and one `time_us`. `sequence`
 *    increases by 1 with each response and wraps after 65535. Each request starts a measurement of the probes that it
 *    reads, one after the other, about 100 ms each (A05 3(3)). So a new number is a new measurement. If requests
 *    came sooner, a module could send the previous value. So the driver waits `period_ms` of the facts, 100 ms by
 *    default, for each probe between two requests.
 *
 * 5. **Bound.** fathom_poll() returns a sample or an error at the latest after
 *
 *        period_us + least(16 * timeout_us, backoff_us) + B(timeout_us, retries) + S + P
 *
 *    B is the bound of one transaction alone on its line (line.h, rule 13). S is the sum of the bounds of the line's
 *    other transactions. P is the longest time between two polls. While a command or a setting of this driver is in
 *    progress, fathom_poll() returns FATHOM_PENDING, so the time of the command or setting is added. modbus_unit.h has
 *    the rules of pace, back-off and abandoned commands.
 */

/** @brief The facts that NULL selects: 1 to 6000 mm, the default meanings, and 100 ms for each probe (rule 4). */
extern const fathom_model_facts_t fathom_a05_modbus_model;

/** @brief Register of the first probe. The same four distances stand in two places (A05 3(3), remark 2). */
enum {
    FATHOM_A05_REGISTERS = 0x0106,      /**< 0x0106 to 0x0109, the default. */
    FATHOM_A05_REGISTERS_ALIAS = 0x0010 /**< 0x0010 to 0x0013. */
};

/** @brief Configuration. Read only during fathom_a05_modbus_init(). A member that is 0 takes its default. */
typedef struct {
    /**
     * @brief Connection to the sensor; fathom/engine/internal/modbus_unit.h explains its members.
     *
     * With n registers from the first to the last wanted probe, `period_us` is at least n * 100 ms, and a `timeout_us`
     * of 0 selects 200 ms + n * 100 ms.
     */
    fathom_modbus_config_t modbus;

    /**
     * @brief Start-up time after fathom_a05_modbus_power_on(), in microseconds: 1 to 2^31 - 1. 0 selects 1.5 s.
     *
     * Sister models need about 900 ms; the datasheet states no time.
     */
    uint32_t start_us;

    /**
     * @brief The facts of the model (model_facts.h), such as those of models.h. NULL selects fathom_a05_modbus_model.
     *
     * Must stay valid until fathom_a05_modbus_deinit().
     */
    const fathom_model_facts_t *model;

    /** @brief FATHOM_A05_REGISTERS or FATHOM_A05_REGISTERS_ALIAS. 0 selects the former. */
    uint16_t registers;

    /**
     * @brief Wanted probes, bit (probe - 1): 1 to 15. 0 selects all four.
     *
     * One request measures all probes from the first to the last wanted one. Leave out probes that are not fitted:
     * their value is not defined.
     */
    uint8_t probes;
} fathom_a05_modbus_config_t;

/**
 * @brief A driver, in the caller's memory. Call fathom_a05_modbus_init() before use.
 *
 * The caller may read `implausible`, `refused_probe` and `refused_raw` of `base.measurement` (rule 3). All other
 * members are private.
 */
typedef struct {
    fathom_dyp_modbus_t base; /**< The part that A16 and A05 share. */
    /* private */
    uint16_t values[FATHOM_DYP_PROBES]; /* the registers of the newest response */
} fathom_a05_modbus_t;

/**
 * @brief Initialises a driver. Nothing is sent before the first poll.
 *
 * @param sensor     The driver, in any memory. Must stay valid until fathom_a05_modbus_deinit().
 * @param transport  The transport: `modbus` of a bus, or the result of fathom_modbus_client(). Copied; its line must stay
 *                   valid as long as the driver.
 * @param config     The config. Read only during the call; what it points to must stay valid as long as the driver.
 *                   NULL selects all defaults.
 * @retval FATHOM_OK            The driver can be used. Next, pass fathom_a05_modbus_sensor() to fathom_poll().
 * @retval FATHOM_ERR_ARGUMENT  `transport` has no initialised line, the address is 255, `address_zero` is true and
 *                              `address` is not 0, `registers` or `probes` has no such value, `min_mm` is above
 *                              `max_mm`, another member is outside its range, or the frame buffer of the line has less
 *                              than 5 bytes and 2 for each register. The driver is zeroed: each poll and command
 *                              returns FATHOM_ERR_ARGUMENT.
 * @retval FATHOM_ERR_BUSY      A request of this driver is still queued. Nothing changed. Call
 *                              fathom_a05_modbus_deinit() first.
 */
fathom_status_t fathom_a05_modbus_init(fathom_a05_modbus_t *sensor, const fathom_modbus_t *transport,
                                       const fathom_a05_modbus_config_t *config);

/** @brief Cancels what is in progress. After this the memory is the caller's again. */
void fathom_a05_modbus_deinit(fathom_a05_modbus_t *sensor);

/**
 * @brief Reports to the driver that the sensor is powered now. Call it when the supply is switched on.
 *
 * The driver cancels what is in progress. For `start_us` after the call, three results become FATHOM_ERR_WARMING_UP: no
 * response, a damaged response, and an exception. If the program does not know when the sensor is powered, do not call
 * this function; the errors are then reported unchanged.
 */
void fathom_a05_modbus_power_on(fathom_a05_modbus_t *sensor);

/**
 * @brief Reads the address from register 0x0200 (A05 3(3)).
 *
 * The call returns at once: call it again until its result differs from FATHOM_PENDING. Until then fathom_poll()
 * returns FATHOM_PENDING. The response takes at most `command_timeout_us`.
 *
 * @param sensor   The driver.
 * @param address  Written with FATHOM_OK.
 * @retval FATHOM_OK             `*address` is written.
 * @retval FATHOM_PENDING        Call again.
 * @retval FATHOM_ERR_MALFORMED  The register has more than 255, or as in rule 2.
 * @retval FATHOM_ERR_BUSY       Another command or setting is not finished.
 * @return Other values: rule 2.
 */
fathom_status_t fathom_a05_modbus_get_address(fathom_a05_modbus_t *sensor, uint8_t *address);

/**
 * @brief Sets the address of the sensor: register 0x0200 (A05 3(3)).
 *
 * The call returns at once: call it again until its result differs from FATHOM_PENDING. Until then fathom_poll()
 * returns FATHOM_PENDING. The driver reads the present address, reads at the new one, where no unit may respond, writes
 * once, and reads at the new address. That takes about 3 s. With FATHOM_OK the driver uses the new address. Requests of
 * other drivers that wait for the present address end with FATHOM_ERR_CANCELLED.
 *
 * @param sensor   The driver.
 * @param address  The new address, 1 to 254.
 * @retval FATHOM_OK               The sensor responded at the new address.
 * @retval FATHOM_PENDING          Call again with the same argument.
 * @retval FATHOM_ERR_ARGUMENT     The address is 0 or 255, or the driver is at address 0, where all units would obey.
 * @retval FATHOM_ERR_IN_USE       A unit responds at the new address, or noise that may be a damaged response arrived.
 *                                 Nothing was written.
 * @retval FATHOM_ERR_WARMING_UP   The sensor was powered a short time ago, so silence does not prove that the address
 *                                 is free. Nothing was written. Try again later.
 * @retval FATHOM_ERR_UNCONFIRMED  The address was sent, and the sensor responds at neither address: it has one of the
 *                                 two. The driver uses the former one.
 * @retval FATHOM_ERR_BUSY         Another command or setting is not finished.
 * @return Other values: rule 2. If fathom_a05_modbus_is_written() is false, nothing was written.
 */
fathom_status_t fathom_a05_modbus_set_address(fathom_a05_modbus_t *sensor, uint8_t address);

/**
 * @brief Returns true if the newest setting was passed to the line to be written.
 *
 * The value belongs to the setting in progress, or else to the newest one.
 */
bool fathom_a05_modbus_is_written(const fathom_a05_modbus_t *sensor);

/**
 * @brief Sets the address to 0, which may make the sensor UNREACHABLE.
 *
 * 0 is in the range of the datasheet (A05 3(3)) and is also the broadcast address of Modbus. A unit need not respond
 * there, and what is written there reaches all units. From FATHOM_OK on the driver reads the sensor at address 0 and
 * sets nothing any more.
 *
 * @param sensor  The driver.
 * @return As fathom_a05_modbus_set_address().
 */
fathom_status_t fathom_a05_modbus_set_address_0(fathom_a05_modbus_t *sensor);

/**
 * @brief Cancels the measurement, command or setting in progress. The driver can be used at once.
 *
 * An address that was being set may be set or not. The driver uses the former one.
 */
void fathom_a05_modbus_cancel(fathom_a05_modbus_t *sensor);

/**
 * @brief Returns the exception code of the newest response, valid after FATHOM_ERR_EXCEPTION until the next request. 0:
 * no exception.
 */
static inline uint8_t fathom_a05_modbus_exception(const fathom_a05_modbus_t *sensor)
{
    return fathom_modbus_unit_exception(&sensor->base.unit);
}

/** @brief Returns the unit, whose requests fathom_modbus_unit_responses() and fathom_modbus_unit_failures() count. */
static inline const fathom_modbus_unit_t *fathom_a05_modbus_unit(const fathom_a05_modbus_t *sensor)
{
    return &sensor->base.unit;
}

/**
 * @brief Polls the driver as fathom_poll() does, without a fathom_sensor_t.
 *
 * A program that calls only this function does not link the part of the driver that fathom_due_us() needs.
 *
 * @param sensor  The driver.
 * @param sample  Written with FATHOM_OK only.
 * @retval FATHOM_OK            `*sample` is the reading of one probe. Call again at once for the next one.
 * @retval FATHOM_PENDING       There is nothing new.
 * @retval FATHOM_ERR_ARGUMENT  The initialisation failed or never ran, and the memory is zeroed.
 * @return Other errors: an attempt failed. This header lists them as errors of fathom_poll().
 */
static inline fathom_status_t fathom_a05_modbus_poll(fathom_a05_modbus_t *sensor, fathom_sample_t *sample)
{
    return fathom_dyp_modbus_sensor_poll(&sensor->base, sample);
}

/**
 * @brief Returns the time in microseconds until the driver must be polled again if no byte arrives.
 *
 * The result is that of fathom_due_us(), without a fathom_sensor_t. It is 0 for a driver in zeroed memory.
 *
 * @param sensor  The driver.
 */
static inline uint32_t fathom_a05_modbus_due_us(fathom_a05_modbus_t *sensor)
{
    return fathom_dyp_modbus_sensor_due_us(&sensor->base);
}

/** @brief Returns the sensor for fathom_poll() and fathom_due_us(), by value. It points to the driver. */
static inline fathom_sensor_t fathom_a05_modbus_sensor(fathom_a05_modbus_t *sensor)
{
    return fathom_dyp_modbus_sensor(&sensor->base);
}

#ifdef __cplusplus
}
#endif

#endif
