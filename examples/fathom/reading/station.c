/* SPDX-License-Identifier: MIT */
#include "reading/station.h"

#include <inttypes.h>
#include <string.h>

#include "cli/command.h"
#include "cli/options.h"
#include "ports/tcp_address.h"

static const model_mode_t *asked_mode(const model_t *model)
{
    const model_mode_t *mode = model->modes;
    while (!mode_is_asked(mode)) mode++; /* each sensor has one */
    return mode;
}

bool station_take(station_t *station, const char *command, const sensor_place_t *place, const char *address,
                  const char *mode, bool is_asked)
{
    const sensor_text_t *const sensor = &place->sensor;
    uint32_t number = FACTORY_ADDRESS;
    if ((sensor->address != NULL && address != NULL) || (sensor->mode != NULL && mode != NULL)) {
        (void)usage_error(command, "'%s' and an option say the same; leave one of them out", place->word);
        return false;
    }
    if (sensor->mode != NULL) mode = sensor->mode;
    station->model = sensor->model;
    station->mode = mode == NULL && (is_asked || sensor->address != NULL)
                        ? asked_mode(sensor->model)
                        : model_mode_find(command, sensor->model, mode);
    if (station->mode == NULL ||
        !option_number(command, "address", address, model_least_address(sensor->model, station->mode),
                       sensor->model->max_address, &number))
        return false;
    station->address = (uint8_t)number;
    if (!sensor_text_address(sensor, command, station->mode, &station->address)) return false;
    station->has_own_name = place->name[0] != '\0';
    (void)snprintf(station->name, sizeof station->name, "%s", place->name);
    station_name(station);
    return true;
}

/* ---- its port ---- */

static bool suits_tcp(const station_t *station, const char *path, const char *command)
{
    tcp_address_t address;
    const char *const wrong = tcp_parse(path, &address);
    if (wrong != NULL) {
        (void)usage_error(command, "%s: %s", path, wrong);
        return false;
    }
    if (station->mode->is_modbus) return true;
    (void)usage_error(command,
                      "%s in mode %s needs a serial port; over tcp: a sensor is asked by Modbus: %s:modbus",
                      station->model->name, station->mode->name, station->model->name);
    return false;
}

/* "trigger=17,echo=27", an example of those that it needs. */
static void pins_text(const model_mode_t *mode, char *text, size_t capacity)
{
    static const uint8_t examples[] = {17, 27, 5};
    text[0] = '\0';
    for (unsigned i = 0; KEY_TRIGGER + i <= KEY_IN; i++) {
        const size_t length = strlen(text);
        if ((mode->pins >> i & 1u) == 0) continue;
        (void)snprintf(text + length, capacity - length, "%s%s=%u", length != 0 ? "," : "",
                       port_key_name(KEY_TRIGGER + i), examples[i]);
    }
}

bool station_port_example(const sensor_place_t *place, char text[STATION_PORT])
{
    static const char chip[] = "gpiochip0,";
    const model_mode_t *const modes = place->sensor.model->modes;
    for (size_t i = 0; place->sensor.mode != NULL && i != MODEL_MODES && modes[i].name != NULL; i++) {
        if (modes[i].pins == 0 || strcmp(place->sensor.mode, modes[i].name) != 0) continue;
        memcpy(text, chip, sizeof chip);
        pins_text(&modes[i], text + sizeof chip - 1, STATION_PORT - (sizeof chip - 1));
        return true;
    }
    return false;
}

static bool suits_chip(const station_t *station, const port_options_t *port, const char *command)
{
    const model_mode_t *const mode = station->mode;
    char pins[64];
    pins_text(mode, pins, sizeof pins);
    for (unsigned i = 0; KEY_TRIGGER + i <= KEY_IN; i++) {
        const bool is_given = port_keys_has(&port->keys, KEY_TRIGGER + i);
        const char *const name = port_key_name(KEY_TRIGGER + i);
        if ((mode->pins >> i & 1u) != 0 && !is_given) {
            (void)usage_error(command, "%s in mode %s needs %s= too, such as @%s,%s", station->model->name,
                              mode->name, name, port->path, pins);
            return false;
        }
        if (((mode->pins | mode->may_pins) >> i & 1u) == 0 && is_given) {
            (void)usage_error(command, "%s in mode %s has no %s=, such as @%s,%s", station->model->name,
                              mode->name, name, port->path, pins);
            return false;
        }
    }
    if (!mode->is_contact && port_keys_has(&port->keys, KEY_NEAR)) {
        (void)usage_error(command, "%s in mode %s tells distances and has no near=, such as @%s,%s",
                          station->model->name, mode->name, port->path, pins);
        return false;
    }
    return true;
}

bool station_suits(const station_t *station, const port_options_t *port, const char *command)
{
    const model_mode_t *const mode = station->mode;
    if (tcp_names(port->path)) return suits_tcp(station, port->path, command);
    if (port->is_chip == (mode->pins != 0)) return !port->is_chip || suits_chip(station, port, command);
    if (port->is_chip) {
        (void)usage_error(command, "%s in mode %s needs a serial port, and %s is a GPIO chip",
                          station->model->name, mode->name, port->path);
    } else {
        char pins[64];
        pins_text(mode, pins, sizeof pins);
        (void)usage_error(command, "%s in mode %s needs GPIO lines, such as %s:%s@gpiochip0,%s",
                          station->model->name, mode->name, station->model->name, mode->name, pins);
    }
    return false;
}

/* ---- names ---- */

void station_name(station_t *station)
{
    if (station->has_own_name) return;
    (void)snprintf(station->name, sizeof station->name, station->mode->has_address ? "%s:%u" : "%s",
                   station->model->name, station->address);
}

static bool has_namesake(station_t *const *stations, size_t count, const station_t *station, bool elsewhere)
{
    for (size_t i = 0; i != count; i++) {
        if (elsewhere && stations[i]->port == station->port) continue;
        if (strcmp(stations[i]->name, station->name) == 0) return true;
    }
    return false;
}

/* Behind the name that was made up; what JSON or CSV would have to quote is "_". */
static void add_port(station_t *station, const char *path)
{
    const size_t length = strlen(station->name);
    (void)snprintf(station->name + length, sizeof station->name - length, "@%s", port_last_part(path));
    for (char *at = station->name; *at != '\0'; at++)
        if (*at == '"' || *at == '\\' || *at == ',' || (unsigned char)*at < ' ') *at = '_';
}

bool stations_name(station_t *const *stations, size_t count, const port_options_t *ports, const char *command)
{
    bool is_ambiguous[MAX_STATIONS];
    for (size_t i = 0; i != count; i++)
        is_ambiguous[i] = !stations[i]->has_own_name && has_namesake(stations, count, stations[i], true);
    for (size_t i = 0; i != count; i++)
        if (is_ambiguous[i]) add_port(stations[i], ports[stations[i]->port].path);
    for (size_t i = 0; i != count; i++) {
        usage_of_word(i);
        if (!has_namesake(stations, i, stations[i], false)) continue;
        (void)usage_error(command, "two sensors have the name %s; give each one of its own, such as one=%s",
                          stations[i]->name, stations[i]->model->name);
        return false;
    }
    return true;
}

static bool is_same_line(const station_t *one, const station_t *other)
{
    return one->line.baud == other->line.baud && one->line.parity == other->line.parity;
}

static bool is_same_window(const fathom_dyp_window_t *one, const fathom_dyp_window_t *other)
{
    return one->min_mm == other->min_mm && one->max_mm == other->max_mm &&
           one->value_fffd == other->value_fffd && one->value_fffe == other->value_fffe &&
           one->value_ffff == other->value_ffff && one->value_0 == other->value_0;
}

static bool is_same_reading(const reader_settings_t *one, const reader_settings_t *other)
{
    return one->timeout_us == other->timeout_us && one->period_us == other->period_us &&
           one->repeat_us == other->repeat_us && is_same_window(&one->window, &other->window) &&
           one->temperature_us == other->temperature_us && one->registers == other->registers &&
           one->probes == other->probes && one->value == other->value && one->has_value == other->has_value &&
           one->retries == other->retries;
}

bool station_is_same(const station_t *one, const station_t *other)
{
    return strcmp(one->name, other->name) == 0 && one->model == other->model && one->mode == other->mode &&
           one->address == other->address && one->line.stop_bits == other->line.stop_bits &&
           is_same_line(one, other) && is_same_reading(&one->settings, &other->settings);
}

/* ---- what can be read together ---- */

/* has_settings: each is asked at its own line settings; not so behind a gateway. */
static bool check_two(const station_t *one, const station_t *other, const char *command, bool has_settings)
{
    if (one->address == other->address && (!has_settings || is_same_line(one, other))) {
        (void)usage_error(command, "%s and %s have the same address, so both would answer at once", one->name,
                          other->name);
        return false;
    }
    if (one->model == other->model && (one->mode->can_move_others || other->mode->can_move_others)) {
        (void)usage_error(
            command,
            "a damaged response in mode dyp can change the address of another %s on the line; ask "
            "them all by Modbus, such as %s:modbus",
            one->model->name, one->mode->can_move_others ? one->name : other->name);
        return false;
    }
    return true;
}

static bool suits_line(const station_t *station, const port_options_t *port, const char *command)
{
    if (port->station_count > MAX_STATIONS_ON_A_LINE) {
        (void)usage_error(command, "a line has %d sensors at most; %s has %u", MAX_STATIONS_ON_A_LINE,
                          port->path, (unsigned)port->station_count);
        return false;
    }
    if (port->station_count == 1 || mode_is_asked(station->mode)) return true;
    (void)usage_error(command,
                      "%s in mode %s sends by itself and cannot share a line with others; ask it, such "
                      "as %s:%u:modbus",
                      station->model->name, station->mode->name, station->model->name, station->address);
    return false;
}

bool stations_check(station_t *const *stations, size_t count, const port_options_t *ports,
                    const char *command)
{
    for (size_t i = 0; i != count; i++) {
        const station_t *const one = stations[i];
        const port_options_t *const port = &ports[one->port];
        usage_of_word(i);
        if (!suits_line(one, port, command)) return false;
        for (size_t j = 0; j != i; j++)
            if (stations[j]->port == one->port &&
                !check_two(stations[j], one, command, !tcp_names(port->path)))
                return false;
    }
    return true;
}

bool station_begin(station_t *station, channel_t *channel, const reader_settings_t *settings)
{
    return reader_open(&station->reader, station->mode, channel, settings);
}

void station_refusal(const station_t *station, char *text, size_t capacity)
{
    (void)snprintf(text, capacity, "%s: %s", station->name, reader_refusal(station->reader));
}

bool station_is_raised(station_t *station, char *text, size_t capacity)
{
    const uint32_t interval_us = station->settings.period_us;
    const uint32_t period_us = reader_facts(station->reader).least_period_us;
    if (interval_us == 0 || interval_us >= period_us || station->is_raise_told) return false;
    station->is_raise_told = true;
    (void)snprintf(text, capacity,
                   "asked every %.4g ms, which is the least it can do (--interval %" PRIu32 ")",
                   period_us / 1000.0, interval_us / 1000);
    return true;
}

void station_json(json_t *json, const station_t *station)
{
    json_string(json, "sensor", station->name);
    json_string(json, "model", station->model->name);
    json_string(json, "mode", station->mode->name);
}
