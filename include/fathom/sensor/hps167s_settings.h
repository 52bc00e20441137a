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
 * #1 to #15 are the numbers of the commands in the datasheet: #1 reads the version, #2 reads the configuration, and #5
 * measures. The sensor keeps its settings in flash. If a setting can be read, the driver reads it first, and writes it
 * only if it differs. Each write is sent once and is never retried. No function waits: each returns FATHOM_PENDING
 * until it is finished. Only fathom_hps167s_restore_factory_settings() and fathom_hps167s_load_factory_settings() undo
 * the settings of the user. include/COST.md has the flash of a program that uses all settings (`hps167s_settings`).
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
 * 1. **Calls.** Call a function with the same argument until its result differs from FATHOM_PENDING. Another call after
 *    that starts a new setting. While a setting is in progress, other commands and settings return FATHOM_ERR_BUSY, and
 *    fathom_poll() returns FATHOM_PENDING. fathom_poll() makes two exceptions: FATHOM_ERR_PORT, and the result of a
 *    measurement that was on the wire already. fathom_hps167s_cancel() ends a setting: the value may then be set or
 *    not. A setting that the program no longer calls ends in the same way, after 5 s and 16 calls of other functions of
 *    the driver, such as fathom_poll() (modbus_unit.h, rule 5).
 *
 * 2. **Arguments.** A function checks its argument before it sends anything. It returns FATHOM_ERR_ARGUMENT if the
 *    argument is outside its range, or if the driver is not initialised.
 *
 * 3. **Settings with read-back (#7 to #11, #15).** The driver reads the present value, writes the new value if it
 *    differs, and reads it back. For #8 the driver reads #1, for all others it reads the configuration (#2). `retries`
 *    of the configuration of the driver applies to these reads. After a write that did not read back, the sensor may
 *    report one value and keep another. So the next call may write an equal value too, until a write reads back or
 *    fathom_hps167s_power_on() is called.
 *
 *    | result                     | cause                                                                         |
 *    |----------------------------|-------------------------------------------------------------------------------|
 *    | FATHOM_OK, not written     | The sensor already had this value.                                            |
 *    | FATHOM_OK, written         | The value was read back.                                                      |
 *    | FATHOM_ERR_DIFFERS         | The sensor acknowledged the value, and another value reads back.              |
 *    | FATHOM_ERR_UNCONFIRMED     | The value was sent and could not be read back: it may be set or not.          |
 *    | FATHOM_ERR_EXCEPTION       | The sensor refused: see fathom_hps167s_exception().                           |
 *    | FATHOM_ERR_BUSY            | Another command or setting is not finished, or this one with another value.   |
 *    | FATHOM_ERR_MALFORMED       | Not written: #2 was not believed (hps167s_info.h).                            |
 *    | other, not written         | Nothing changed. The errors are those of fathom_poll() (hps167s.h, rule 2).   |
 *    | other, written             | The write failed with this error, and another value was read back.            |
 *
 *    "Written" is the result of fathom_hps167s_is_written(). The sensor uses #10 and #11 from its next power-on. The
 *    datasheet does not state what #2 reports before it. If the result is FATHOM_ERR_DIFFERS, read the configuration
 *    after the next power-on.
 *
 * 4. **WRITE-ONLY settings (#12, #13, #14).** The sensor has no command that reads these values. The driver reads #1
 *    and then writes. The read shows that the sensor responds, and whether the port receives its own requests (echo).
 *    Call no other setting until it has ended: during this read another setting can take its place, and this one then
 *    returns FATHOM_ERR_BUSY and is not written.
 *
 *    | result                     | cause                                                                         |
 *    |----------------------------|-------------------------------------------------------------------------------|
 *    | FATHOM_OK                  | The sensor acknowledged the value. Nothing more can be known.                 |
 *    | FATHOM_ERR_UNCONFIRMED     | The value was sent and not acknowledged: it may be set or not.                |
 *    | FATHOM_ERR_EXCEPTION       | The sensor refused: see fathom_hps167s_exception().                           |
 *    | FATHOM_ERR_BUSY            | Another command or setting is not finished, or this one with another value.   |
 *    | other                      | Not written. The errors are those of fathom_poll() (hps167s.h, rule 2).       |
 *
 * 5. **Busy lines and broken ports.** FATHOM_ERR_LINE_BUSY and FATHOM_ERR_OTHER_MASTER mean that nothing was written,
 *    unless fathom_hps167s_is_written() returns true. In that case another value was read back after the write: call
 *    the function again. If the port breaks while the write waits for the line or leaves, the write counts as sent.
 *
 * 6. **Bound.** A read of #2 takes up to 32 requests beside unsolicited frames (hps167s_info.h, rule 4). A setting with
 *    read-back takes at most two such reads and one write: 65 requests. A setting that moves the sensor to another
 *    address or rate takes at most four reads. It reads at the present place and at the new place before the write, and
 *    at both places after it. A WRITE-ONLY setting takes two requests. While the driver searches for the sensor after a
 *    change of the baud rate, a setting takes one more read of #1.
 */

/**
 * @brief Returns true if the driver passed the write of a setting to the line.
 *
 * The setting is the one in progress, or else the newest one. The result becomes false again if the line reports that
 * the write was not sent.
 */
bool fathom_hps167s_is_written(const fathom_hps167s_t *sensor);

/**
 * @brief Makes the next setting blind: for a sensor whose response to #2 is not believed (hps167s_info.h).
 *
 * A blind setting is written once, to this unit alone. The driver reads nothing before or after it. So it does not
 * check that a new address is free, and it stays at its present address. After a blind fathom_hps167s_set_baud() the
 * driver uses the present and the new rate alternately until the sensor responds. Only the next setting is blind, also
 * if it is a broadcast. Its first result other than FATHOM_PENDING uses this call up, also FATHOM_ERR_BUSY and
 * FATHOM_ERR_ARGUMENT. fathom_hps167s_cancel() and fathom_hps167s_power_on() withdraw this call.
 *
 * | result of the blind setting | cause                                                                         |
 * |-----------------------------|-------------------------------------------------------------------------------|
 * | FATHOM_ERR_UNCONFIRMED      | The value was sent, acknowledged or not: it may be set or not.                |
 * | FATHOM_ERR_EXCEPTION        | The sensor refused.                                                           |
 * | FATHOM_ERR_ARGUMENT         | As rule 2; or the setting is #6 or #12, which cannot be blind.                |
 * | FATHOM_PENDING              | Call again.                                                                   |
 * | other                       | Nothing was written.                                                          |
 *
 * @retval FATHOM_OK            The next setting is blind.
 * @retval FATHOM_ERR_BUSY      A setting is not finished.
 * @retval FATHOM_ERR_ARGUMENT  The driver is not initialised.
 */
fathom_status_t fathom_hps167s_write_next_unchecked(fathom_hps167s_t *sensor);

/**
 * @brief Sets the warm-up time after power-on (#7). With factory settings it is 5 s.
 *
 * From the next fathom_hps167s_power_on() the driver uses the time that it read last. After a blind setting or
 * FATHOM_ERR_UNCONFIRMED that is the former time: initialise the driver with the new one.
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
 * The driver reads #1 at the present address. If the new address is another one, the driver then reads there, where no
 * unit may respond. So the second read costs one `command_timeout_us` for each attempt. With FATHOM_OK the driver uses
 * the new address. Requests of other drivers that wait for the present address end with FATHOM_ERR_CANCELLED.
 *
 * @param sensor   The driver.
 * @param address  The new address, 1 to 32.
 * @retval FATHOM_OK               The sensor responded at the new address.
 * @retval FATHOM_PENDING          Call again with the same argument.
 * @retval FATHOM_ERR_ARGUMENT     The address is 0 or above 32.
 * @retval FATHOM_ERR_IN_USE       A unit responds at the new address, or noise that may be a damaged response arrived.
 *                                 Nothing was written.
 * @retval FATHOM_ERR_WARMING_UP   The sensor was powered a short time ago (fathom_hps167s_power_on()), so silence does
 *                                 not prove that the address is free. Nothing was written. Try again later.
 * @retval FATHOM_ERR_UNCONFIRMED  The sensor responded at neither address; it has one of the two. The driver uses the
 *                                 former address. Poll it: if the sensor does not respond, initialise the driver with
 *                                 the new address.
 * @return Other values: rules 3 and 5.
 */
fathom_status_t fathom_hps167s_set_address(fathom_hps167s_t *sensor, uint8_t address);

/**
 * @brief Sets the baud rate of the sensor (#9). Parity and stop bits stay.
 *
 * Before the write the driver reads at the new rate, where no unit may respond. This read costs one
 * `command_timeout_us` for each attempt. The datasheet does not state when the sensor uses the new rate. So after the
 * write the driver reads at the new rate first, then at the former one. The driver changes its own copy of the line
 * settings, and not the struct that the configuration named.
 *
 * @param sensor  The driver. Its configuration has named `line_settings`.
 * @param baud    19200, 57600, 115200 or 230400 bits per second.
 * @retval FATHOM_OK               If `next_baud` is 0, the driver uses the new rate. If `next_baud` is not 0, the
 *                                 sensor still responds at the former rate and reports the new one for its next
 *                                 power-on; then fathom_hps167s_power_on() moves the driver.
 * @retval FATHOM_PENDING          Call again with the same argument.
 * @retval FATHOM_ERR_ARGUMENT     The sensor has no such rate, or the driver has no `line_settings`.
 * @retval FATHOM_ERR_UNSUPPORTED  The port does not have this rate. Nothing was written.
 * @retval FATHOM_ERR_IN_USE       A unit with this address responds at the new rate, or noise that may be a damaged
 *                                 response arrived. Nothing was written. Unsolicited frames can be such noise: try
 *                                 again, or first switch them off (#10) and power the sensor off and on.
 * @retval FATHOM_ERR_WARMING_UP   As fathom_hps167s_set_address().
 * @retval FATHOM_ERR_UNCONFIRMED  The sensor responds at neither rate. The driver uses both alternately until the
 *                                 sensor responds.
 * @return Other values: rules 3 and 5.
 */
fathom_status_t fathom_hps167s_set_baud(fathom_hps167s_t *sensor, uint32_t baud);

/**
 * @brief Sets whether the sensor measures continuously after power-on (#10). On with factory settings.
 *
 * The sensor uses the setting from its next power-on.
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
 * The request also reaches several new units that share address 1. To read these units afterwards, connect one at a
 * time. No unit responds to a broadcast. The request is sent once, and nothing is read. After the request the line
 * sends nothing for `command_timeout_us`, so that the units can do their work. Only this function and
 * fathom_hps167s_broadcast_termination() send anything to address 0.
 *
 * @param sensor    Any driver of the line. It stays at its address.
 * @param measures  True to measure after power-on.
 * @retval FATHOM_PENDING          Call again with the same argument.
 * @retval FATHOM_ERR_UNCONFIRMED  The request was sent, or the port broke before or meanwhile. Next, read the
 *                                 configuration of each unit.
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
 * For a real distance of 200 mm and a measured distance of 215 mm the offset is -15. The datasheet does not state
 * whether the new offset replaces the former one or adds to it, so measure afterwards.
 *
 * @param sensor     The driver.
 * @param offset_mm  The offset in millimetres, any value.
 * @retval FATHOM_PENDING       Call again with the same argument.
 * @retval FATHOM_ERR_ARGUMENT  fathom_hps167s_write_next_unchecked() was called, and the offset cannot be blind. Or the
 *                              driver is not initialised.
 * @return Other values: rule 4.
 */
fathom_status_t fathom_hps167s_set_distance_offset_mm(fathom_hps167s_t *sensor, int16_t offset_mm);

/**
 * @brief Loads the settings of the measuring part that the user has set (#13). WRITE-ONLY.
 *
 * The datasheet neither lists these settings nor states when a program needs this command. The settings of the
 * interface belong to #6. The command does not undo fathom_hps167s_load_factory_settings().
 *
 * @retval FATHOM_PENDING  Call again.
 * @return Other values: rule 4.
 */
fathom_status_t fathom_hps167s_load_user_settings(fathom_hps167s_t *sensor);

/**
 * @brief Loads the factory settings of the measuring part (#13). WRITE-ONLY. UNDOES the user's settings permanently.
 *
 * The datasheet does not list these settings. The settings of the interface belong to #6.
 *
 * @retval FATHOM_PENDING  Call again.
 * @return Other values: rule 4.
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
 * @return Other values: rule 4.
 */
fathom_status_t fathom_hps167s_set_filter_sensitivity(fathom_hps167s_t *sensor, int16_t sensitivity);

/**
 * @brief Sets the reconnect time (#15).
 *
 * If the interface receives no data from the measuring part for this time in continuous output, it reconnects to that
 * part and sends abnormal packets. The datasheet does not state what a polled sensor does, nor what 0 means.
 *
 * @param sensor             The driver.
 * @param reconnect_time_ms  The time in milliseconds: a multiple of 18, 0 to 4294967292.
 * @retval FATHOM_PENDING       Call again with the same argument.
 * @retval FATHOM_ERR_ARGUMENT  The time is no multiple of 18, or the driver is not initialised.
 * @return Other values: rules 3 and 5.
 */
fathom_status_t fathom_hps167s_set_reconnect_time_ms(fathom_hps167s_t *sensor, uint32_t reconnect_time_ms);

/**
 * @brief RESETS ALL SETTINGS OF THE INTERFACE (#6): address 1, 19200 baud, warm-up, termination and the others.
 *
 * The command is a read of register 0x0009. Only this function sends it, and sends it once. The driver reads #2 first.
 * If the sensor has another address or rate than 1 and 19200 baud, the driver then reads at these, where no unit may
 * respond. This read costs one `command_timeout_us` for each attempt. If the driver has no `line_settings`, it follows
 * the sensor to address 1 only, and not to 19200 baud.
 *
 * @retval FATHOM_OK               The sensor reported success, or it has moved and responds at its new place. The
 *                                 driver uses a warm-up time of 5 s. If `next_baud` is not 0, the sensor uses 19200
 *                                 baud from its next power-on; then fathom_hps167s_power_on() moves the driver.
 * @retval FATHOM_PENDING          Call again.
 * @retval FATHOM_ERR_IN_USE       A unit responds at address 1 and 19200 baud, or noise that may be a damaged response
 *                                 arrived. The command was not sent.
 * @retval FATHOM_ERR_EXCEPTION    The sensor refused. `reset_response` is its error code. If `reset_response` is
 *                                 FATHOM_HPS167S_NO_RESET_RESPONSE, the sensor sent a Modbus exception:
 *                                 see fathom_hps167s_exception().
 * @retval FATHOM_ERR_UNCONFIRMED  The command was sent. The sensor does not respond, or it responds where it was and
 *                                 has not reported success. The driver uses its former address and rate. Poll it: if
 *                                 the sensor does not respond, initialise the driver with address 1 and 19200 baud.
 * @retval FATHOM_ERR_BUSY         Another command or setting is not finished.
 * @retval FATHOM_ERR_ARGUMENT     fathom_hps167s_write_next_unchecked() was called, and the reset cannot be blind. Or
 *                                 the driver is not initialised.
 * @return Other values: the sensor was not reset.
 */
fathom_status_t fathom_hps167s_restore_factory_settings(fathom_hps167s_t *sensor);

#ifdef __cplusplus
}
#endif

#endif
