/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_HPS167S_INFO_H
#define FATHOM_HPS167S_INFO_H

#include "fathom/sensor/hps167s.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief Reads what an HPS-167S reports beside distances: version, configuration, details and temperature.
 *
 * The functions send the commands #1 to #4 of the datasheet, and no command that changes the sensor. They share the
 * driver, and so the unit, with the measurement of hps167s.h. No function waits: each returns FATHOM_PENDING until its
 * response has arrived. include/COST.md has the flash of a program that uses them (`hps167s_info`).
 *
 * @code
 * fathom_hps167s_configuration_t is;                 // in the loop, until the result differs from FATHOM_PENDING:
 * const fathom_status_t status = fathom_hps167s_get_configuration(&gate, &is);
 * if (status == FATHOM_OK && is.termination) warn("the termination resistor is on");
 * @endcode
 *
 * 1. **Calls.** Call a function again until its result differs from FATHOM_PENDING. `*out` is written with FATHOM_OK
 *    only, and is used only during the call.
 *
 * 2. **Turn.** A command waits for a measurement that is on the wire. Until the caller has fetched its result,
 *    fathom_poll() returns FATHOM_PENDING. fathom_hps167s_cancel() ends a command. If its caller stops calling, the
 *    command ends after FATHOM_MODBUS_ABANDONED_US (modbus_unit.h, rule 5).
 *
 * 3. **Errors.** All functions return the errors of fathom_poll() (hps167s.h, rule 2), and these:
 *
 *    | error               | cause                                                                                |
 *    |---------------------|--------------------------------------------------------------------------------------|
 *    | FATHOM_ERR_BUSY     | Another command or setting is not finished, or its result was not fetched. Call later. |
 *    | FATHOM_ERR_CAPACITY | The frame buffer of the line is too small: the details (#3) need 27 bytes.            |
 *
 * 4. **Bound.** With the terms of modbus_unit.h, a command ends at the latest after
 *
 *        C = period_us + B(timeout_us, retries) + B(command_timeout_us, retries) + 2 S + 2 P
 *
 *    The configuration (#2) needs several reads. It ends at the latest after 32 * (C + 131 ms) + command_timeout_us,
 *    and without unsolicited frames after 8 * C.
 */

/** @brief Temperature of the analog front end, not of the air (#4, table 16). */
typedef struct {
    /**
     * @brief The value as the sensor sends it, in steps of 1 / `steps_per_degree` of a degree Fahrenheit.
     *
     * The datasheet states neither sign nor scale. This library reads a signed value in whole degrees by default.
     */
    int16_t fahrenheit;

    /** @brief The temperature in tenths of a degree Celsius, rounded to the nearest. */
    int16_t temperature_dc;
} fathom_hps167s_temperature_t;

/**
 * @brief Reads date and version of the interface firmware (#1, table 10).
 *
 * @param sensor  The driver.
 * @param out     Written with FATHOM_OK.
 * @retval FATHOM_OK       `*out` is written.
 * @retval FATHOM_PENDING  Call again.
 * @return Other values: rule 3.
 */
fathom_status_t fathom_hps167s_get_interface_version(fathom_hps167s_t *sensor, fathom_hps167s_version_t *out);

/**
 * @brief Reads the configuration of the interface (#2, table 12).
 *
 * The response has the same shape as a measurement, and an unsolicited measurement may arrive in its place. So a
 * response counts only if all of these are true:
 *
 * - Its first two bytes are 00 or FF. Its baud code and reconnect time may have any value.
 * - It is not the abnormal packet (hps167s.h).
 * - It differs from the newest measurement of this unit, requested or unsolicited.
 *
 * The configuration is believed when `same_responses` (hps167s.h) of these in succession are equal. A response that
 * does not count is an unsolicited frame. For 2 s after it three responses must be equal, and the pause before each
 * read is irregular and up to 131 ms longer, so that the reads do not keep step with the sensor. Of all measured
 * distances only 255 mm passes the first condition.
 *
 * @param sensor  The driver.
 * @param out     Written with FATHOM_OK.
 * @retval FATHOM_OK             `*out` is written.
 * @retval FATHOM_PENDING        Call again.
 * @retval FATHOM_ERR_MALFORMED  8 reads, or 32 among unsolicited frames, did not suffice. If a response may still
 *                               arrive, this error comes `command_timeout_us` later, because the response would be
 *                               mistaken for the next measurement.
 * @return Other values: rule 3.
 */
fathom_status_t fathom_hps167s_get_configuration(fathom_hps167s_t *sensor,
                                                 fathom_hps167s_configuration_t *out);

/**
 * @brief Reads the details of the sensor: UUID, date and version (#3, table 14).
 *
 * @param sensor  The driver.
 * @param out     Written with FATHOM_OK.
 * @retval FATHOM_OK             `*out` is written.
 * @retval FATHOM_PENDING        Call again.
 * @retval FATHOM_ERR_MALFORMED  The response does not begin with the byte B0, or as in rule 3.
 * @return Other values: rule 3.
 */
fathom_status_t fathom_hps167s_get_details(fathom_hps167s_t *sensor, fathom_hps167s_details_t *out);

/**
 * @brief Reads the temperature of the analog front end (#4, table 16).
 *
 * @param sensor  The driver.
 * @param out     Written with FATHOM_OK.
 * @retval FATHOM_OK             `*out` is written.
 * @retval FATHOM_PENDING        Call again.
 * @retval FATHOM_ERR_MALFORMED  Tenths of a degree Celsius do not fit into an int16_t, or as in rule 3.
 * @return Other values: rule 3.
 */
fathom_status_t fathom_hps167s_get_temperature(fathom_hps167s_t *sensor, fathom_hps167s_temperature_t *out);

/**
 * @brief Reports an unsolicited frame with the shape of a measurement to the driver.
 *
 * hps167s_auto.h calls this function. A listener of your own may call it, so that the driver can distinguish responses
 * to #2 from measurements.
 *
 * @param sensor     The driver whose address the frame has.
 * @param registers  The four registers of the frame, first one first. Used only during the call.
 * @param time_us    Clock at the last byte of the frame, in microseconds.
 * @retval true   The frame is a measurement.
 * @retval false  The frame may be a late response to #2. It is no measurement.
 */
bool fathom_hps167s_accept_unsolicited(fathom_hps167s_t *sensor, const uint16_t registers[4],
                                       uint32_t time_us);

#ifdef __cplusplus
}
#endif

#endif
