/* SPDX-License-Identifier: MIT */
#include "fathom/hps167s_settings.h"

#include "fathom/hps167s_info.h"
#include "hps167s_inside.h"

/* Where the commands are (table 8). */
enum {
    FACTORY_RESET = 0x0009, /* a read */
    WARM_UP = 0x000A,
    ADDRESS = 0x0010,
    BAUD = 0x0011,
    MEASURES = 0x0012,
    TERMINATION = 0x0013,
    OFFSET = 0x0014,
    LOAD = 0x0015,
    FILTER = 0x0016,
    RECONNECT = 0x0020 /* two registers */
};

enum { OFF = 0x0000, ON = 0x00FF, USER = 0x0000, FACTORY = 0x00FF };
enum { RESET_DONE = 1, RECONNECT_STEP_MS = 18 };
enum { TO_ALL = 1 }; /* in wanted[1], where settings of one register have 0 */

#define FACTORY_BAUD 19200ul

/* ---- what is read back ---- */

/* What a setting asks about, and of whom. */
typedef struct {
    fathom_hps167s_t *sensor;
    uint16_t command;
} look_t;

static bool is_at_home(const fathom_modbus_unit_t *unit)
{
    return unit->address == unit->home_address && unit->settings == unit->home_settings;
}

/*
 * #6 is past and the device answers #2: was it reset? It was if it says so, and if it has moved; it was not if it still
 * has another address than 1. The first look comes before.
 */
static fathom_status_t look_for_reset(fathom_hps167s_t *sensor, uint32_t *value)
{
    const bool is_done = sensor->reset_answer == RESET_DONE || !is_at_home(&sensor->unit);
    const bool is_first = !sensor->is_looked_at;
    sensor->is_looked_at = true;
    if (!is_done && !is_first && sensor->unit.address == 1) return FATHOM_ERR_UNCONFIRMED;
    *value = is_done ? RESET_DONE : 0;
    return FATHOM_READY;
}

static bool is_reset_refused(const fathom_hps167s_t *sensor)
{
    return sensor->reset_answer != FATHOM_HPS167S_NO_RESET_ANSWER && sensor->reset_answer != RESET_DONE;
}

static bool is_baud_code(uint8_t code) { return code >= 1 && code <= 4; }

/* At which rate is it asked now? For settings of the baud rate, which have line settings. */
static uint32_t present_baud(const fathom_hps167s_t *sensor)
{
    const fathom_line_settings_t *const settings = sensor->unit.settings;
    return settings != NULL ? settings->baud : sensor->question.settings->baud;
}

static fathom_status_t look_at(const look_t *look, const fathom_hps167s_configuration_t *is, uint32_t *value)
{
    switch (look->command) {
    case WARM_UP:
        *value = is->warm_up_s;
        break;
    case BAUD: /* a code without a rate of its own tells less than where the answer came from */
        *value = is_baud_code(is->baud_code) ? is->baud : present_baud(look->sensor);
        break;
    case MEASURES:
        *value = is->measures_after_power_on ? ON : OFF;
        break;
    case TERMINATION:
        *value = is->termination ? ON : OFF;
        break;
    case RECONNECT:
        *value = is->reconnect_time_ms;
        break;
    default:
        return look_for_reset(look->sensor, value);
    }
    return FATHOM_READY;
}

static fathom_status_t look(void *driver, uint32_t *value)
{
    const look_t *const wanted = driver;
    fathom_hps167s_t *const sensor = wanted->sensor;
    fathom_hps167s_configuration_t configuration;
    fathom_hps167s_version_t version;
    /* It has said that it was not reset, so it is where it was: nothing is to be asked. */
    if (wanted->command == FACTORY_RESET && is_reset_refused(sensor)) return FATHOM_ERR_EXCEPTION;
    *value = sensor->unit.address;
    if (wanted->command == ADDRESS) return fathom_hps167s_interface_version(sensor, &version);
    const fathom_status_t status = fathom_hps167s_configuration(sensor, &configuration);
    return status == FATHOM_READY ? look_at(wanted, &configuration, value) : status;
}

/* ---- what is set ---- */

static void begin(fathom_hps167s_t *sensor, uint16_t command, fathom_modbus_question_t *write, look_t *wanted,
                  fathom_modbus_setting_t *setting)
{
    fathom_hps167s_describe(sensor, command, write);
    write->values = sensor->wanted;
    write->count = 1;
    write->retries = 0;
    write->function = FATHOM_MODBUS_WRITE_SINGLE_REGISTER;
    wanted->sensor = sensor;
    wanted->command = command;
    setting->read = look;
    setting->driver = wanted;
    setting->write = write;
    setting->settings = NULL;
    setting->address = 0;
}

/*
 * May the setting go on, or begin? Then, where it is not known at which rate the device is, or where nothing else would
 * be read, with one question that changes nothing.
 */
static fathom_status_t prepare(fathom_hps167s_t *sensor, const fathom_modbus_setting_t *setting,
                               uint16_t first, uint16_t second)
{
    const uint16_t under_way = sensor->unit.setting;
    uint16_t *const wanted = sensor->wanted;
    if (under_way != 0) { /* to load the user's settings is not to load the factory's */
        const bool is_this = under_way == fathom_modbus_unit_name(setting->write);
        return is_this && wanted[0] == first && wanted[1] == second ? FATHOM_READY : FATHOM_ERR_BUSY;
    }
    sensor->unit.is_written = false; /* nor will it be before that is answered */
    if (!sensor->unit.is_blind && (sensor->is_seeking || setting->read == NULL)) {
        fathom_hps167s_version_t version;
        const fathom_status_t status = fathom_hps167s_interface_version(sensor, &version);
        if (status != FATHOM_READY) return status;
    }
    wanted[0] = first;
    wanted[1] = second;
    return FATHOM_READY;
}

static fathom_status_t set(fathom_hps167s_t *sensor, const fathom_modbus_setting_t *setting, uint16_t first,
                           uint16_t second)
{
    const fathom_status_t status = prepare(sensor, setting, first, second);
    return status == FATHOM_READY ? fathom_modbus_set(&sensor->unit, setting) : status;
}

/* A register with a value that #2 tells, or that nobody tells. */
static fathom_status_t set_register(fathom_hps167s_t *sensor, uint16_t command, uint16_t value, bool is_told)
{
    fathom_modbus_question_t write;
    fathom_modbus_setting_t setting;
    look_t wanted;
    begin(sensor, command, &write, &wanted, &setting);
    if (!is_told) setting.read = NULL;
    setting.value = value;
    return set(sensor, &setting, value, 0);
}

fathom_status_t fathom_hps167s_next_is_blind(fathom_hps167s_t *sensor)
{
    return fathom_modbus_next_is_blind(&sensor->unit);
}

bool fathom_hps167s_is_written(const fathom_hps167s_t *sensor) { return sensor->unit.is_written; }

fathom_status_t fathom_hps167s_set_warm_up_s(fathom_hps167s_t *sensor, uint8_t warm_up_s)
{
    const fathom_status_t status = set_register(sensor, WARM_UP, warm_up_s, true);
    if (status == FATHOM_READY) fathom_hps167s_expect_warm_up(sensor, warm_up_s);
    return status;
}

fathom_status_t fathom_hps167s_set_measures_after_power_on(fathom_hps167s_t *sensor, bool measures)
{
    return set_register(sensor, MEASURES, measures ? ON : OFF, true);
}

fathom_status_t fathom_hps167s_set_termination(fathom_hps167s_t *sensor, bool termination)
{
    return set_register(sensor, TERMINATION, termination ? ON : OFF, true);
}

fathom_status_t fathom_hps167s_set_distance_offset_mm(fathom_hps167s_t *sensor, int16_t offset_mm)
{
    /* it may add to the offset that is there, so that none is ever written twice */
    if (sensor->unit.is_blind) return FATHOM_ERR_ARGUMENT;
    return set_register(sensor, OFFSET, (uint16_t)offset_mm, false);
}

fathom_status_t fathom_hps167s_load_user_settings(fathom_hps167s_t *sensor)
{
    return set_register(sensor, LOAD, USER, false);
}

fathom_status_t fathom_hps167s_load_factory_settings(fathom_hps167s_t *sensor)
{
    return set_register(sensor, LOAD, FACTORY, false);
}

fathom_status_t fathom_hps167s_set_filter_sensitivity(fathom_hps167s_t *sensor, int16_t sensitivity)
{
    return set_register(sensor, FILTER, (uint16_t)sensitivity, false);
}

fathom_status_t fathom_hps167s_set_reconnect_time_ms(fathom_hps167s_t *sensor, uint32_t reconnect_time_ms)
{
    const uint16_t above = (uint16_t)(reconnect_time_ms >> 16);
    const uint16_t below = (uint16_t)reconnect_time_ms;
    fathom_modbus_question_t write;
    fathom_modbus_setting_t setting;
    look_t wanted;
    if (reconnect_time_ms % RECONNECT_STEP_MS != 0) return FATHOM_ERR_ARGUMENT;
    begin(sensor, RECONNECT, &write, &wanted, &setting);
    write.function = FATHOM_MODBUS_WRITE_MULTIPLE_REGISTERS;
    write.count = 2;
    setting.value = reconnect_time_ms;
    return sensor->low_word_first ? set(sensor, &setting, below, above) : set(sensor, &setting, above, below);
}

/* ---- to all units ---- */

static fathom_status_t set_all(fathom_hps167s_t *sensor, uint16_t command, bool is_on)
{
    fathom_modbus_unit_t *const unit = &sensor->unit;
    const uint8_t home = unit->address;
    const uint16_t value = is_on ? ON : OFF;
    fathom_modbus_question_t write;
    fathom_modbus_setting_t setting;
    look_t wanted;
    begin(sensor, command, &write, &wanted, &setting);
    setting.value = value;
    if (unit->setting == 0) unit->is_blind = true;
    fathom_status_t status = prepare(sensor, &setting, value, TO_ALL);
    if (status != FATHOM_READY) return status;
    unit->address = FATHOM_MODBUS_BROADCAST;
    status = fathom_modbus_set(unit, &setting);
    unit->address = home;
    unit->home_address = home;
    unit->given = 0; /* sent is not acknowledged */
    return status;
}

fathom_status_t fathom_hps167s_set_measures_after_power_on_of_all_units(fathom_hps167s_t *sensor,
                                                                        bool measures)
{
    return set_all(sensor, MEASURES, measures);
}

fathom_status_t fathom_hps167s_set_termination_of_all_units(fathom_hps167s_t *sensor, bool termination)
{
    return set_all(sensor, TERMINATION, termination);
}

/* ---- what moves the device ---- */

fathom_status_t fathom_hps167s_set_address(fathom_hps167s_t *sensor, uint8_t address)
{
    fathom_modbus_question_t write;
    fathom_modbus_setting_t setting;
    look_t wanted;
    if (address == 0 || address > FATHOM_HPS167S_MAX_ADDRESS) return FATHOM_ERR_ARGUMENT;
    begin(sensor, ADDRESS, &write, &wanted, &setting);
    setting.value = address;
    setting.address = address;
    return set(sensor, &setting, address, 0);
}

/* The code of #9; 0: there is none for this rate. */
static uint16_t code_of(uint32_t baud)
{
    if (baud == 19200ul) return 1;
    if (baud == 57600ul) return 2;
    if (baud == 115200ul) return 3;
    return baud == 230400ul ? 4 : 0;
}

/* The device has been told to be at this rate: is it, or will it be? */
static void expect_baud(fathom_hps167s_t *sensor, uint32_t baud)
{
    const fathom_line_settings_t *const here = fathom_hps167s_here(sensor);
    sensor->next_baud = here != NULL && here->baud != baud ? baud : 0;
}

fathom_status_t fathom_hps167s_set_baud(fathom_hps167s_t *sensor, uint32_t baud)
{
    const uint16_t code = code_of(baud);
    fathom_modbus_question_t write;
    fathom_modbus_setting_t setting;
    look_t wanted;
    if (code == 0 || sensor->question.settings == NULL) return FATHOM_ERR_ARGUMENT;
    begin(sensor, BAUD, &write, &wanted, &setting);
    setting.value = baud;
    fathom_status_t status = prepare(sensor, &setting, code, 0);
    if (status != FATHOM_READY) return status;
    if (fathom_hps167s_here(sensor)->baud != baud) {
        setting.settings = fathom_hps167s_with_baud(sensor, baud);
        setting.address = sensor->unit.address; /* so that it is looked there first */
    }
    status = fathom_modbus_set(&sensor->unit, &setting);
    if (status == FATHOM_READY) expect_baud(sensor, baud);
    if (status == FATHOM_ERR_UNCONFIRMED && setting.settings != NULL) {
        sensor->other = setting.settings;
        sensor->is_seeking = true;
    }
    return status;
}

fathom_status_t fathom_hps167s_restore_factory_settings(fathom_hps167s_t *sensor)
{
    const fathom_modbus_unit_t *const unit = &sensor->unit;
    fathom_modbus_question_t write;
    fathom_modbus_setting_t setting;
    look_t wanted;
    if (sensor->unit.is_blind) return FATHOM_ERR_ARGUMENT;
    begin(sensor, FACTORY_RESET, &write, &wanted, &setting);
    write.function = 0;
    write.values = &sensor->reset_answer;
    setting.value = RESET_DONE;
    fathom_status_t status = prepare(sensor, &setting, 0, 0);
    if (status != FATHOM_READY) return status;
    const bool begins = unit->setting == 0;
    const fathom_line_settings_t *const here = fathom_hps167s_here(sensor);
    if (here != NULL && here->baud != FACTORY_BAUD)
        setting.settings = fathom_hps167s_with_baud(sensor, FACTORY_BAUD);
    if ((begins ? unit->address : unit->home_address) != 1 || setting.settings != NULL) setting.address = 1;
    if (begins) {
        sensor->reset_answer = FATHOM_HPS167S_NO_RESET_ANSWER;
        sensor->is_looked_at = false;
    }
    status = fathom_modbus_set(&sensor->unit, &setting);
    if (status == FATHOM_READY) {
        expect_baud(sensor, FACTORY_BAUD);
        fathom_hps167s_expect_warm_up(sensor, FATHOM_HPS167S_FACTORY_WARM_UP_S);
    }
    return status == FATHOM_ERR_UNCONFIRMED && is_reset_refused(sensor) ? FATHOM_ERR_EXCEPTION : status;
}
