/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_HPS167S_SETTINGS_H
#define FATHOM_HPS167S_SETTINGS_H

#include "fathom/sensor/hps167s.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * What can be set in an HPS-167S: commands #6 to #15. All of it is kept in its flash.
 *
 * Each function returns at once: call it with the same argument, with the loop going on in between, until it is not
 * FATHOM_PENDING. One at a time; fathom_poll is FATHOM_PENDING meanwhile, and fathom_hps167s_cancel gives it up.
 * An argument is checked before anything is sent: FATHOM_ERR_ARGUMENT. What is written is written once;
 * config.modbus.retries is for reading alone.
 *
 * With read-back (#7 to #11, #15): the configuration (#2) is read, the value is written only if it is another one,
 * since flash wears, and it is read again. At most 65 requests: twice #2 (hps167s_info.h) and the write. Then fathom_hps167s_is_written tells
 * whether it was written:
 *   FATHOM_OK            it was read back; not written: it was so before
 *   FATHOM_ERR_DIFFERS      it acknowledged the value, and it reads back as another
 *   FATHOM_ERR_UNCONFIRMED  it was sent, and could not be read back: it may be set or not
 *   FATHOM_ERR_EXCEPTION    it refused; fathom_hps167s_exception has the number
 *   FATHOM_ERR_BUSY         another command or setting is not finished, or this one with another value
 *   others                  of fathom_poll. Not written: nothing was changed; FATHOM_ERR_MALFORMED: #2 was not
 *                           believed. Written: the write failed so, and another value was read back
 * The longest time is twice that of #2 and one command; where a setting moves the device, four reads of #2 instead of two
 * at most, since the new place is probed and both are tried afterwards. FATHOM_ERR_LINE_BUSY and FATHOM_ERR_OTHER_MASTER:
 * fathom_hps167s_is_written tells whether the write left. A write leaves only into a silence.
 * #10 (measures after power-on) acts at the next power-on: until then the device goes on as before.
 *
 * WRITE-ONLY (#12, #13, #14): #1 is read first, so that nothing is written to a device that is not there and an echo of
 * the line is known, and then it is written. Nothing can be read back.
 *   FATHOM_OK            it was acknowledged, which is all that can be known
 *   FATHOM_ERR_UNCONFIRMED  it was sent and not acknowledged: it may be set or not
 *   FATHOM_ERR_EXCEPTION, FATHOM_ERR_BUSY   as above
 *   others                  of fathom_poll: nothing was written
 */

/* Has the last setting, or the one under way, been handed to the line? */
bool fathom_hps167s_is_written(const fathom_hps167s_t *sensor);

/*
 * The next setting is BLIND: for a device whose #2 is not believed. It is written without reading anything before or
 * afterwards, so a new address is not checked to be free; once, and to this unit alone. #12, which may add to
 * what is there, and #6 are FATHOM_ERR_ARGUMENT then. The setting after it is not blind, however this one ends:
 *   FATHOM_ERR_UNCONFIRMED  it was sent, and may be set or not, also where it was acknowledged
 *   FATHOM_ERR_EXCEPTION    it refused
 *   others                  nothing was written
 * Here: FATHOM_OK, or FATHOM_ERR_BUSY: a setting is not finished. fathom_hps167s_cancel and _power_on undo it.
 */
fathom_status_t fathom_hps167s_write_next_unchecked(fathom_hps167s_t *sensor);

/* #7: seconds after power-on without measuring; from the next fathom_hps167s_power_on. */
fathom_status_t fathom_hps167s_set_warm_up_s(fathom_hps167s_t *sensor, uint8_t warm_up_s);

/*
 * #8: 1..32; in force at once. #1 is read at the driver's own address and then at the new one; the latter costs a
 * time-out of 1 s. After FATHOM_OK the driver is at the new address; other drivers' requests that wait for the old
 * one end with FATHOM_ERR_CANCELLED.
 *   FATHOM_ERR_IN_USE       a unit responds at the new address; nothing was written
 *   FATHOM_ERR_WARMING_UP   none does, so soon after fathom_hps167s_power_on, which proves nothing: try again
 *   FATHOM_ERR_UNCONFIRMED  the device responds at neither: it is at one of the two. The driver stays at the old one
 */
fathom_status_t fathom_hps167s_set_address(fathom_hps167s_t *sensor, uint8_t address);

/*
 * #9: 19200, 57600, 115200 or 230400; parity and stop bits stay. For config.modbus.line_settings that is not
 * NULL, else FATHOM_ERR_ARGUMENT. The datasheet leaves open when it is in force. So the new rate is tried before, which
 * costs a time-out (FATHOM_ERR_UNSUPPORTED: the port cannot do it; FATHOM_ERR_IN_USE: a unit responds there), and after
 * the write first the new rate is tried, then the old one.
 *   FATHOM_OK            the driver is at the new rate; or at the old one, where the new one reads back for the next
 *                           power-on: sensor->next_baud is not 0, and fathom_hps167s_power_on moves the driver
 *   FATHOM_ERR_UNCONFIRMED  it responds at neither. From now on the driver tries both in turns until a response comes
 */
fathom_status_t fathom_hps167s_set_baud(fathom_hps167s_t *sensor, uint32_t baud);

/* #10: whether it measures by itself after power-on; from the next power-on. On from the factory. */
fathom_status_t fathom_hps167s_set_measures_after_power_on(fathom_hps167s_t *sensor, bool measures);

/* #11: the terminating resistor; from the next power-on. On from the factory in every unit: leave it on in the last one
 * of a line only, at the end that is not the host's. */
fathom_status_t fathom_hps167s_set_termination(fathom_hps167s_t *sensor, bool termination);

/*
 * #10 and #11 for ALL units on the line, whatever their addresses are (2.2.1), so also where several that are new from
 * the factory share address 1. No unit responds to that: it is sent once, nothing is read, and the outcome is
 *   FATHOM_ERR_UNCONFIRMED  it was sent. Read the configuration of each unit
 *   FATHOM_ERR_BUSY         another command or setting is not finished
 *   others                  of fathom_poll: nothing was sent
 * Nothing else in this library is ever sent to unit 0.
 */
fathom_status_t fathom_hps167s_broadcast_measures_after_power_on(fathom_hps167s_t *sensor, bool measures);
fathom_status_t fathom_hps167s_broadcast_termination(fathom_hps167s_t *sensor, bool termination);

/* #12: is added to what it measures; real 200 and measured 215 mm make -15. WRITE-ONLY; the datasheet leaves open
 * whether it replaces the offset before or adds to it: measure afterwards. */
fathom_status_t fathom_hps167s_set_distance_offset_mm(fathom_hps167s_t *sensor, int16_t offset_mm);

/* #13: loads the settings of the measuring part, those that the user has set or those from the factory, which UNDOES
 * the user's for good. WRITE-ONLY. The datasheet does not list these settings; those of the interface are #6's. */
fathom_status_t fathom_hps167s_load_user_settings(fathom_hps167s_t *sensor);
fathom_status_t fathom_hps167s_load_factory_settings(fathom_hps167s_t *sensor);

/* #14: -100..100 is recommended, all is taken; 0 from the factory. The larger, the steadier and slower. WRITE-ONLY. */
fathom_status_t fathom_hps167s_set_filter_sensitivity(fathom_hps167s_t *sensor, int16_t sensitivity);

/* #15: after so long without data, in continuous output, it sends abnormal packets. A multiple of 18, 0 too. */
fathom_status_t fathom_hps167s_set_reconnect_time_ms(fathom_hps167s_t *sensor, uint32_t reconnect_time_ms);

/*
 * #6: RESETS ALL SETTINGS OF THE INTERFACE: address 1, 19200 baud, warm-up, termination and the others. Nothing else
 * in this library sends the command, which is a read of register 0x0009, and it is sent once.
 *
 * #2 is read first; then, if the device is elsewhere, a read at address 1 and 19200 shows whether a unit is there,
 * which costs a time-out. Where config.modbus.line_settings is NULL the driver follows to the address alone.
 *   FATHOM_OK            it reported success, or has moved; and was read there, where the driver is from now on
 *   FATHOM_ERR_IN_USE       a unit responds at address 1; nothing was sent
 *   FATHOM_ERR_EXCEPTION    it refused: sensor->reset_response has the device's own error code; where that is
 *                           FATHOM_HPS167S_NO_RESET_RESPONSE it was a Modbus exception, whose number is in
 *                           fathom_hps167s_exception
 *   FATHOM_ERR_UNCONFIRMED  it was sent, and the device responds nowhere, or is where it was and reported no success
 *   FATHOM_ERR_BUSY         another command or setting is not finished
 *   others                  of fathom_poll: it was not reset
 * Its response 00 01 is also that of #4 for one degree: no response to #4 can come by then, since #2 was read after it.
 */
fathom_status_t fathom_hps167s_restore_factory_settings(fathom_hps167s_t *sensor);

#ifdef __cplusplus
}
#endif

#endif
