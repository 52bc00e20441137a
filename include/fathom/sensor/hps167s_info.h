/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_HPS167S_INFO_H
#define FATHOM_HPS167S_INFO_H

#include "fathom/sensor/hps167s.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * What can be read from an HPS-167S beside distances: commands #1 to #4. None of them changes anything.
 *
 * Each function returns at once: call it, with the loop going on in between, until it is not FATHOM_PENDING. *out is
 * written on FATHOM_OK only. A command takes its turn after a measurement that is under way, and until its outcome
 * was taken fathom_poll is FATHOM_PENDING; fathom_hps167s_cancel gives it up. The errors are those of fathom_poll, and
 *   FATHOM_ERR_BUSY       another command or setting is not finished, or its outcome was not taken
 *   FATHOM_ERR_CAPACITY   the line's frame buffer is too small (27 bytes for the details)
 * A command ends at the latest after C, in the terms of modbus_unit.h:
 *
 *     C = period_us + B(timeout_us, retries) + B(command_timeout_us, retries) + 2 S + 2 P
 *
 * The configuration (#2) is read at most 32 times, with a pause of at most 131 ms before each, and may then wait for one
 * command_timeout_us: 32 * (C + 131 ms) + command_timeout_us. Without unsolicited frames it is read at most 8 times.
 * A command that is begun and never called again gives way after FATHOM_MODBUS_ABANDONED_US.
 */

/* Command #4, table 16: of the analog front end, not of the air. The datasheet gives degrees Fahrenheit, and neither
 * sign nor scale: read as int16_t, in whole degrees (config.steps_per_degree). */
typedef struct {
    int16_t fahrenheit;     /* as the device sends it */
    int16_t temperature_dc; /* tenths of a degree Celsius, rounded to the nearest */
} fathom_hps167s_temperature_t;

/* #1: date and number of the interface's version. */
fathom_status_t fathom_hps167s_get_interface_version(fathom_hps167s_t *sensor, fathom_hps167s_version_t *out);

/*
 * #2. The response has the shape of a measurement's, and an unasked one may come instead. So it counts only if the
 * first two bytes are 00 or FF, if it is not the abnormal packet nor what was measured or heard last, and if two such
 * in succession agree (config.same_responses). Its baud code and reconnect time may have any value.
 * A frame that does not count came unasked. For 2 s after it three responses have to agree, and the requests leave at
 * irregular intervals, up to 131 ms apart beyond the period, or they would keep step with what the device sends by itself.
 * It is read up to 8 times, among unasked frames 32 times; FATHOM_ERR_MALFORMED: that was not enough. Where an unasked frame was taken for a response,
 * that is returned command_timeout_us later, when no response can come any more: it would be taken for the next
 * measurement. Of measured distances only exactly 255 mm can pass the first test.
 */
fathom_status_t fathom_hps167s_get_configuration(fathom_hps167s_t *sensor,
                                                 fathom_hps167s_configuration_t *out);

/* #3. FATHOM_ERR_MALFORMED also: without the byte B0 at its beginning. */
fathom_status_t fathom_hps167s_get_details(fathom_hps167s_t *sensor, fathom_hps167s_details_t *out);

/* #4. FATHOM_ERR_MALFORMED also: tenths of a degree Celsius would not fit an int16_t. */
fathom_status_t fathom_hps167s_get_temperature(fathom_hps167s_t *sensor, fathom_hps167s_temperature_t *out);

/* A frame of the shape of #5's response was heard from the sensor's address that no request of the sensor's waited for,
 * with these registers, at this time of its clock. False: it may be a late response to #2, and is no measurement.
 * hps167s_auto.h calls it; other listeners of the line may. */
bool fathom_hps167s_accept_unsolicited(fathom_hps167s_t *sensor, const uint16_t registers[4],
                                       uint32_t time_us);

#ifdef __cplusplus
}
#endif

#endif
