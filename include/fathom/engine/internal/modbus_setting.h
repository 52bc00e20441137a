/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_MODBUS_SETTING_H
#define FATHOM_MODBUS_SETTING_H

#include "fathom/engine/internal/modbus_command.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * A setting of a device, read, written once and read back. The set functions of the drivers are built on it, and share
 * these rules:
 *
 *  1. The value is read. If it is the wanted one, nothing is written: flash wears. But where the last write of this
 *     setting did not read back, it is written: until the next power-on a device may report the value that it works
 *     with, and keep another.
 *     FATHOM_ERR_LINE_BUSY and FATHOM_ERR_OTHER_MASTER prove nothing: before the write they end the setting, and nothing
 *     is written. After the write they are no confirmation.
 *  2. Where the setting has an address (the new one, or with new line settings also the present one), a read there
 *     shows whether a unit responds already, and whether the port can do the line settings; that costs a time-out.
 *  3. The value is written, once: a write is never retried.
 *  4. The driver follows the device to its new address or line settings. Other drivers' requests that wait for the unit
 *     end with FATHOM_ERR_CANCELLED.
 *  5. The value is read back; where that fails at the new place, at the old one too.
 *
 * A blind setting (fathom_modbus_write_next_unchecked) is the third step alone: for a device whose responses cannot be
 * understood. The one after it is not blind, however this one ends.
 *
 * The measurement rests meanwhile: fathom_poll is FATHOM_PENDING. If the setting is begun and never called again, it gives
 * way to the next call of another function after FATHOM_MODBUS_ABANDONED_US (modbus_unit.h, rule 5); the value may then be
 * set or not.
 *
 * A setting has at most 5 requests: the read, the probe, the write, and the read at the new and at the old place. With the
 * time C of one command (modbus_unit.h) and a `read` of one request it ends at the latest after
 *
 *     4 C + period_us + B(command_timeout_us, 0) + S + P
 */
typedef struct fathom_modbus_setting fathom_modbus_setting_t;
struct fathom_modbus_setting {
    /* Reads the present value: called until it is not FATHOM_PENDING, and then with *value where it is
     * FATHOM_OK. NULL: it cannot be read, and the acknowledgement is all there is. */
    fathom_status_t (*read)(const fathom_modbus_setting_t *setting, uint32_t *value);
    void *driver;                       /* for read */
    fathom_modbus_unit_request_t write; /* a command; its id tells the settings of a driver apart */
    uint32_t value;                     /* what is wanted, as read gives it */
    /* Where the device is once it has taken the value. The settings are kept by the caller as long as the unit. */
    const fathom_line_settings_t *line_settings; /* NULL: as before */
    uint16_t address;                            /* 1..254; 0: as before; 256: address 0 */
};

/*
 * To be called after fathom_modbus_unit_poll, both with a setting of the same id until it is not FATHOM_PENDING.
 * unit->is_written tells whether anything was sent that changes the device:
 *   FATHOM_OK            not written: it was so already. Written: it was read back; where nothing can be read
 *                           back, it was acknowledged
 *   FATHOM_ERR_IN_USE       a unit responds at the new place already, or noise comes that may be a damaged response;
 *                           nothing was written
 *   FATHOM_ERR_UNCONFIRMED  it was written, or the port broke during that, and then the device could be read neither
 *                           at the new place nor at the old: it is at one of the two, and the driver stays at the old
 *                           one. Where nothing can be read back: it was not acknowledged. Blind: acknowledged or not
 *   FATHOM_ERR_WARMING_UP   so soon after power-on silence does not prove that the new place is free: not written
 *   FATHOM_ERR_DIFFERS      it acknowledged the value, and it reads back as another
 *   FATHOM_ERR_BUSY         another command or setting is not finished
 *   any other               of fathom_modbus_command. Not written: nothing was changed. Written: the device refused
 *                           it (exception), or the write failed so and another value was read back
 */
fathom_status_t fathom_modbus_set(fathom_modbus_unit_t *unit, const fathom_modbus_setting_t *setting);

/* Makes the next setting blind; cancel and power_on undo it. FATHOM_OK; FATHOM_ERR_BUSY: one is not finished. */
fathom_status_t fathom_modbus_write_next_unchecked(fathom_modbus_unit_t *unit);

#ifdef __cplusplus
}
#endif

#endif
