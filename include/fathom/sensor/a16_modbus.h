/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_A16_MODBUS_H
#define FATHOM_A16_MODBUS_H

#include "fathom/sensor/internal/dyp_modbus.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief Reads the distances of an A16 by Modbus RTU (A16 6): the RS485 variant, and the RS232 variant. 9600 8N1.
 *
 * The driver reads register 0x0100 (processed) or 0x0101 (real-time) again and again and returns one sample for each
 * response. The driver never writes to the module and never waits. a16_settings.h has all other registers.
 * include/COST.md has its size in the row `a16_modbus`.
 *
 * @code
 * static fathom_modbus_t transport;                         // must stay valid as long as the driver
 * transport = fathom_modbus_client(&line);
 * fathom_a16_modbus_init(&a16, &transport, NULL);      // address 1, the processed distance
 * sensor = fathom_a16_modbus_sensor(&a16);
 * for (;;)
 *     if (fathom_poll(&sensor, &sample) == FATHOM_OK && sample.kind == FATHOM_TARGET) show_mm(sample.distance_mm);
 * @endcode
 *
 * 1. **RS232.** The first Modbus request stops the automatic output of an RS232 module. The output does not return
 *    without a power cycle or a write to register 0x0202 (A16 5). a16_rs232.h does this.
 *
 * 2. **Samples.** The kind is FATHOM_TARGET, or the meaning of a value that is no distance (dyp.h). `time_us` is
 *    the arrival of the last byte of the response.
 *
 * 3. **Sequence.** Each response increments `sequence`, a response with a refused value too. A value that is read
 *    sooner than the module measures is the old value; no response shows this. The datasheet prints no period for
 *    Modbus. It prints 120 ms for a triggered measurement (A16 3(2)). The facts of the model have the least period of
 *    the driver.
 *
 * 4. **Time.** The longest time until fathom_poll() returns a sample or an error is, in the terms of modbus_unit.h:
 *
 *        period_us + least(16 * timeout_us, backoff_us) + B(timeout_us, retries) + S + P
 *
 *    B is the bound of a transaction alone on its line (line.h). S is the sum of the bounds of the other transactions
 *    of the line. P is the longest time between two polls. If a command or setting of this driver is in progress, add
 *    its time (a16_settings.h).
 *
 * 5. **Errors.** Each error is the result of one request after its retries (line.h, rule 8). A refused value is not
 *    retried. The driver continues after each error.
 *
 * | error of fathom_poll() | cause |
 * |---|---|
 * | FATHOM_ERR_NO_RESPONSE | the unit did not respond within `timeout_us`; the datasheet documents no exceptions |
 * | FATHOM_ERR_CHECKSUM | the response was damaged |
 * | FATHOM_ERR_EXCEPTION | the unit refused; fathom_a16_modbus_exception() returns the exception code |
 * | FATHOM_ERR_MALFORMED | the unit sent another frame, or a refused value: outside the range, or FFFF |
 * | FATHOM_ERR_WARMING_UP | no reading yet so soon after fathom_a16_modbus_power_on() |
 * | FATHOM_ERR_PORT | the port is broken; returned by every poll while it cannot be read |
 * | FATHOM_ERR_LINE_BUSY | the line was never silent; says nothing about the unit (status.h) |
 * | FATHOM_ERR_OTHER_MASTER | another master sent the unit a request; says nothing about the unit |
 * | FATHOM_ERR_CANCELLED | the line was initialised again |
 * | FATHOM_ERR_CANCELLED | another driver changed the address of this unit: initialise this driver with the new one |
 * | FATHOM_ERR_UNSUPPORTED | `line_settings` cannot be set, or the line only listens |
 * | FATHOM_ERR_ARGUMENT | the driver is not initialised |
 *
 * A refused value increments `base.measurement.implausible` and stands in `base.measurement.refused_raw` (dyp.h).
 */

/** @brief Registers of the distances (A16 6(3)). The datasheet documents reads of one register only. */
enum {
    FATHOM_A16_REGISTER_PROCESSED = 0x0100, /**< Processed distance, in millimetres. */
    FATHOM_A16_REGISTER_REAL_TIME = 0x0101  /**< Real-time distance, in millimetres. */
};

/** @brief The facts that NULL selects: 1 to 16350 mm, the default meanings, and 120 ms between two requests (rule 3). */
extern const fathom_model_facts_t fathom_a16_modbus_model;

/** @brief The configuration. A member that is 0 takes its default. */
typedef struct {
    /**
     * @brief Address and times (fathom_modbus_config_t).
     *
     * `timeout_us` 0 selects 1 s for the processed value and 300 ms for the real-time value. Sister models respond
     * within 520 ms and 120 ms; the datasheet prints no time. A
     * `period_us` below `period_ms` of the model selects that; with the default facts it is 120 ms.
     */
    fathom_modbus_config_t modbus;

    /**
     * @brief Start-up time after fathom_a16_modbus_power_on(), in microseconds, 1 to 2^31 - 1. 0 selects 1.5 s.
     *
     * Sister models need 0.9 s; the datasheet prints no time.
     */
    uint32_t start_us;

    /**
     * @brief The facts of the model (model_facts.h), such as those of models.h. NULL selects fathom_a16_modbus_model.
     *
     * Must stay valid until fathom_a16_modbus_deinit().
     */
    const fathom_model_facts_t *model;

    /** @brief The distance that the driver reads: a fathom_dyp_value_t. 0 selects FATHOM_PROCESSED. */
    uint8_t value;
} fathom_a16_modbus_config_t;

/** @brief The driver, in the caller's memory. Call fathom_a16_modbus_init() before use. */
typedef struct {
    /** @brief The refused values of `base.measurement` may be read (dyp.h). */
    fathom_dyp_modbus_t base;

    /* private */
    uint16_t values[1];
} fathom_a16_modbus_t;

/**
 * @brief Initialises the driver. Sends nothing.
 *
 * @param sensor     The driver. Must stay valid until fathom_a16_modbus_deinit().
 * @param transport  The transport: `modbus` of a bus, or the result of fathom_modbus_client(). Copied; its line must stay
 *                   valid as long as the driver.
 * @param config     The configuration. Not used after the call. NULL selects all defaults.
 * @retval FATHOM_OK            The driver can be used. Next, call fathom_poll().
 * @retval FATHOM_ERR_ARGUMENT  `transport` has no initialised line, the buffer of its line is too small, or a member of
 *                              the configuration is outside its range. The driver is zeroed: each poll and command
 *                              then returns this error.
 * @retval FATHOM_ERR_BUSY      A request of this driver is still queued. Nothing has changed. Call
 *                              fathom_a16_modbus_deinit() first.
 */
fathom_status_t fathom_a16_modbus_init(fathom_a16_modbus_t *sensor, const fathom_modbus_t *transport,
                                       const fathom_a16_modbus_config_t *config);

/** @brief Cancels the request in progress. After the call the memory belongs to the caller again. */
void fathom_a16_modbus_deinit(fathom_a16_modbus_t *sensor);

/**
 * @brief Records that the sensor is powered now. Cancels the request, command or setting in progress.
 *
 * For `start_us`, silence, damage and exceptions are FATHOM_ERR_WARMING_UP. If the program does not know when the
 * sensor is powered, do not call this function; the errors are then reported unchanged.
 */
void fathom_a16_modbus_power_on(fathom_a16_modbus_t *sensor);

/**
 * @brief Returns the exception code of the last FATHOM_ERR_EXCEPTION, 1 to 255. 0: there was none.
 *
 * The code is valid until the next request.
 */
static inline uint8_t fathom_a16_modbus_exception(const fathom_a16_modbus_t *sensor)
{
    return fathom_modbus_unit_exception(&sensor->base.unit);
}

/** @brief Returns the unit, for fathom_modbus_unit_responses() and fathom_modbus_unit_failures(). */
static inline const fathom_modbus_unit_t *fathom_a16_modbus_unit(const fathom_a16_modbus_t *sensor)
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
 * @retval FATHOM_OK            `*sample` is a new reading. Call again at once for the next one.
 * @retval FATHOM_PENDING       There is nothing new.
 * @retval FATHOM_ERR_ARGUMENT  The initialisation failed or never ran, and the memory is zeroed.
 * @return Other errors: an attempt failed. This header lists them as errors of fathom_poll().
 */
static inline fathom_status_t fathom_a16_modbus_poll(fathom_a16_modbus_t *sensor, fathom_sample_t *sample)
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
static inline uint32_t fathom_a16_modbus_due_us(fathom_a16_modbus_t *sensor)
{
    return fathom_dyp_modbus_sensor_due_us(&sensor->base);
}

/** @brief Returns the sensor for fathom_poll() and fathom_due_us(). The sensor points to the driver. */
static inline fathom_sensor_t fathom_a16_modbus_sensor(fathom_a16_modbus_t *sensor)
{
    return fathom_dyp_modbus_sensor(&sensor->base);
}

#ifdef __cplusplus
}
#endif

#endif
