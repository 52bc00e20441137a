/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_MODBUS_SETTING_H
#define FATHOM_MODBUS_SETTING_H

#include "fathom/engine/internal/modbus_command.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief A setting of a device: it is read, written once, and read back. The set functions of the drivers are built on
 * this file, and share these rules; users of a driver need not know the file.
 *
 * 1. **Read.** The value is read first. If it is the wanted value, nothing is written, because flash wears. There is one
 *    exception: if the previous write of this setting did not read back, the value is written again, because until the
 *    next power-on a device may report the value that it works with and keep another one. If the line is busy or another
 *    master interferes before the write, the setting ends with that error and nothing is written. After the write these
 *    errors are no confirmation.
 *
 * 2. **Probe.** If the setting changes the address or the line settings, a read at the new place shows whether a unit
 *    responds there already, and whether the port can do the line settings. The probe costs one time-out.
 *
 * 3. **Write.** The value is written once. A write is never retried.
 *
 * 4. **Follow.** The driver uses the new address or line settings from now on. Requests of other drivers that wait for
 *    the unit end with FATHOM_ERR_CANCELLED.
 *
 * 5. **Confirm.** The value is read back. If that fails at the new place, it is read at the old place too.
 *
 * A blind setting (fathom_modbus_write_next_unchecked()) consists of rule 3 alone. It is for a device whose responses
 * cannot be understood. The setting after it is not blind, however the blind one ends.
 *
 * While a setting is in progress there is no measurement: fathom_poll() returns FATHOM_PENDING. If a setting is started
 * and not called again, it gives way to the next call of another function after FATHOM_MODBUS_ABANDONED_US
 * (modbus_unit.h, rule 5). The value may then be set or not.
 *
 * A setting has at most 5 requests: the read, the probe, the write, and the reads at the new and at the old place. With
 * the terms of modbus_unit.h, and if `read` has one request, it ends at the latest after
 *
 *     4 C + period_us + B(command_timeout_us, 0) + S + P
 */

/** @brief A setting (struct fathom_modbus_setting). */
typedef struct fathom_modbus_setting fathom_modbus_setting_t;

/** @brief A setting, in the driver's memory. It must stay valid and unchanged until it is finished. */
struct fathom_modbus_setting {
    /**
     * @brief Reads the present value. NULL: the value cannot be read, and the acknowledgement of the write is the result.
     *
     * Called until it does not return FATHOM_PENDING. On FATHOM_OK it has written `*value`.
     */
    fathom_status_t (*read)(const fathom_modbus_setting_t *setting, uint32_t *value);
    /** @brief The driver; for `read`. */
    void *driver;
    /** @brief The request that writes, a command. Its id distinguishes the settings of one driver. */
    fathom_modbus_unit_request_t write;
    /** @brief The wanted value, as `read` returns it. */
    uint32_t value;
    /** @brief Line settings of the device after the write; NULL: unchanged. Must stay valid as long as the unit. */
    const fathom_line_settings_t *line_settings;
    /** @brief Address of the device after the write: 1 to 254; 256 for address 0; 0: unchanged. */
    uint16_t address;
};

/**
 * @brief Starts a setting, or continues with it. Call fathom_modbus_unit_poll() before.
 *
 * Call both functions with a setting of the same id until the result differs from FATHOM_PENDING. After that,
 * `unit->is_written` states whether the write was sent.
 *
 * @param unit     The unit.
 * @param setting  The setting.
 * @retval FATHOM_OK               The value was right before and nothing was written; or it was written and read back; or
 *                                 it cannot be read back and was acknowledged.
 * @retval FATHOM_PENDING          The setting is not finished.
 * @retval FATHOM_ERR_IN_USE       A unit responds at the new place, or noise there may be a damaged response. Nothing was
 *                                 written.
 * @retval FATHOM_ERR_UNCONFIRMED  The value was written, or the port broke during the write, and the device could be read
 *                                 neither at the new place nor at the old one. The device is at one of the two; the
 *                                 driver uses the old one. For a setting without `read`: there was no acknowledgement.
 *                                 For a blind setting: the write was sent, acknowledged or not.
 * @retval FATHOM_ERR_WARMING_UP   So soon after power-on, no response does not prove that the new place is free. Nothing
 *                                 was written.
 * @retval FATHOM_ERR_DIFFERS      The device acknowledged the value, and another value reads back.
 * @retval FATHOM_ERR_BUSY         Another command or setting is not finished. Nothing was written.
 * @return Other errors are those of fathom_modbus_command(). If `unit->is_written` is false, nothing changed. Otherwise
 *         the device refused the value, or the write failed with this error and another value was read back.
 */
fathom_status_t fathom_modbus_set(fathom_modbus_unit_t *unit, const fathom_modbus_setting_t *setting);

/**
 * @brief Makes the next setting blind. Cancelling and power-on undo this.
 *
 * @param unit  The unit.
 * @retval FATHOM_OK            The next setting is blind.
 * @retval FATHOM_ERR_BUSY      A setting is not finished. Nothing changed.
 * @retval FATHOM_ERR_ARGUMENT  The unit is not initialised.
 */
fathom_status_t fathom_modbus_write_next_unchecked(fathom_modbus_unit_t *unit);

/**
 * @brief Refuses a setting because of its argument. The setting after it is not blind.
 *
 * A driver calls this function instead of fathom_modbus_set(). A setting in progress continues unchanged.
 *
 * @param unit  The unit.
 * @return FATHOM_ERR_ARGUMENT.
 */
fathom_status_t fathom_modbus_refuse_argument(fathom_modbus_unit_t *unit);

/** @brief Returns true if the next setting is blind, and no setting is in progress. */
static inline bool fathom_modbus_is_next_unchecked(const fathom_modbus_unit_t *unit)
{
    return unit->is_blind && (unit->setting == 0u);
}

#ifdef __cplusplus
}
#endif

#endif
