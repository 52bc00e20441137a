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

/**
 * @file
 * @brief Measures with an A05 on RS-485 by the `55 AA` frames of its "DYP protocol" (datasheet A05 2).
 *
 * The driver sends one command again and again, for all four probes or for one, and each response is one sample for
 * each wanted probe. The line has 9600 baud and 8N1. The driver never waits and never allocates memory. include/COST.md
 * has its flash, RAM and stack (`a05_dyp`). Prefer Modbus (a05_modbus.h), which the same module speaks on the same
 * wires: its checksum has 16 bits instead of 8.
 *
 * @warning Use these frames with one A05 on the line. One flipped bit in a response (command 01 to 03) makes it a
 * request that gives its address to every other A05 of the line.
 *
 * @code
 * static fathom_a05_dyp_t bumper;
 * fathom_a05_dyp_init(&bumper, &line, NULL);         // address 1, all four probes
 * const fathom_sensor_t sensor = fathom_a05_dyp_sensor(&bumper);
 *
 * fathom_sample_t near;                              // in the loop: each probe is one sample
 * while (fathom_poll(&sensor, &near) == FATHOM_OK)
 *     if (near.kind == FATHOM_TARGET) use(near.distance_mm);
 * @endcode
 *
 * 1. **Samples, errors, refused values and bound** are those of a05_modbus.h (rules 1 to 3 and 5), with two
 *    differences. This protocol has no exceptions, so there is no FATHOM_ERR_EXCEPTION. FATHOM_ERR_CHECKSUM is a wrong
 *    sum. With the defaults, alone on its line and polled each millisecond, a response comes each 0.25 s; an unplugged
 *    sensor is FATHOM_ERR_NO_RESPONSE after 0.51 s, and later errors are up to 8.5 s apart, because the driver asks a
 *    silent unit less and less often (`modbus.backoff_us`). So long can the first response after a return take, too.
 *
 * 2. **What `sequence` promises.** All samples of one response have one `sequence` and one `time_us`. `sequence`
 *    increases by 1 with each response and wraps after 65535. Each command starts a measurement (A05 2(3)), which takes
 *    200 to 210 ms for all probes and 65 to 75 ms for one. So a new number is a new measurement. If commands
 *    came sooner, a module could send the previous value. So the driver keeps the least period of the datasheet: 250 ms
 *    for all probes, 100 ms for one.
 */

/**
 * @brief The facts that NULL selects: 1 to 6000 mm, the default meanings, and the least time from one command to the
 * next (A05 2(3)1): `period_ms` is 100 ms for one probe. For all probes the driver takes two and a half times as much.
 */
extern const fathom_model_facts_t fathom_a05_dyp_model;

/** @brief Configuration. Read only during fathom_a05_dyp_init(). A member that is 0 takes its default. */
typedef struct {
    /**
     * @brief Connection to the sensor; fathom/engine/internal/modbus_unit.h explains its members.
     *
     * | member         | range here                                      | 0 selects                        |
     * |----------------|-------------------------------------------------|----------------------------------|
     * | `address`      | 1 to 254 (A05 2(3)2)                            | 1                                |
     * | `address_zero` | false                                           |                                  |
     * | `period_us`    | up to 2^31 - 1; at least that of the datasheet  | 250 ms, or 100 ms for one probe  |
     * | `timeout_us`   | 1 to 2^31 - 1                                   | 500 ms, or 200 ms for one probe  |
     */
    fathom_modbus_config_t modbus;

    /**
     * @brief Start-up time after fathom_a05_dyp_power_on(), in microseconds: 1 to 2^31 - 1. 0 selects 1.5 s.
     *
     * Sister models need about 900 ms; the datasheet states no time.
     */
    uint32_t start_us;

    /**
     * @brief The facts of the model (model_facts.h), such as those of models.h. NULL selects fathom_a05_dyp_model.
     *
     * Must stay valid until fathom_a05_dyp_deinit().
     */
    const fathom_model_facts_t *model;

    /**
     * @brief Wanted probes, bit (probe - 1): 1 to 15. 0 selects all four.
     *
     * If one probe is wanted, the driver measures only this probe, which is faster. Else it measures all four.
     */
    uint8_t probes;
} fathom_a05_dyp_config_t;

/**
 * @brief A driver, in the caller's memory. Call fathom_a05_dyp_init() before use.
 *
 * The caller may read `implausible`, `refused_probe` and `refused_raw` of `base.measurement`. All other members are
 * private.
 */
typedef struct {
    fathom_dyp_modbus_t base; /**< The part that A16 and A05 share. */
    /* private */
    uint16_t values[FATHOM_DYP_PROBES]; /* the values of the newest response */
} fathom_a05_dyp_t;

/**
 * @brief Initialises a driver. Nothing is sent before the first poll.
 *
 * @param sensor  The driver, in any memory. Must stay valid until fathom_a05_dyp_deinit().
 * @param line    The line, initialised. Must stay valid as long as the driver.
 * @param config  The config. Read only during the call; what it points to must stay valid as long as the driver. NULL
 *                selects all defaults.
 * @retval FATHOM_OK            The driver can be used. Next, pass fathom_a05_dyp_sensor() to fathom_poll().
 * @retval FATHOM_ERR_ARGUMENT  `line` is NULL or not initialised, the address is 255, `address_zero` is true, `probes`
 *                              is above 15, `min_mm` is above `max_mm`, another member is outside its range, or the
 *                              frame buffer of the line has less than 13 bytes. The driver is zeroed: each poll and
 *                              command returns FATHOM_ERR_ARGUMENT.
 * @retval FATHOM_ERR_BUSY      A request of this driver is still queued. Nothing changed. Call fathom_a05_dyp_deinit()
 *                              first.
 */
fathom_status_t fathom_a05_dyp_init(fathom_a05_dyp_t *sensor, fathom_line_t *line,
                                    const fathom_a05_dyp_config_t *config);

/** @brief Cancels what is in progress. After this the memory is the caller's again. */
void fathom_a05_dyp_deinit(fathom_a05_dyp_t *sensor);

/** @brief Returns the unit, whose requests fathom_modbus_unit_responses() and fathom_modbus_unit_failures() count. */
static inline const fathom_modbus_unit_t *fathom_a05_dyp_unit(const fathom_a05_dyp_t *sensor)
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
static inline fathom_status_t fathom_a05_dyp_poll(fathom_a05_dyp_t *sensor, fathom_sample_t *sample)
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
static inline uint32_t fathom_a05_dyp_due_us(fathom_a05_dyp_t *sensor)
{
    return fathom_dyp_modbus_sensor_due_us(&sensor->base);
}

/** @brief Returns the sensor for fathom_poll() and fathom_due_us(), by value. It points to the driver. */
static inline fathom_sensor_t fathom_a05_dyp_sensor(fathom_a05_dyp_t *sensor)
{
    return fathom_dyp_modbus_sensor(&sensor->base);
}

/**
 * @brief Reports to the driver that the sensor is powered now. Call it when the supply is switched on.
 *
 * The driver cancels what is in progress. For `start_us` after the call, no response and a damaged response become
 * FATHOM_ERR_WARMING_UP. If the program does not know when the sensor is powered, do not call this function; the errors
 * are then reported unchanged.
 */
void fathom_a05_dyp_power_on(fathom_a05_dyp_t *sensor);

/**
 * @brief Gives EVERY A05 of the line this address.
 *
 * The command (A05 2(3)5) contains the new address and no old one, so have one A05 on the line. If there are several,
 * fathom_a05_modbus_set_address() reaches one of them.
 *
 * The call returns at once: call it again until its result differs from FATHOM_PENDING. Until then fathom_poll()
 * returns FATHOM_PENDING. The driver reads at its present address, then at the new one, where no unit may respond. It
 * sends the command once and reads at the new address. That takes about 2 s. The response to the command equals the
 * request, so it proves nothing: only the read at the new address does.
 *
 * @param sensor   The driver.
 * @param address  The new address, 1 to 254.
 * @retval FATHOM_OK               The sensor responded at the new address, which the driver uses from now on.
 * @retval FATHOM_PENDING          Call again with the same argument.
 * @retval FATHOM_ERR_ARGUMENT     The address is 0 or 255, or the driver is not initialised.
 * @retval FATHOM_ERR_IN_USE       A unit responds at the new address, or noise that may be a damaged response arrived.
 *                                 Nothing was sent.
 * @retval FATHOM_ERR_WARMING_UP   The sensor was powered a short time ago, so silence does not prove that the address
 *                                 is free. Nothing was sent. Try again later.
 * @retval FATHOM_ERR_UNCONFIRMED  The command was sent, and the sensor responds at neither address: it has one of the
 *                                 two. The driver uses the former one.
 * @retval FATHOM_ERR_BUSY         Another command is not finished.
 * @return Other errors of fathom_poll(). If fathom_a05_dyp_is_written() is false, nothing was changed.
 */
fathom_status_t fathom_a05_dyp_broadcast_address(fathom_a05_dyp_t *sensor, uint8_t address);

/**
 * @brief Returns true if the newest command to set the address was passed to the line.
 *
 * The value belongs to the command in progress, or else to the newest one.
 */
bool fathom_a05_dyp_is_written(const fathom_a05_dyp_t *sensor);

/**
 * @brief Cancels the measurement or command in progress. The driver can be used at once.
 *
 * An address that was being set may be set or not. The driver uses the former one.
 */
void fathom_a05_dyp_cancel(fathom_a05_dyp_t *sensor);

/* ---- the address of the one A05 on a line ---- */

/** @brief A search for the address of a module, in the caller's memory. Zero it before the first call. */
typedef struct {
    /* private */
    fathom_modbus_request_t request; /* the request to measure the first probe */
    uint16_t value;                  /* its distance */
    bool is_asked;                   /* true if the request was submitted and its result was not returned */
} fathom_a05_dyp_find_t;

/**
 * @brief Finds the address of the only A05 on a line.
 *
 * The function sends the request to measure the first probe, which changes nothing, to address FF, and takes the
 * address from the first response. It polls the line. The call returns at once: call it again until its result differs
 * from FATHOM_PENDING. Each result is returned once; the next call starts again.
 *
 * @param find     The search. Must stay valid until the result or fathom_a05_dyp_find_cancel().
 * @param line     The line, which must stay valid as long as the search. Its settings are not changed.
 * @param address  Written with FATHOM_OK.
 * @retval FATHOM_OK               `*address` is the address in the response.
 * @retval FATHOM_PENDING          Call again.
 * @retval FATHOM_ERR_NO_RESPONSE  No response within 200 ms. The datasheet does not state whether a unit responds to FF
 *                                 (A05 2(3)2).
 * @retval FATHOM_ERR_CHECKSUM     A damaged response arrived; perhaps several units responded at once.
 * @retval FATHOM_ERR_CAPACITY     The frame buffer of the line has less than 13 bytes.
 * @return Other values: as fathom_transaction_t::status.
 */
fathom_status_t fathom_a05_dyp_find(fathom_a05_dyp_find_t *find, fathom_line_t *line, uint8_t *address);

/**
 * @brief Cancels a search. After this the memory is the caller's again.
 *
 * @param find  The search.
 * @param line  The line of the search.
 */
void fathom_a05_dyp_find_cancel(fathom_a05_dyp_find_t *find, fathom_line_t *line);

#ifdef __cplusplus
}
#endif

#endif
