/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_A16_SETTINGS_H
#define FATHOM_A16_SETTINGS_H

#include <stdint.h>

#include "fathom/sensor/a16_modbus.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief Reads and sets the registers of an A16 that a16_modbus.h does not read (A16 6(3)).
 *
 * The functions use the driver of a16_modbus.h and the same line. No function waits. A setting is written at most once
 * and never retried. include/COST.md has the size of all settings in the row `a16_settings`. A program pays only for
 * the functions that it calls.
 *
 * @code
 * do {
 *     status = fathom_a16_modbus_set_switch_threshold_mm(&a16, 2000);
 *     everything_else();
 * } while (status == FATHOM_PENDING);
 * @endcode
 *
 * 1. **Calls.** Call a function with the same arguments until its result differs from FATHOM_PENDING. Use one function
 *    at a time. In the meantime fathom_poll() returns FATHOM_PENDING. If the function is not called for
 *    FATHOM_MODBUS_ABANDONED_US, the command is abandoned (modbus_unit.h, rule 5).
 *
 * 2. **Reads.** The `get` functions and fathom_a16_modbus_measure() write their output with FATHOM_OK only.
 *
 * | result of a read | cause |
 * |---|---|
 * | FATHOM_OK | the output is written |
 * | FATHOM_PENDING | the read is not finished: call again |
 * | FATHOM_ERR_MALFORMED | the unit sent another frame, or a value that the register cannot have |
 * | FATHOM_ERR_BUSY | another command or setting is not finished, or its result was not fetched |
 * | FATHOM_ERR_NO_RESPONSE | no response; a register that this variant does not have is probably silent too |
 * | other errors | as fathom_poll() (a16_modbus.h); after _LINE_BUSY and _OTHER_MASTER read again |
 *
 * 3. **Settings.** A `set` function reads the value first, because flash wears. If the value differs, the function
 *    writes it once and reads it back. fathom_a16_modbus_is_written() reports whether the value was written.
 *
 * | result of a setting | cause |
 * |---|---|
 * | FATHOM_OK | the unit has the value; if it was not written, the unit had it before |
 * | FATHOM_PENDING | the setting is not finished: call again |
 * | FATHOM_ERR_ARGUMENT | the argument is outside its range, or the unit is at address 0; nothing was sent |
 * | FATHOM_ERR_DIFFERS | the unit acknowledged the value, and reads back another value |
 * | FATHOM_ERR_UNCONFIRMED | the value was sent and could not be read back: the unit may have it or not |
 * | FATHOM_ERR_BUSY | another command or setting is not finished, or its result was not fetched |
 * | other errors, not written | as a read; nothing has changed |
 * | other errors, written | the unit refused (FATHOM_ERR_EXCEPTION), or the write failed and another value reads back |
 *
 * 4. **Power-off.** The datasheet states for register 0x0202 alone whether it is kept over power-off: it is not.
 *
 * 5. **Time.** A read ends within C and a setting within 5 C. In the terms of modbus_unit.h:
 *
 *        C = period_us + B(timeout_us, retries) + B(command_timeout_us, retries) + 2 S + 2 P
 */

/** @brief Registers (A16 6(3)). a16_modbus.h has the registers of the distances. */
enum {
    FATHOM_A16_REGISTER_TEMPERATURE = 0x0102,                  /**< Temperature; relatives only. */
    FATHOM_A16_REGISTER_ADDRESS = FATHOM_DYP_REGISTER_ADDRESS, /**< Address of the unit: 0x0200. */
    FATHOM_A16_REGISTER_OPERATING_MODE = 0x0202,               /**< Operating mode. WRITE-ONLY. */
    FATHOM_A16_REGISTER_SWITCH_POLARITY = 0x0205,              /**< Polarity of the switch output. */
    FATHOM_A16_REGISTER_SWITCH_THRESHOLD = 0x0206,             /**< Threshold of the switch output. */
    FATHOM_A16_REGISTER_AUTOMATIC_VALUE = 0x0207               /**< Distance of the automatic output. */
};

/** @brief Returns true if the last setting, or the setting in progress, was passed to the line as a write. */
bool fathom_a16_modbus_is_written(const fathom_a16_modbus_t *sensor);

/**
 * @brief Makes the next setting BLIND: it is written once to this unit, and nothing is read before or after it.
 *
 * Use this function if the responses of the device cannot be understood. A blind setting ends with
 * FATHOM_ERR_UNCONFIRMED if it was sent, acknowledged or not; the unit may have the value or not. It ends with
 * FATHOM_ERR_EXCEPTION if the unit refused it. With all other errors nothing was written. The address cannot be set
 * blindly: FATHOM_ERR_ARGUMENT. The first result of the setting other than FATHOM_PENDING uses this call up, also
 * FATHOM_ERR_BUSY and FATHOM_ERR_ARGUMENT. fathom_a16_modbus_cancel() and fathom_a16_modbus_power_on() undo this call.
 *
 * @param sensor  The driver.
 * @retval FATHOM_OK            The next setting is blind.
 * @retval FATHOM_ERR_BUSY      A setting is not finished.
 * @retval FATHOM_ERR_ARGUMENT  The driver is not initialised.
 */
fathom_status_t fathom_a16_modbus_write_next_unchecked(fathom_a16_modbus_t *sensor);

/** @brief Cancels the measurement, command or setting in progress. A setting in progress may be set or not. */
void fathom_a16_modbus_cancel(fathom_a16_modbus_t *sensor);

/**
 * @brief Measures one distance, whichever distance the driver reads repeatedly (0x0100, 0x0101).
 *
 * @param sensor  The driver.
 * @param value   The distance to read.
 * @param sample  Written with FATHOM_OK only, as by fathom_poll().
 * @return As a read (rule 2). A refused value is FATHOM_ERR_MALFORMED; an unknown `value` is FATHOM_ERR_ARGUMENT.
 */
fathom_status_t fathom_a16_modbus_measure(fathom_a16_modbus_t *sensor, fathom_dyp_value_t value,
                                          fathom_sample_t *sample);

/**
 * @brief Reads the temperature of the air or the water (0x0102), which relatives of the A16 measure.
 *
 * @param sensor          The driver. Its model has FATHOM_HAS_TEMPERATURE (model_facts.h); the A16 does not.
 * @param temperature_dc  The temperature in tenths of a degree C, signed. Written with FATHOM_OK only.
 * @retval FATHOM_ERR_UNSUPPORTED  The model does not have this register. Nothing was sent.
 * @return All other values: as a read (rule 2).
 */
fathom_status_t fathom_a16_modbus_get_temperature(fathom_a16_modbus_t *sensor, int16_t *temperature_dc);

/**
 * @brief Reads the address of the unit (0x0200).
 *
 * @param sensor   The driver.
 * @param address  The address, 0 to 255. Written with FATHOM_OK only.
 * @return As a read (rule 2).
 */
fathom_status_t fathom_a16_modbus_get_address(fathom_a16_modbus_t *sensor, uint8_t *address);

/**
 * @brief Sets the address of the unit (0x0200). The unit uses it from the acknowledgement on.
 *
 * The function reads the new address first, which costs one `command_timeout_us`. After FATHOM_OK the driver uses the
 * new address, after any error the old one. Requests of other drivers that wait for the old address end with
 * FATHOM_ERR_CANCELLED.
 *
 * @param sensor   The driver.
 * @param address  The new address, 1 to 254.
 * @retval FATHOM_ERR_IN_USE       A unit responds at the new address already. Nothing was written.
 * @retval FATHOM_ERR_UNCONFIRMED  The unit is at one of the two addresses.
 * @retval FATHOM_ERR_WARMING_UP   Silence does not prove yet that the new address is free. Nothing was written.
 * @return All other values: as a setting (rule 3).
 */
fathom_status_t fathom_a16_modbus_set_address(fathom_a16_modbus_t *sensor, uint8_t address);

/**
 * @brief Sets the address of the unit to 0. The unit may be lost by this.
 *
 * Address 0 is in the range of the datasheet, and it is the broadcast address of Modbus. The unit need not respond
 * there. A write to it would reach all units of the line. The driver reads the unit there from then on, and refuses
 * each further setting with FATHOM_ERR_ARGUMENT.
 *
 * @param sensor  The driver.
 * @return As fathom_a16_modbus_set_address().
 */
fathom_status_t fathom_a16_modbus_set_address_0(fathom_a16_modbus_t *sensor);

/** @brief The operating mode of an RS232 module (0x0202). */
typedef enum {
    FATHOM_A16_CONTROLLED = 0, /**< The module responds to Modbus only. */
    FATHOM_A16_AUTOMATIC = 1   /**< The automatic output that a Modbus request stopped returns. */
} fathom_a16_operating_mode_t;

/**
 * @brief Sets the operating mode (0x0202): WRITE-ONLY, and not kept over power-off.
 *
 * The mode has a meaning only after a Modbus request stopped the automatic output (RS232; A16 6(4), example 4). The
 * function reads the address first. FATHOM_OK is the acknowledgement and proves no more: a read would stop the output
 * again. a16_rs232.h waits for the first frame instead.
 *
 * @param sensor  The driver.
 * @param mode    The mode.
 * @retval FATHOM_OK               The unit acknowledged the mode.
 * @retval FATHOM_ERR_UNCONFIRMED  The mode was sent and not acknowledged.
 * @return All other values: as a setting (rule 3).
 */
fathom_status_t fathom_a16_modbus_set_operating_mode(fathom_a16_modbus_t *sensor,
                                                     fathom_a16_operating_mode_t mode);

/** @brief The polarity of the switch output (0x0205). */
typedef enum {
    FATHOM_A16_NEGATIVE = 0, /**< The output is low if a target is nearer than the threshold. */
    FATHOM_A16_POSITIVE = 1  /**< The output is high if a target is nearer. The factory setting (A16 4(2)). */
} fathom_a16_polarity_t;

/**
 * @brief Reads the polarity of the switch output (0x0205). Switch variant only.
 *
 * @param sensor    The driver.
 * @param polarity  Written with FATHOM_OK only.
 * @return As a read (rule 2).
 */
fathom_status_t fathom_a16_modbus_get_switch_polarity(fathom_a16_modbus_t *sensor,
                                                      fathom_a16_polarity_t *polarity);

/**
 * @brief Sets the polarity of the switch output (0x0205). Switch variant only.
 *
 * If a16_switch.h reads the output, call fathom_a16_switch_set_polarity() instead.
 *
 * @param sensor    The driver.
 * @param polarity  The polarity.
 * @return As a setting (rule 3).
 */
fathom_status_t fathom_a16_modbus_set_switch_polarity(fathom_a16_modbus_t *sensor,
                                                      fathom_a16_polarity_t polarity);

/**
 * @brief Reads the threshold of the switch output (0x0206). Switch variant only.
 *
 * @param sensor        The driver.
 * @param threshold_mm  The threshold in millimetres, 0 to 65535. Written with FATHOM_OK only.
 * @return As a read (rule 2).
 */
fathom_status_t fathom_a16_modbus_get_switch_threshold_mm(fathom_a16_modbus_t *sensor,
                                                          uint16_t *threshold_mm);

/**
 * @brief Sets the threshold of the switch output (0x0206). Switch variant only. 1000 mm with factory settings.
 *
 * @param sensor        The driver.
 * @param threshold_mm  The threshold in millimetres, 1 to 16350, which is all that the module can measure. The
 *                      datasheet prints no range.
 * @return As a setting (rule 3).
 */
fathom_status_t fathom_a16_modbus_set_switch_threshold_mm(fathom_a16_modbus_t *sensor, uint16_t threshold_mm);

/**
 * @brief Reads which distance the automatic output sends (0x0207). RS232 variant only.
 *
 * @param sensor  The driver.
 * @param value   Written with FATHOM_OK only.
 * @return As a read (rule 2).
 */
fathom_status_t fathom_a16_modbus_get_automatic_value(fathom_a16_modbus_t *sensor, fathom_dyp_value_t *value);

/**
 * @brief Sets which distance the automatic output sends (0x0207). RS232 variant only.
 *
 * @param sensor  The driver.
 * @param value   The distance.
 * @return As a setting (rule 3).
 */
fathom_status_t fathom_a16_modbus_set_automatic_value(fathom_a16_modbus_t *sensor, fathom_dyp_value_t value);

#ifdef __cplusplus
}
#endif

#endif
