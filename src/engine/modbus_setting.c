/* SPDX-License-Identifier: MIT */
#include "fathom/engine/internal/modbus_setting.h"

#include "modbus_unit_internal.h"

/* fathom_modbus_unit_t::step: four reads, and behind them two writes. */
enum { READ_OLD = 0, PROBE_NEW = 1, CONFIRM_NEW = 2, CONFIRM_OLD = 3, WRITE = 4, WRITE_UNREAD = 5 };

static void use_new_address(fathom_modbus_unit_t *unit, const fathom_modbus_setting_t *setting)
{
    if (setting->address != 0u) unit->address = (uint8_t)setting->address;
    if (setting->line_settings != NULL) unit->line_settings = setting->line_settings;
}

static void restore_address(fathom_modbus_unit_t *unit)
{
    unit->address = unit->known_address;
    unit->line_settings = unit->known_line_settings;
}

/* The bit of the present setting. Two whose ids are equal modulo 16 share one: then one is written without need, once. */
static uint16_t setting_bit(const fathom_modbus_unit_t *unit)
{
    return (uint16_t)(1u << (unit->setting % 16u));
}

static bool moves(const fathom_modbus_setting_t *setting)
{
    return (setting->address != 0u) || (setting->line_settings != NULL);
}

/* Can the value that the device reports be trusted? Not where it was written and has not read back since, unless this
 * very value was written last, and was acknowledged or another one was read before. */
static bool is_certain(const fathom_modbus_unit_t *unit, const fathom_modbus_setting_t *setting)
{
    return moves(setting) || ((unit->unconfirmed & setting_bit(unit)) == 0u) ||
           ((unit->last_written == unit->setting) && (unit->last_written_value == (uint16_t)setting->value));
}

/* After the first read: is there anything to do? */
static fathom_status_t old_was_read(fathom_modbus_unit_t *unit, const fathom_modbus_setting_t *setting,
                                    fathom_status_t status, uint32_t value)
{
    if (status < 0) return status;
    if (value == setting->value) {
        if (is_certain(unit, setting)) return status;
        unit->step = WRITE_UNREAD;
        return FATHOM_PENDING;
    }
    unit->step = WRITE;
    if (setting->address != 0u) {
        unit->step = PROBE_NEW;
        use_new_address(unit, setting);
    }
    return FATHOM_PENDING;
}

/*
 * A read at the new address: only silence shows that it is free. A busy line and another master prove nothing about
 * it: the setting ends with that error, and nothing is written.
 */
static fathom_status_t new_was_probed(fathom_modbus_unit_t *unit, fathom_status_t status)
{
    restore_address(unit);
    unit->step = WRITE;
    if (status == FATHOM_ERR_NO_RESPONSE) return FATHOM_PENDING;
    const bool is_heard = (status == FATHOM_OK) || (status == FATHOM_ERR_EXCEPTION) ||
                          (status == FATHOM_ERR_CHECKSUM) || (status == FATHOM_ERR_MALFORMED);
    return is_heard ? FATHOM_ERR_IN_USE : status;
}

/* The write was submitted and ended before it was sent. A broken port may have sent a part of it. */
static bool has_not_left(const fathom_modbus_unit_t *unit, fathom_status_t status)
{
    return (unit->request.transaction.attempts == 0u) && (status != FATHOM_ERR_PORT);
}

static fathom_status_t written(fathom_modbus_unit_t *unit, const fathom_modbus_setting_t *setting,
                               fathom_status_t status)
{
    unit->outcome = (int8_t)status;
    if (has_not_left(unit, status)) unit->is_written = false;
    if (!unit->is_written || (status == FATHOM_ERR_EXCEPTION)) return status;
    unit->unconfirmed |= setting_bit(unit);
    /* The value may have read so before: only the acknowledgement shows that it was taken. */
    unit->last_written = 0;
    if ((unit->step == WRITE_UNREAD) && (status < 0)) return FATHOM_ERR_UNCONFIRMED;
    unit->last_written = unit->setting;
    unit->last_written_value = (uint16_t)setting->value;
    if (unit->is_blind) return FATHOM_ERR_UNCONFIRMED;
    if (setting->read == NULL) return status;
    unit->step = CONFIRM_OLD;
    if (moves(setting)) {
        unit->step = CONFIRM_NEW;
        fathom_line_cancel_unit(unit->transport.line, unit->address);
        use_new_address(unit, setting);
    }
    return FATHOM_PENDING;
}

static fathom_status_t confirmed(fathom_modbus_unit_t *unit, const fathom_modbus_setting_t *setting,
                                 fathom_status_t status, uint32_t value)
{
    if ((status == FATHOM_OK) && (value == setting->value)) {
        unit->unconfirmed &= (uint16_t)~setting_bit(unit);
        return FATHOM_OK;
    }
    if (unit->step == CONFIRM_NEW) {
        unit->step = CONFIRM_OLD;
        restore_address(unit);
        return FATHOM_PENDING;
    }
    if (status < 0) return FATHOM_ERR_UNCONFIRMED;
    return (unit->outcome < 0) ? (fathom_status_t)unit->outcome : FATHOM_ERR_DIFFERS;
}

static fathom_status_t was_read(fathom_modbus_unit_t *unit, const fathom_modbus_setting_t *setting,
                                fathom_status_t status, uint32_t value)
{
    if (unit->step == READ_OLD) return old_was_read(unit, setting, status, value);
    if (unit->step == PROBE_NEW) return new_was_probed(unit, status);
    return confirmed(unit, setting, status, value);
}

fathom_status_t fathom_modbus_write_next_unchecked(fathom_modbus_unit_t *unit)
{
    if (unit->transport.line == NULL) return FATHOM_ERR_ARGUMENT;
    if ((unit->setting != 0u) && !fathom_modbus_command_give_way(unit)) return FATHOM_ERR_BUSY;
    unit->commands = &fathom_modbus_commands;
    unit->is_blind = true;
    return FATHOM_OK;
}

fathom_status_t fathom_modbus_refuse_argument(fathom_modbus_unit_t *unit)
{
    if (unit->setting == 0u) unit->is_blind = false;
    return FATHOM_ERR_ARGUMENT;
}

fathom_status_t fathom_modbus_set(fathom_modbus_unit_t *unit, const fathom_modbus_setting_t *setting)
{
    fathom_status_t status;
    if ((unit->setting != 0u) && (unit->setting != setting->write.id) &&
        !fathom_modbus_command_give_way(unit))
        return FATHOM_ERR_BUSY;
    if (unit->setting != 0u) {
        fathom_modbus_command_keep(unit);
    } else {
        unit->setting = setting->write.id;
        unit->is_written = false;
        unit->step = ((setting->read != NULL) && !unit->is_blind) ? READ_OLD : WRITE_UNREAD;
        unit->known_address = unit->address;
        unit->known_line_settings = unit->line_settings;
    }
    do {
        const bool is_write = (setting->read == NULL) || (unit->step >= WRITE);
        uint32_t value = 0;
        unit->is_in_setting = true;
        status = is_write ? fathom_modbus_command(unit, &setting->write) : setting->read(setting, &value);
        unit->is_in_setting = false;
        if (status == FATHOM_PENDING) return status;
        status = is_write ? written(unit, setting, status) : was_read(unit, setting, status, value);
    } while (status == FATHOM_PENDING);
    unit->setting = 0;
    unit->is_blind = false;
    return status;
}
