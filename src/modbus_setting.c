/* SPDX-License-Identifier: MIT */
#include "fathom/modbus_setting.h"

enum { LOOK = 0, LOOK_THERE = 1, WRITE = 2, CONFIRM_THERE = 3, CONFIRM_HERE = 4, WRITE_UNSEEN = 5, STEP = 7 };
enum { INSIDE = FATHOM_MODBUS_UNIT_INSIDE, ONCE = FATHOM_MODBUS_UNIT_ONCE };

static void go_there(fathom_modbus_unit_t *unit, const fathom_modbus_setting_t *setting)
{
    if (setting->address != 0) unit->address = (uint8_t)setting->address;
    if (setting->settings != NULL) unit->settings = setting->settings;
}

static void go_home(fathom_modbus_unit_t *unit)
{
    unit->address = unit->home_address;
    unit->settings = unit->home_settings;
}

/* Two settings whose ids are equal modulo 16 share one: then one is written without need, once. */
static uint16_t doubt_of(const fathom_modbus_unit_t *unit) { return (uint16_t)(1u << (unit->setting & 15)); }

static bool moves(const fathom_modbus_setting_t *setting)
{
    return setting->address != 0 || setting->settings != NULL;
}

/* Is what the device says of this setting all that there is to know of it? So it is where it said another value
 * before or acknowledged this one, was given it, and says so now. */
static bool is_told(const fathom_modbus_unit_t *unit, const fathom_modbus_setting_t *setting)
{
    return moves(setting) || (unit->doubts & doubt_of(unit)) == 0 ||
           (unit->given == unit->setting && unit->given_value == (uint16_t)setting->value);
}

/* After the first look: is there anything to do? */
static fathom_status_t looked(fathom_modbus_unit_t *unit, const fathom_modbus_setting_t *setting,
                              fathom_status_t status, uint32_t value)
{
    const bool is_so = value == setting->value;
    if (status < 0 || (is_so && is_told(unit, setting))) return status;
    unit->step = is_so ? WRITE_UNSEEN : WRITE;
    if (setting->address != 0) {
        unit->step = LOOK_THERE;
        go_there(unit, setting);
    }
    return FATHOM_PENDING;
}

/* At the new address: silence is what is hoped for. */
static fathom_status_t looked_there(fathom_modbus_unit_t *unit, fathom_status_t status)
{
    go_home(unit);
    unit->step = WRITE;
    if (status == FATHOM_ERR_NO_ANSWER) return FATHOM_PENDING;
    const bool is_heard = status == FATHOM_READY || status == FATHOM_ERR_EXCEPTION ||
                          status == FATHOM_ERR_CHECKSUM || status == FATHOM_ERR_MALFORMED;
    return is_heard ? FATHOM_ERR_IN_USE : status;
}

static fathom_status_t written(fathom_modbus_unit_t *unit, const fathom_modbus_setting_t *setting,
                               fathom_status_t status)
{
    unit->outcome = (int8_t)status;
    if (status == FATHOM_ERR_UNSUPPORTED) unit->is_written = false; /* taken, and it could not leave */
    if (!unit->is_written || status == FATHOM_ERR_EXCEPTION) return status;
    unit->doubts |= doubt_of(unit);
    /* What it tells may have been so before: the acknowledgement alone says that it has taken the value. */
    const bool is_lost = unit->step == WRITE_UNSEEN && status < 0;
    unit->given = is_lost ? 0 : unit->setting;
    unit->given_value = (uint16_t)setting->value;
    if (unit->is_blind || is_lost) return FATHOM_ERR_UNCONFIRMED;
    if (setting->read == NULL) return status;
    unit->step = CONFIRM_HERE;
    if (moves(setting)) {
        unit->step = CONFIRM_THERE;
        unit->modbus->cancel_unit(unit->modbus->ctx, unit->address);
        go_there(unit, setting);
    }
    return FATHOM_PENDING;
}

static fathom_status_t confirmed(fathom_modbus_unit_t *unit, const fathom_modbus_setting_t *setting,
                                 fathom_status_t status, uint32_t value)
{
    if (status == FATHOM_READY && value == setting->value) {
        unit->doubts &= (uint16_t)~doubt_of(unit);
        return FATHOM_READY;
    }
    if (unit->step == CONFIRM_THERE) {
        unit->step = CONFIRM_HERE;
        go_home(unit);
        return FATHOM_PENDING;
    }
    if (status < 0) return FATHOM_ERR_UNCONFIRMED;
    return unit->outcome < 0 ? (fathom_status_t)unit->outcome : FATHOM_ERR_DIFFERS;
}

static fathom_status_t go_on(fathom_modbus_unit_t *unit, const fathom_modbus_setting_t *setting,
                             fathom_status_t status, uint32_t value)
{
    switch (unit->step) {
    case LOOK:
        return looked(unit, setting, status, value);
    case LOOK_THERE:
        return looked_there(unit, status);
    case WRITE:
    case WRITE_UNSEEN:
        return written(unit, setting, status);
    default:
        return confirmed(unit, setting, status, value);
    }
}

fathom_status_t fathom_modbus_next_is_blind(fathom_modbus_unit_t *unit)
{
    if (unit->setting != 0) return FATHOM_ERR_BUSY;
    unit->is_blind = true;
    return FATHOM_READY;
}

fathom_status_t fathom_modbus_set(fathom_modbus_unit_t *unit, const fathom_modbus_setting_t *setting)
{
    fathom_status_t status;
    if (unit->setting == 0) {
        unit->setting = setting->write.id;
        unit->is_written = false;
        unit->step = setting->read != NULL && !unit->is_blind ? LOOK : WRITE_UNSEEN;
        unit->home_address = unit->address;
        unit->home_settings = unit->settings;
    } else if (unit->setting != setting->write.id) {
        return FATHOM_ERR_BUSY;
    }
    do {
        const bool is_write = setting->read == NULL || unit->step == WRITE || unit->step == WRITE_UNSEEN;
        uint32_t value = 0;
        unit->step = (uint8_t)(unit->step | (is_write ? INSIDE | ONCE : INSIDE));
        status = is_write ? fathom_modbus_unit_ask(unit, &setting->write) : setting->read(setting, &value);
        unit->step &= STEP;
        if (status == FATHOM_PENDING) return status;
        status = go_on(unit, setting, status, value);
    } while (status == FATHOM_PENDING);
    unit->setting = 0;
    unit->is_blind = false;
    return status;
}
