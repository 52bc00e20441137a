/* SPDX-License-Identifier: MIT */
/*
 * The settings #6 to #15 of the HPS-167S. Each fills in a fathom_modbus_setting_t, and modbus_setting.c reads, writes
 * and reads back.
 */
#include "fathom/sensor/hps167s_settings.h"

#include "hps167s_internal.h"

/* Kinds of settings. TO_ALL is also a bit of the id, because no address of a command has this bit. */
enum { READ_BACK = 0, WRITE_ONLY = 1, TO_ALL = 0x40 };

/* ---- Where the sensor is ---- */

/* Returns the line settings with another rate, stored in that element of `moved` that is not in use. */
static const fathom_line_settings_t *with_baud(fathom_hps167s_t *sensor, uint32_t baud)
{
    const fathom_line_settings_t *const old = sensor->unit.line_settings;
    fathom_line_settings_t *const there = &sensor->moved[(old == &sensor->moved[0]) ? 1 : 0];
    there->baud = baud;
    there->parity = old->parity;
    there->stop_bits = old->stop_bits;
    return there;
}

/* Swaps the present line settings with the other ones that the sensor may have. */
static void change_over(fathom_hps167s_t *sensor)
{
    const fathom_line_settings_t *const old = sensor->unit.line_settings;
    sensor->unit.line_settings = sensor->other;
    sensor->other = old;
}

static void seek(fathom_hps167s_t *sensor, const fathom_line_settings_t *other)
{
    sensor->other = other;
    sensor->is_seeking = true;
}

/*
 * Follows the sensor to another rate. Called at power-on with FATHOM_PENDING, and with the result of each request.
 * While the sensor is sought, a response shows that the present rate is right, and silence or damage selects the other
 * rate. No setting begins before the rate is known.
 */
static void follow(fathom_hps167s_t *sensor, fathom_status_t status)
{
    if ((status == FATHOM_PENDING) && (sensor->next_baud != 0u)) {
        seek(sensor, with_baud(sensor, sensor->next_baud));
        sensor->next_baud = 0;
        change_over(sensor);
    }
    if (!sensor->is_seeking) return;
    if (status == FATHOM_ERR_WARMING_UP) status = (fathom_status_t)sensor->unit.request.transaction.status;
    if ((status == FATHOM_OK) || (status == FATHOM_ERR_EXCEPTION) || (status == FATHOM_ERR_MALFORMED))
        sensor->is_seeking = false;
    else if ((status == FATHOM_ERR_NO_RESPONSE) || (status == FATHOM_ERR_CHECKSUM) ||
             (status == FATHOM_ERR_LINE_BUSY) || (status == FATHOM_ERR_OTHER_MASTER))
        change_over(sensor); /* At the wrong rate, unsolicited frames are noise, which makes the line busy. */
}

/* ---- Reading back ---- */

static bool is_at_home(const fathom_modbus_unit_t *unit)
{
    return (unit->address == unit->known_address) && (unit->line_settings == unit->known_line_settings);
}

/*
 * Decides from a response to #2 whether #6 has reset the sensor. It has, if the sensor reported success or has moved.
 * It has not, if the sensor still has another address than 1. In all other cases the result is unknown. The first call
 * comes before #6 is sent.
 */
static fathom_status_t look_for_reset(fathom_hps167s_t *sensor, uint32_t *value)
{
    const bool is_done = (sensor->reset_response == FATHOM_HPS167S_RESET_DONE) || !is_at_home(&sensor->unit);
    const bool is_first = !sensor->is_looked_at;
    sensor->is_looked_at = true;
    if (!is_done && !is_first && (sensor->unit.address == 1u)) return FATHOM_ERR_UNCONFIRMED;
    *value = is_done ? FATHOM_HPS167S_RESET_DONE : 0;
    return FATHOM_OK;
}

static bool is_reset_refused(const fathom_hps167s_t *sensor)
{
    return (sensor->reset_response != FATHOM_HPS167S_NO_RESET_RESPONSE) &&
           (sensor->reset_response != FATHOM_HPS167S_RESET_DONE);
}

/* Returns the reported baud code. If the code has no rate of its own, returns the code of the rate of the response. */
static uint8_t baud_code(const fathom_hps167s_t *sensor)
{
    const uint8_t code = fathom_hps167s_get_byte(sensor->values, FATHOM_HPS167S_BAUD_BYTE);
    const bool has_rate = fathom_hps167s_baud_code(fathom_hps167s_baud(code)) == code;
    return has_rate ? code : fathom_hps167s_baud_code(sensor->unit.line_settings->baud);
}

/* Reads the present value of a setting, in the form in which it is written. It is `read` of fathom_modbus_setting_t. */
static fathom_status_t look(const fathom_modbus_setting_t *setting, uint32_t *value)
{
    fathom_hps167s_t *const sensor = setting->driver;
    const uint16_t *const values = sensor->values;
    const uint8_t command = (uint8_t)setting->write.first;
    fathom_status_t status;
    if (command == FATHOM_HPS167S_ADDRESS) {
        *value = sensor->unit.address;
        return fathom_hps167s_ask_once(sensor, FATHOM_HPS167S_VERSION, FATHOM_HPS167S_VERSION_COUNT);
    }
    /* The sensor reported that it was not reset, so it is where it was, and no read is needed. */
    if ((command == FATHOM_HPS167S_RESET) && is_reset_refused(sensor)) return FATHOM_ERR_EXCEPTION;
    status = fathom_hps167s_read_configuration(sensor);
    if (status != FATHOM_OK) return status;
    switch (command) {
    case FATHOM_HPS167S_WARM_UP:
        sensor->warm_up_s = fathom_hps167s_get_byte(values, FATHOM_HPS167S_WARM_UP_BYTE);
        *value = sensor->warm_up_s;
        break;
    case FATHOM_HPS167S_BAUD:
        *value = baud_code(sensor);
        break;
    case FATHOM_HPS167S_MEASURES:
        *value = fathom_hps167s_get_byte(values, FATHOM_HPS167S_MEASURES_BYTE);
        break;
    case FATHOM_HPS167S_TERMINATION:
        *value = fathom_hps167s_get_byte(values, FATHOM_HPS167S_TERMINATION_BYTE);
        break;
    case FATHOM_HPS167S_RECONNECT:
        *value = fathom_hps167s_configured_reconnect_time_ms(values, sensor->low_word_first);
        break;
    default:
        status = look_for_reset(sensor, value);
        break;
    }
    return status;
}

/* ---- Settings at one place ---- */

/* Another setting is in progress. #13 loads the user's settings or those of the factory: the same id with another value
 * is another setting. */
static bool is_kept_out(const fathom_hps167s_t *sensor, uint8_t id, uint32_t value)
{
    const uint8_t setting = sensor->unit.setting;
    return (setting != 0u) && ((setting != id) || (sensor->setting.value != value));
}

/*
 * Begins a setting, or continues the one in progress. With FATHOM_OK, sensor->setting describes the setting; the caller
 * adds what is special to it and calls go_on().
 *
 * #1 is read first if the rate of the sensor is not known, and for a setting without read-back. That read shows that
 * the sensor is there, and whether the adapter echoes.
 */
static fathom_status_t begin(fathom_hps167s_t *sensor, uint8_t command, uint32_t value, uint8_t kind)
{
    fathom_modbus_unit_t *const unit = &sensor->unit;
    fathom_modbus_setting_t *const setting = &sensor->setting;
    const uint8_t id = (uint8_t)(fathom_hps167s_id(command) | (kind & TO_ALL));
    fathom_modbus_unit_poll(unit);
    if (is_kept_out(sensor, id, value) && !fathom_modbus_command_give_way(unit)) return FATHOM_ERR_BUSY;
    if (unit->setting == 0u) {
        if (kind == TO_ALL) unit->is_blind = true;
        unit->is_written = false; /* Nothing is written before the following read has ended. */
        if (!unit->is_blind && (sensor->is_seeking || (kind == WRITE_ONLY))) {
            const fathom_status_t status =
                fathom_hps167s_ask_once(sensor, FATHOM_HPS167S_VERSION, FATHOM_HPS167S_VERSION_COUNT);
            if (status != FATHOM_OK) return status;
        }
        /* #1 may still wait although a measurement has shown the rate. It would keep all other requests out. */
        const uint8_t version = fathom_hps167s_id(FATHOM_HPS167S_VERSION);
        if ((unit->command == version) && (unit->state == 0u)) unit->command = 0;
        setting->line_settings = NULL;
        setting->address = 0;
    }
    /* Filled in at each call, so that the request follows from this call alone. */
    setting->read = (kind == WRITE_ONLY) ? NULL : look;
    setting->driver = sensor;
    setting->value = value;
    setting->write.first = command;
    setting->write.last = (uint16_t)value;
    setting->write.function = FATHOM_MODBUS_WRITE_SINGLE_REGISTER;
    setting->write.id = id;
    return FATHOM_OK;
}

static fathom_status_t go_on(fathom_hps167s_t *sensor)
{
    return fathom_modbus_set(&sensor->unit, &sensor->setting);
}

static fathom_status_t set(fathom_hps167s_t *sensor, uint8_t command, uint16_t value, uint8_t kind)
{
    const fathom_status_t status = begin(sensor, command, value, kind);
    return (status == FATHOM_OK) ? go_on(sensor) : status;
}

fathom_status_t fathom_hps167s_write_next_unchecked(fathom_hps167s_t *sensor)
{
    return fathom_modbus_write_next_unchecked(&sensor->unit);
}

bool fathom_hps167s_is_written(const fathom_hps167s_t *sensor) { return sensor->unit.is_written; }

fathom_status_t fathom_hps167s_set_warm_up_s(fathom_hps167s_t *sensor, uint8_t warm_up_s)
{
    return set(sensor, FATHOM_HPS167S_WARM_UP, warm_up_s, READ_BACK);
}

static uint16_t switch_of(bool is_on) { return is_on ? FATHOM_HPS167S_ON : FATHOM_HPS167S_OFF; }

fathom_status_t fathom_hps167s_set_measures_after_power_on(fathom_hps167s_t *sensor, bool measures)
{
    return set(sensor, FATHOM_HPS167S_MEASURES, switch_of(measures), READ_BACK);
}

fathom_status_t fathom_hps167s_set_termination(fathom_hps167s_t *sensor, bool termination)
{
    return set(sensor, FATHOM_HPS167S_TERMINATION, switch_of(termination), READ_BACK);
}

fathom_status_t fathom_hps167s_set_distance_offset_mm(fathom_hps167s_t *sensor, int16_t offset_mm)
{
    /* The offset may add to the present one, and a blind setting may be a repetition. So none is written blind. */
    if (fathom_modbus_is_next_unchecked(&sensor->unit)) return fathom_modbus_refuse_argument(&sensor->unit);
    return set(sensor, FATHOM_HPS167S_OFFSET, (uint16_t)offset_mm, WRITE_ONLY);
}

fathom_status_t fathom_hps167s_load_user_settings(fathom_hps167s_t *sensor)
{
    return set(sensor, FATHOM_HPS167S_LOAD, FATHOM_HPS167S_USER, WRITE_ONLY);
}

fathom_status_t fathom_hps167s_load_factory_settings(fathom_hps167s_t *sensor)
{
    return set(sensor, FATHOM_HPS167S_LOAD, FATHOM_HPS167S_FACTORY, WRITE_ONLY);
}

fathom_status_t fathom_hps167s_set_filter_sensitivity(fathom_hps167s_t *sensor, int16_t sensitivity)
{
    return set(sensor, FATHOM_HPS167S_FILTER, (uint16_t)sensitivity, WRITE_ONLY);
}

fathom_status_t fathom_hps167s_set_reconnect_time_ms(fathom_hps167s_t *sensor, uint32_t reconnect_time_ms)
{
    fathom_modbus_unit_request_t *const write = &sensor->setting.write;
    if ((reconnect_time_ms % FATHOM_HPS167S_RECONNECT_STEP_MS) != 0u)
        return fathom_modbus_refuse_argument(&sensor->unit);
    const fathom_status_t status = begin(sensor, FATHOM_HPS167S_RECONNECT, reconnect_time_ms, READ_BACK);
    if (status != FATHOM_OK) return status;
    fathom_hps167s_encode_reconnect_time(reconnect_time_ms, sensor->low_word_first, sensor->words);
    write->values = sensor->words;
    write->last = FATHOM_HPS167S_RECONNECT_COUNT;
    write->function = FATHOM_MODBUS_WRITE_MULTIPLE_REGISTERS;
    return go_on(sensor);
}

/* ---- Broadcasts ---- */

static fathom_status_t set_all(fathom_hps167s_t *sensor, uint8_t command, bool is_on)
{
    fathom_modbus_unit_t *const unit = &sensor->unit;
    fathom_status_t status = begin(sensor, command, switch_of(is_on), TO_ALL);
    if (status != FATHOM_OK) return status;
    const uint8_t home = unit->address; /* An abandoned setting that moves the sensor has given way. */
    unit->address = FATHOM_MODBUS_BROADCAST;
    status = go_on(sensor);
    unit->address = home;
    unit->known_address = home;
    unit->last_written = 0; /* No unit acknowledges a broadcast. */
    return status;
}

fathom_status_t fathom_hps167s_broadcast_measures_after_power_on(fathom_hps167s_t *sensor, bool measures)
{
    return set_all(sensor, FATHOM_HPS167S_MEASURES, measures);
}

fathom_status_t fathom_hps167s_broadcast_termination(fathom_hps167s_t *sensor, bool termination)
{
    return set_all(sensor, FATHOM_HPS167S_TERMINATION, termination);
}

/* ---- Settings that move the sensor ---- */

fathom_status_t fathom_hps167s_set_address(fathom_hps167s_t *sensor, uint8_t address)
{
    if ((address == 0u) || (address > FATHOM_HPS167S_MAX_ADDRESS))
        return fathom_modbus_refuse_argument(&sensor->unit);
    const fathom_status_t status = begin(sensor, FATHOM_HPS167S_ADDRESS, address, READ_BACK);
    if (status != FATHOM_OK) return status;
    sensor->setting.address = address;
    return go_on(sensor);
}

/* If the sensor has another rate, makes the setting move it to `baud`. `address` is the one to read at the new rate. A
 * second call while the setting is in progress changes nothing. */
static void move_to_baud(fathom_hps167s_t *sensor, uint32_t baud, uint8_t address)
{
    const fathom_line_settings_t *const is = sensor->unit.line_settings;
    if ((is == NULL) || (is->baud == baud)) return;
    sensor->setting.line_settings = with_baud(sensor, baud);
    sensor->setting.address = address;
}

/* The sensor reads back with this rate. If it responds at another one, it uses the rate from its next power-on. */
static void expect_baud(fathom_hps167s_t *sensor, uint32_t baud)
{
    const fathom_line_settings_t *const is = sensor->unit.line_settings;
    sensor->next_baud = ((is != NULL) && (is->baud != baud)) ? baud : 0u;
    sensor->follow = follow;
}

fathom_status_t fathom_hps167s_set_baud(fathom_hps167s_t *sensor, uint32_t baud)
{
    const uint8_t code = fathom_hps167s_baud_code(baud);
    if ((code == 0u) || (sensor->unit.line_settings == NULL))
        return fathom_modbus_refuse_argument(&sensor->unit);
    fathom_status_t status = begin(sensor, FATHOM_HPS167S_BAUD, code, READ_BACK);
    if (status != FATHOM_OK) return status;
    move_to_baud(sensor, baud, sensor->unit.address);
    status = go_on(sensor);
    if (status == FATHOM_OK) expect_baud(sensor, baud);
    if ((status == FATHOM_ERR_UNCONFIRMED) && (sensor->setting.line_settings != NULL)) {
        seek(sensor, sensor->setting.line_settings);
        sensor->follow = follow;
    }
    return status;
}

fathom_status_t fathom_hps167s_restore_factory_settings(fathom_hps167s_t *sensor)
{
    fathom_modbus_setting_t *const setting = &sensor->setting;
    if (fathom_modbus_is_next_unchecked(&sensor->unit)) return fathom_modbus_refuse_argument(&sensor->unit);
    fathom_status_t status = begin(sensor, FATHOM_HPS167S_RESET, FATHOM_HPS167S_RESET_DONE, READ_BACK);
    if (status != FATHOM_OK) return status;
    if (sensor->unit.setting == 0u) {
        move_to_baud(sensor, FATHOM_HPS167S_FACTORY_BAUD, 1);
        if (sensor->unit.address != 1u) setting->address = 1;
        sensor->reset_response = FATHOM_HPS167S_NO_RESET_RESPONSE;
        sensor->is_looked_at = false;
    }
    setting->write.values = &sensor->reset_response;
    setting->write.function = FATHOM_MODBUS_READ_HOLDING_REGISTERS;
    status = go_on(sensor);
    if (status == FATHOM_OK) {
        expect_baud(sensor, FATHOM_HPS167S_FACTORY_BAUD);
        sensor->warm_up_s = FATHOM_HPS167S_FACTORY_WARM_UP_S;
    }
    return ((status == FATHOM_ERR_UNCONFIRMED) && is_reset_refused(sensor)) ? FATHOM_ERR_EXCEPTION : status;
}
