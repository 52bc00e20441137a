/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_HPS167S_SETTINGS_H
#define FATHOM_HPS167S_SETTINGS_H

#include "fathom/sensor/hps167s.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief Changes settings of an HPS-167S: address, baud rate, warm-up, termination and others.
 *
 * #1 to #15 are the numbers of the commands in the datasheet: #1 reads the version, #2 the configuration, #5 measures.
 * The sensor keeps its settings in flash, so a setting that can be read is read first and written only if it differs.
 * Each write is sent once and is never retried. No function waits: each returns FATHOM_PENDING until it is finished.
 * Nothing but fathom_hps167s_restore_factory_settings() and fathom_hps167s_load_factory_settings() resets a
 * sensor. include/COST.md has the flash of a program that uses all settings (`hps167s_settings`).
 *
 * @code
 * if (!is_done) {                                                                  // in the loop
 *     const fathom_status_t status = fathom_hps167s_set_termination(&gate, false);
 *     is_done = status != FATHOM_PENDING;
 *     if (status == FATHOM_OK) say(fathom_hps167s_is_written(&gate) ? "changed" : "it was off");
 *     else if (is_done) say(fathom_status_name(status));
 * }
 * @endcode
 *
 * 1. **Calls.** Call a function with the same argument until its result differs from FATHOM_PENDING. Until then
 *    fathom_poll() returns FATHOM_PENDING, and other commands and settings return FATHOM_ERR_BUSY.
 *    fathom_hps167s_cancel() ends a setting: the value may then be set or not. If the program stops to call the
 *    function, measurements stay FATHOM_PENDING for 5 s and 16 polls; then they continue, and the value may be set or
 *    not. After the end of a setting, another call starts a new one.
 *
 * 2. **Arguments.** A function checks its argument before anything is sent: FATHOM_ERR_ARGUMENT. It also returns this
 *    error if the driver is not initialised. `retries` of the config concerns the reads only.
 *
 * 3. **Settings with read-back (#7 to #11, #15).** The driver reads the present value, writes the new value if it
 *    differs, and reads it back. #8 reads #1 for this purpose, all others read the configuration (#2). If the newest
 *    write of a setting has not read back since power-on, an equal value is written too: the sensor may report the
 *    value that it works with, and keep another.
 *
 *    | result                     | cause                                                                         |
 *    |----------------------------|-------------------------------------------------------------------------------|
 *    | FATHOM_OK, not written     | The sensor already had this value.                                            |
 *    | FATHOM_OK, written         | The value was read back.                                                      |
 *    | FATHOM_ERR_DIFFERS         | The sensor acknowledged the value, and reads back as another one.             |
 *    | FATHOM_ERR_UNCONFIRMED     | The value was sent and could not be read back: it may be set or not.          |
 *    | FATHOM_ERR_EXCEPTION       | The sensor refused: see fathom_hps167s_exception().                           |
 *    | FATHOM_ERR_BUSY            | Another command or setting is not finished, or this one with another value.   |
 *    | FATHOM_ERR_MALFORMED       | Not written: #2 was not believed (hps167s_info.h).                            |
 *    | other, not written         | Nothing changed. The errors are those of fathom_poll() (hps167s.h, rule 2).   |
 *    | other, written             | The write failed with this error, and another value was read back.            |
 *
 *    "Written" is the result of fathom_hps167s_is_written().
 *
 * 4. **WRITE-ONLY settings (#12, #13, #14).** The sensor has no command that reads these values. The driver reads #1
 *    and then writes. The read shows that the sensor is there, and whether the adapter echoes.
 *
 *    | result                     | cause                                                                         |
 *    |----------------------------|-------------------------------------------------------------------------------|
 *    | FATHOM_OK                  | The sensor acknowledged the value. Nothing more can be known.                 |
 *    | FATHOM_ERR_UNCONFIRMED     | The value was sent and not acknowledged: it may be set or not.                |
 *    | FATHOM_ERR_EXCEPTION       | The sensor refused: see fathom_hps167s_exception().                           |
 *    | FATHOM_ERR_BUSY            | Another command or setting is not finished, or this one with another value.   |
 *    | other                      | Not written; the errors are those of fathom_poll(). Rule 5 has an exception.  |
 *
 * 5. **Busy lines.** After FATHOM_ERR_LINE_BUSY and FATHOM_ERR_OTHER_MASTER the write may have been sent:
 *    fathom_hps167s_is_written() returns whether it was. If it was, the value may be set or not: call the function again.
 *
 * 6. **Bound.** A setting with read-back takes at most two reads of #2 and one command (hps167s_info.h, rule 4): at
 *    most 65 requests, because one read of #2 takes up to 32 requests beside unsolicited frames. A setting that moves the sensor takes at most four reads, because the new place is read first,
 *    and both places may be read afterwards. A WRITE-ONLY setting takes two commands. While the driver searches for the
 *    sensor after a change of the baud rate, one read of #1 is added.
 */

/**
 * @brief Returns true if the newest setting was passed to the line to be written.
 *
 * The value belongs to the setting in progress, or else to the newest one. It becomes false again if the line reports
 * that the write was not sent.
 */
bool fathom_hps167s_is_written(const fathom_hps167s_t *sensor);

/**
 * @brief Makes the next setting blind: for a sensor whose response to #2 is not believed.
 *
 * A blind setting is written once, to this unit alone, without a read before or afterwards. So a new address is not
 * checked to be free, and the driver stays at its present address and rate. The setting after it is not blind, whatever
 * its result is. fathom_hps167s_cancel() and fathom_hps167s_power_on() withdraw this call.
 *
 * | result of the blind setting | cause                                                                         |
 * |-----------------------------|-------------------------------------------------------------------------------|
 * | FATHOM_ERR_UNCONFIRMED      | The value was sent, acknowledged or not: it may be set or not.                |
 * | FATHOM_ERR_EXCEPTION        | The sensor refused.                                                           |
 * | FATHOM_ERR_ARGUMENT         | #6 and #12 cannot be blind, because #12 may add to the present offset.        |
 * | FATHOM_PENDING              | Call again.                                                                   |
 * | other                       | Nothing was written, unless rule 5 applies.                                   |
 *
 * @retval FATHOM_OK            The next setting is blind.
 * @retval FATHOM_ERR_BUSY      A setting is not finished.
 * @retval FATHOM_ERR_ARGUMENT  The driver is not initialised.
 */
fathom_status_t fathom_hps167s_write_next_unchecked(fathom_hps167s_t *sensor);

/**
 * @brief Sets the warm-up time after power-on (#7). With factory settings it is 5 s.
 *
 * The driver uses the new time from the next fathom_hps167s_power_on().
 *
 * @param sensor     The driver.
 * @param warm_up_s  Time without a measurement after power-on, in seconds, 0 to 255.
 * @retval FATHOM_PENDING  Call again with the same argument.
 * @return Other values: rules 3 and 5.
 */
fathom_status_t fathom_hps167s_set_warm_up_s(fathom_hps167s_t *sensor, uint8_t warm_up_s);

/**
 * @brief Sets the address of the sensor (#8). The sensor uses the new address at once.
 *
 * The driver reads #1 at the present address, then at the new one. There no unit must respond, so this read costs one
 * time-out, `command_timeout_us`, for each attempt. With FATHOM_OK the driver uses the new address. Requests of other drivers
 * that wait for the present address end with FATHOM_ERR_CANCELLED.
 *
 * @param sensor   The driver.
 * @param address  The new address, 1 to 32.
 * @retval FATHOM_OK               The sensor responded at the new address.
 * @retval FATHOM_PENDING          Call again with the same argument.
 * @retval FATHOM_ERR_ARGUMENT     The address is 0 or above 32.
 * @retval FATHOM_ERR_IN_USE       A unit responds at the new address, or noise that may be a damaged response arrived.
 *                                 Nothing was written.
 * @retval FATHOM_ERR_WARMING_UP   The sensor was powered a short time ago, so silence does not prove that the address
 *                                 is free. Nothing was written. Try again later.
 * @retval FATHOM_ERR_UNCONFIRMED  The sensor responded at neither address, so it has one of the two. The driver uses the
 *                                 former one. Poll it: if it does not respond, initialise the driver with the new
 *                                 address.
 * @return Other values: rules 3 and 5.
 */
fathom_status_t fathom_hps167s_set_address(fathom_hps167s_t *sensor, uint8_t address);

/**
 * @brief Sets the baud rate of the sensor (#9). Parity and stop bits stay.
 *
 * The datasheet does not state when the sensor uses the new rate. So the driver reads at the new rate before the write,
 * which costs a time-out of `command_timeout_us` for each attempt. After the write it reads at the new rate first, then
 * at the former one. The driver's own line settings follow; the struct that the config named is not changed.
 *
 * @param sensor  The driver. Its config has named `line_settings`.
 * @param baud    19200, 57600, 115200 or 230400 bits per second.
 * @retval FATHOM_OK               If `next_baud` is 0, the driver uses the new rate. If `next_baud` is not 0, the
 *                                 sensor still responds at the former rate and reports the new one for its next
 *                                 power-on; then fathom_hps167s_power_on() moves the driver.
 * @retval FATHOM_PENDING          Call again with the same argument.
 * @retval FATHOM_ERR_ARGUMENT     The sensor has no such rate, or the driver has no `line_settings`.
 * @retval FATHOM_ERR_UNSUPPORTED  The port does not have this rate. Nothing was written.
 * @retval FATHOM_ERR_IN_USE       A unit with this address responds at the new rate. Nothing was written.
 * @retval FATHOM_ERR_WARMING_UP   As fathom_hps167s_set_address().
 * @retval FATHOM_ERR_UNCONFIRMED  The sensor responds at neither rate. From now on the driver uses both alternately
 *                                 until the sensor responds.
 * @return Other values: rules 3 and 5.
 */
fathom_status_t fathom_hps167s_set_baud(fathom_hps167s_t *sensor, uint32_t baud);

/**
 * @brief Sets whether the sensor measures continuously after power-on (#10). On with factory settings.
 *
 * The sensor uses the setting from its next power-on. Until then it continues as before.
 *
 * @param sensor    The driver.
 * @param measures  True to measure after power-on.
 * @retval FATHOM_PENDING  Call again with the same argument.
 * @return Other values: rules 3 and 5.
 */
fathom_status_t fathom_hps167s_set_measures_after_power_on(fathom_hps167s_t *sensor, bool measures);

/**
 * @brief Switches the termination resistor of the sensor on or off (#11). On with factory settings, in every unit.
 *
 * The sensor uses the setting from its next power-on. Eight resistors overload a line. Leave the resistor on in one
 * unit only: the last one, at the end of the line that is not the host's.
 *
 * @param sensor       The driver.
 * @param termination  True to switch the resistor on.
 * @retval FATHOM_PENDING  Call again with the same argument.
 * @return Other values: rules 3 and 5.
 */
fathom_status_t fathom_hps167s_set_termination(fathom_hps167s_t *sensor, bool termination);

/**
 * @brief Sends #10 to ALL units of the line, whatever their addresses are (2.2.1).
 *
 * It also reaches several new units that share address 1. No unit responds to a broadcast. The request is sent once,
 * and nothing is read. The transaction takes `command_timeout_us`, the time that the units have before the next
 * request. Only this function and fathom_hps167s_broadcast_termination() send anything to address 0.
 *
 * @param sensor    Any driver of the line. It stays at its address.
 * @param measures  True to measure after power-on.
 * @retval FATHOM_PENDING          Call again with the same argument.
 * @retval FATHOM_ERR_UNCONFIRMED  The request was sent. Next, read the configuration of each unit.
 * @retval FATHOM_ERR_BUSY         Another command or setting is not finished.
 * @return Other values: nothing was sent.
 */
fathom_status_t fathom_hps167s_broadcast_measures_after_power_on(fathom_hps167s_t *sensor, bool measures);

/**
 * @brief Sends #11 to ALL units of the line, as fathom_hps167s_broadcast_measures_after_power_on() sends #10.
 *
 * @param sensor       Any driver of the line. It stays at its address.
 * @param termination  True to switch the resistors on.
 * @return As fathom_hps167s_broadcast_measures_after_power_on().
 */
fathom_status_t fathom_hps167s_broadcast_termination(fathom_hps167s_t *sensor, bool termination);

/**
 * @brief Sets the distance offset, which the sensor adds to what it measures (#12). WRITE-ONLY.
 *
 * For a real distance of 200 mm and a measured one of 215 mm the offset is -15. The datasheet does not state whether
 * the new offset replaces the former one or adds to it, so measure afterwards.
 *
 * @param sensor     The driver.
 * @param offset_mm  The offset in millimetres, any value.
 * @retval FATHOM_PENDING       Call again with the same argument.
 * @retval FATHOM_ERR_ARGUMENT  The setting is blind (fathom_hps167s_write_next_unchecked()), or the driver is not
 *                              initialised.
 * @return Other values: rules 4 and 5.
 */
fathom_status_t fathom_hps167s_set_distance_offset_mm(fathom_hps167s_t *sensor, int16_t offset_mm);

/**
 * @brief Loads the settings of the measuring part that the user has set (#13). WRITE-ONLY.
 *
 * The datasheet does not list these settings. Those of the interface belong to #6.
 *
 * @retval FATHOM_PENDING  Call again.
 * @return Other values: rules 4 and 5.
 */
fathom_status_t fathom_hps167s_load_user_settings(fathom_hps167s_t *sensor);

/**
 * @brief Loads the factory settings of the measuring part (#13), which UNDOES the user's permanently. WRITE-ONLY.
 *
 * The datasheet does not list these settings. Those of the interface belong to #6.
 *
 * @retval FATHOM_PENDING  Call again.
 * @return Other values: rules 4 and 5.
 */
fathom_status_t fathom_hps167s_load_factory_settings(fathom_hps167s_t *sensor);

/**
 * @brief Sets the sensitivity of the output filter (#14). WRITE-ONLY. 0 with factory settings.
 *
 * A larger value makes the output steadier and slower.
 *
 * @param sensor       The driver.
 * @param sensitivity  Any value. The datasheet recommends -100 to 100.
 * @retval FATHOM_PENDING  Call again with the same argument.
 * @return Other values: rules 4 and 5.
 */
fathom_status_t fathom_hps167s_set_filter_sensitivity(fathom_hps167s_t *sensor, int16_t sensitivity);

/**
 * @brief Sets the reconnect time (#15).
 *
 * If the interface receives no data for this time in continuous output, it reconnects and sends abnormal packets.
 *
 * @param sensor             The driver.
 * @param reconnect_time_ms  The time in milliseconds: a multiple of 18, or 0.
 * @retval FATHOM_PENDING       Call again with the same argument.
 * @retval FATHOM_ERR_ARGUMENT  The time is no multiple of 18, or the driver is not initialised.
 * @return Other values: rules 3 and 5.
 */
fathom_status_t fathom_hps167s_set_reconnect_time_ms(fathom_hps167s_t *sensor, uint32_t reconnect_time_ms);

/**
 * @brief RESETS ALL SETTINGS OF THE INTERFACE (#6): address 1, 19200 baud, warm-up, termination and the others.
 *
 * The command is a read of register 0x0009. Nothing else in this library sends it, and it is sent once. The driver
 * reads #2 first. If the sensor has another address or rate, a read at address 1 and 19200 baud must then find no unit,
 * which costs a time-out for each attempt. If the driver has no `line_settings`, it follows the sensor to address 1
 * only, and not to 19200 baud.
 *
 * @retval FATHOM_OK               The sensor reported success, or has moved, and responds where the driver is now. The
 *                                 warm-up time of the driver is 5 s.
 * @retval FATHOM_PENDING          Call again.
 * @retval FATHOM_ERR_IN_USE       A unit responds at address 1 and 19200 baud. Nothing was sent.
 * @retval FATHOM_ERR_EXCEPTION    The sensor refused. `reset_response` is its error code. If `reset_response` is
 *                                 FATHOM_HPS167S_NO_RESET_RESPONSE, the sensor sent a Modbus exception:
 *                                 see fathom_hps167s_exception().
 * @retval FATHOM_ERR_UNCONFIRMED  The command was sent. The sensor responds nowhere, or it responds where it was and
 *                                 has not reported success.
 * @retval FATHOM_ERR_BUSY         Another command or setting is not finished.
 * @retval FATHOM_ERR_ARGUMENT     fathom_hps167s_write_next_unchecked() was called, or the driver is not initialised.
 * @return Other values: the sensor was not reset.
 */
fathom_status_t fathom_hps167s_restore_factory_settings(fathom_hps167s_t *sensor);

#ifdef __cplusplus
}
#endif

#endif
