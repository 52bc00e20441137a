/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_A16_SETTINGS_H
#define FATHOM_A16_SETTINGS_H

#include <stdint.h>

#include "fathom/sensor/a16_modbus.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * The registers of an A16 (A16 6(3)) beside the distance that its driver reads again and again.
 *
 * Each function returns at once: call it with the same arguments, with the loop going on in
 * between, until it is not FATHOM_PENDING. One at a time; fathom_poll rests as long as a setting is being changed.
 * The longest time of a read is C, that of a setting 5 C, in the terms of modbus_unit.h:
 *
 *     C = period_us + B(timeout_us, retries) + B(command_timeout_us, retries) + 2 S + 2 P
 *
 * A command or setting that is begun and never called again gives way after FATHOM_MODBUS_ABANDONED_US.
 *
 * Reading: FATHOM_OK with *out written, or
 *   FATHOM_ERR_NO_RESPONSE, _CHECKSUM, _EXCEPTION, _PORT   as fathom_poll (a16_modbus.h). Where a register is not for
 *                           this variant, silence is likely: the datasheet knows no exceptions
 *   FATHOM_ERR_LINE_BUSY, _OTHER_MASTER   as fathom_poll; they say nothing about the unit: try again
 *   FATHOM_ERR_MALFORMED    a value that the register cannot have
 *   FATHOM_ERR_BUSY         another command is not finished, or its outcome was not taken
 * Setting: the value is read first, written only if it is another one (flash wears), and read back.
 * fathom_a16_modbus_is_written tells whether it was written:
 *   FATHOM_OK            it is so; not written: it was so before
 *   FATHOM_ERR_ARGUMENT     out of range; nothing was sent
 *   FATHOM_ERR_DIFFERS      the device acknowledged the value, and it reads back as another
 *   FATHOM_ERR_UNCONFIRMED  it was sent, and could not be read back: it may be set or not
 *   others                  as reading. Not written: nothing was changed. Written: the device refused it (exception),
 *                           or the write failed so and another value was read back
 * Whether a setting outlives power-off is in the datasheet for 0x0202 alone: it does not.
 */

/* Registers (A16 6(3)); 0x0100 and 0x0101 are in a16_modbus.h. */
enum {
    FATHOM_A16_REGISTER_ADDRESS = FATHOM_DYP_REGISTER_ADDRESS,
    FATHOM_A16_REGISTER_OPERATING_MODE = 0x0202,
    FATHOM_A16_REGISTER_SWITCH_POLARITY = 0x0205,
    FATHOM_A16_REGISTER_SWITCH_THRESHOLD = 0x0206,
    FATHOM_A16_REGISTER_AUTOMATIC_VALUE = 0x0207
};

/* Has the last setting, or the one under way, been handed to the line? */
bool fathom_a16_modbus_is_written(const fathom_a16_modbus_t *sensor);

/*
 * The next setting is BLIND: it is written without reading anything before or afterwards, once, and to this unit alone.
 * The address, 0x0200, is FATHOM_ERR_ARGUMENT then. The setting after it is not blind, however this one ends:
 * FATHOM_ERR_UNCONFIRMED: it was sent, and may be set or not, also where it was acknowledged; FATHOM_ERR_EXCEPTION: it
 * refused; others: nothing was written.
 * Here: FATHOM_OK, or FATHOM_ERR_BUSY: a setting is not finished. fathom_a16_modbus_cancel and power_on undo it.
 */
fathom_status_t fathom_a16_modbus_write_next_unchecked(fathom_a16_modbus_t *sensor);

/* Gives up what is under way, also a measurement. A setting that was under way may be set or not. */
void fathom_a16_modbus_cancel(fathom_a16_modbus_t *sensor);

/* Either distance, once: 0x0100 or 0x0101. *sample is written as by fathom_poll, and errors are as there. */
fathom_status_t fathom_a16_modbus_measure(fathom_a16_modbus_t *sensor, fathom_dyp_value_t value,
                                          fathom_sample_t *sample);

/*
 * The address, 0x0200. set: 1..254, from the acknowledgement on. The new address is read first, which costs a second:
 * FATHOM_ERR_IN_USE, a unit responds there. After FATHOM_OK the driver is at the new address, after any error at the
 * old one; after FATHOM_ERR_UNCONFIRMED the device is at one of the two. Other drivers' requests that wait for the old
 * address end with FATHOM_ERR_CANCELLED.
 */
fathom_status_t fathom_a16_modbus_get_address(fathom_a16_modbus_t *sensor, uint8_t *address);
fathom_status_t fathom_a16_modbus_set_address(fathom_a16_modbus_t *sensor, uint8_t address);

/* Sets the address to 0, which is in the datasheet's range and is the standard's broadcast: such a unit may not be
 * found again, since it need not respond there, and what is written to it would be written to all units. The driver
 * reads it there from then on, and sets nothing of it any more. Else as set_address. */
fathom_status_t fathom_a16_modbus_set_address_0(fathom_a16_modbus_t *sensor);

typedef enum {
    FATHOM_A16_CONTROLLED = 0,
    FATHOM_A16_AUTOMATIC = 1 /* the output that a Modbus request has ended goes on */
} fathom_a16_operating_mode_t;

/*
 * The operating mode, 0x0202; WRITE-ONLY, not kept over power-off. The address is read before. It means something only
 * where a Modbus request has ended automatic output (RS232). FATHOM_OK is the acknowledgement and no more
 * (FATHOM_ERR_UNCONFIRMED: there was none): whether frames come is heard, not read, since a read would end them again:
 * a16_rs232.h.
 */
fathom_status_t fathom_a16_modbus_set_operating_mode(fathom_a16_modbus_t *sensor,
                                                     fathom_a16_operating_mode_t mode);

typedef enum {
    FATHOM_A16_NEGATIVE = 0, /* low when nearer than the threshold */
    FATHOM_A16_POSITIVE = 1  /* high; from the factory */
} fathom_a16_polarity_t;

/* Polarity of the switch output, 0x0205; switch variant only. */
fathom_status_t fathom_a16_modbus_get_switch_polarity(fathom_a16_modbus_t *sensor,
                                                      fathom_a16_polarity_t *polarity);
fathom_status_t fathom_a16_modbus_set_switch_polarity(fathom_a16_modbus_t *sensor,
                                                      fathom_a16_polarity_t polarity);

/* Threshold of the switch output, 0x0206; switch variant only; 1000 mm from the factory. The datasheet gives no range:
 * 1..16350 mm is taken, all that the module can measure. */
fathom_status_t fathom_a16_modbus_get_switch_threshold_mm(fathom_a16_modbus_t *sensor,
                                                          uint16_t *threshold_mm);
fathom_status_t fathom_a16_modbus_set_switch_threshold_mm(fathom_a16_modbus_t *sensor, uint16_t threshold_mm);

/* Which distance the automatic output sends, 0x0207; RS232 variant only. */
fathom_status_t fathom_a16_modbus_get_automatic_value(fathom_a16_modbus_t *sensor, fathom_dyp_value_t *value);
fathom_status_t fathom_a16_modbus_set_automatic_value(fathom_a16_modbus_t *sensor, fathom_dyp_value_t value);

#ifdef __cplusplus
}
#endif

#endif
