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
 * With read-back (#7 to #11, #15): the configuration (#2) is read, the value is written only if it is another one, since
 * flash wears, and it is read again. 17 answers at most, some ms each. fathom_hps167s_is_written tells whether it was
 * written:
 *   FATHOM_READY            the device says that it is so; not written: it was so before
 *   FATHOM_ERR_DIFFERS      it acknowledged the value and says that it has another one
 *   FATHOM_ERR_UNCONFIRMED  it was sent, and could not be read back: it may hold or not
 *   FATHOM_ERR_EXCEPTION    it refused; fathom_hps167s_exception has the number
 *   FATHOM_ERR_BUSY         another command or setting is not finished, or this one with another value
 *   others                  of fathom_poll. Not written: nothing was changed; FATHOM_ERR_MALFORMED: #2 could not be made
 *                           out. Written: the write failed so, and the device says that it has another value
 * WRITE-ONLY (#12, #13, #14): #1 is read first, so that a device that is not there is told nothing and an echo of the
 * line is known, and then it is written. There is nothing to read back.
 *   FATHOM_READY            it was acknowledged, which is all that can be known
 *   FATHOM_ERR_UNCONFIRMED  it was sent and not acknowledged: it may hold or not
 *   FATHOM_ERR_EXCEPTION, FATHOM_ERR_BUSY   as above
 *   others                  of fathom_poll: nothing was written
 */

/* Has the last setting, or the one under way, been handed to the line? */
bool fathom_hps167s_is_written(const fathom_hps167s_t *sensor);

/*
 * The next setting is BLIND: for a device whose #2 cannot be made out. It is written without reading anything before or
 * afterwards, so also without a look whether an address is free; once, and to this unit alone. #12, which may add to
 * what is there, and #6 are FATHOM_ERR_ARGUMENT then. Whatever the setting ends with, the one after it is none:
 *   FATHOM_ERR_UNCONFIRMED  it was sent, and may hold or not, also where it was acknowledged
 *   FATHOM_ERR_EXCEPTION    it refused
 *   others                  nothing was written
 * Here: FATHOM_READY, or FATHOM_ERR_BUSY: a setting is not finished. fathom_hps167s_cancel and _power_on forget it.
 */
fathom_status_t fathom_hps167s_next_is_blind(fathom_hps167s_t *sensor);

/* #7: seconds after power-on without measuring; holds from the next power-on. fathom_hps167s_power_on then counts with
 * it. */
fathom_status_t fathom_hps167s_set_warm_up_s(fathom_hps167s_t *sensor, uint8_t warm_up_s);

/*
 * #8: 1..32; holds at once. The driver's own address and then the new one are asked for #1, the latter costs a
 * time-out of 1 s. After FATHOM_READY the driver asks at the new address; requests of others that wait for the old one
 * end with FATHOM_ERR_CANCELLED.
 *   FATHOM_ERR_IN_USE       somebody answers at the new address; nothing was written
 *   FATHOM_ERR_WARMING_UP   nobody does, so soon after fathom_hps167s_power_on, which proves nothing: try again
 *   FATHOM_ERR_UNCONFIRMED  the device answers at neither: it is at one of the two. The driver asks at the old one
 */
fathom_status_t fathom_hps167s_set_address(fathom_hps167s_t *sensor, uint8_t address);

/*
 * #9: 19200, 57600, 115200 or 230400; parity and stop bits stay. For config.modbus.settings that is not NULL, else
 * FATHOM_ERR_ARGUMENT. When it holds the datasheet does not say. So the new rate is asked before, which costs a
 * time-out (FATHOM_ERR_UNSUPPORTED: the port cannot do it; FATHOM_ERR_IN_USE: somebody answers there), and after the
 * writing first the new rate is asked, then the old one.
 *   FATHOM_READY            the driver is at the new rate; or at the old one, where the device says that it has the new
 *                           one for the next power-on: sensor->next_baud is not 0, and fathom_hps167s_power_on moves
 *                           the driver
 *   FATHOM_ERR_UNCONFIRMED  it answers at neither. From now on the driver asks at both in turns until it is answered
 */
fathom_status_t fathom_hps167s_set_baud(fathom_hps167s_t *sensor, uint32_t baud);

/* #10: whether it measures by itself after power-on; from the next power-on. On from the factory. */
fathom_status_t fathom_hps167s_set_measures_after_power_on(fathom_hps167s_t *sensor, bool measures);

/* #11: the terminating resistor; from the next power-on. On from the factory in every unit: leave it on in the last one
 * of a line only, at the end that is not the host's. */
fathom_status_t fathom_hps167s_set_termination(fathom_hps167s_t *sensor, bool termination);

/*
 * #10 and #11 for ALL units on the line, whatever their addresses are (2.2.1), so also where several that are new from
 * the factory share address 1. No unit answers that: it is sent once, nothing is read, and the outcome is
 *   FATHOM_ERR_UNCONFIRMED  it was sent. Ask each unit for its configuration
 *   FATHOM_ERR_BUSY         another command or setting is not finished
 *   others                  of fathom_poll: nothing was sent
 * Nothing else in this library is ever sent to unit 0.
 */
fathom_status_t fathom_hps167s_set_measures_after_power_on_of_all_units(fathom_hps167s_t *sensor,
                                                                        bool measures);
fathom_status_t fathom_hps167s_set_termination_of_all_units(fathom_hps167s_t *sensor, bool termination);

/* #12: is added to what it measures; real 200 and measured 215 mm make -15. WRITE-ONLY; whether it replaces the offset
 * before or adds to it is not in the datasheet: measure afterwards. */
fathom_status_t fathom_hps167s_set_distance_offset_mm(fathom_hps167s_t *sensor, int16_t offset_mm);

/* #13: loads the settings of the measuring part, those that the user has set or those from the factory, which UNDOES
 * the user's for good. WRITE-ONLY. Which settings that are is not in the datasheet; those of the interface are #6's. */
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
 * #2 is read first; then, if the device is elsewhere, address 1 at 19200 is asked whether somebody is there, which
 * costs a time-out. Where config.modbus.settings is NULL the driver follows to the address alone.
 *   FATHOM_READY            it says that it is done, or is where it was not before; and was read there. The driver asks
 *                           there from now on
 *   FATHOM_ERR_IN_USE       somebody answers at address 1; nothing was sent
 *   FATHOM_ERR_EXCEPTION    it refused: sensor->reset_response has the device's own error code; where that is
 *                           FATHOM_HPS167S_NO_RESET_RESPONSE it was a Modbus exception, whose number is in
 *                           fathom_hps167s_exception
 *   FATHOM_ERR_UNCONFIRMED  it was sent, and the device answers nowhere, or it says nothing of success where it was
 *   FATHOM_ERR_BUSY         another command or setting is not finished
 *   others                  of fathom_poll: it was not reset
 * Its response 00 01 is also that of #4 for one degree: what was asked before has been answered by then, since #2 was
 * read after it.
 */
fathom_status_t fathom_hps167s_restore_factory_settings(fathom_hps167s_t *sensor);

#ifdef __cplusplus
}
#endif

#endif
