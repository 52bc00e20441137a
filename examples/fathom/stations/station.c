/* SPDX-License-Identifier: MIT */
#include "stations/station.h"

#include <string.h>

#include "models/sensor_text.h"
#include "shared/command.h"
#include "shared/options.h"

static const model_mode_t *asked_mode(const model_t *model)
{
    const model_mode_t *mode = model->modes;
    while (!mode->is_asked) mode++; /* each sensor has one */
    return mode;
}

bool station_parse(station_t *station, const char *command, const char *text, const char *address,
                   const char *mode, bool is_shared)
{
    sensor_text_t sensor;
    uint32_t number = FACTORY_ADDRESS;
    if (!sensor_text_parse(&sensor, command, text)) return false;
    if ((sensor.address != NULL && address != NULL) || (sensor.mode != NULL && mode != NULL)) {
        (void)usage_error(command, "'%s' and an option say the same; leave one of them out", text);
        return false;
    }
    if (sensor.mode != NULL) mode = sensor.mode;
    station->model = sensor.model;
    station->mode = mode == NULL && (is_shared || sensor.address != NULL)
                        ? asked_mode(sensor.model)
                        : model_mode_find(command, sensor.model, mode);
    if (station->mode == NULL ||
        !option_number(command, "address", address, model_least_address(sensor.model, station->mode),
                       sensor.model->max_address, &number))
        return false;
    station->address = (uint8_t)number;
    if (!sensor_text_address(&sensor, command, station->mode, &station->address)) return false;
    station_name(station);
    return true;
}

void station_name(station_t *station)
{
    (void)snprintf(station->name, sizeof station->name, station->mode->has_address ? "%s:%u" : "%s",
                   station->model->name, station->address);
}

static bool is_same_line(const station_t *one, const station_t *other)
{
    return one->line.baud == other->line.baud && one->line.parity == other->line.parity;
}

static bool is_a05_dyp(const station_t *station) { return strcmp(station->mode->name, "dyp") == 0; }

static bool check_two(const station_t *one, const station_t *other, const char *command, bool has_settings)
{
    if (one->address == other->address && (!has_settings || is_same_line(one, other))) {
        (void)usage_error(command, "%s and %s have the same address, so both would answer at once", one->name,
                          other->name);
        return false;
    }
    /* One flipped bit in a response 55 AA gives its address to every other A05 that hears it. */
    if (one->model == other->model && (is_a05_dyp(one) || is_a05_dyp(other))) {
        (void)usage_error(
            command,
            "a damaged response in mode dyp can change the address of another %s on the line; ask "
            "them all by Modbus, such as %s:modbus",
            one->model->name, is_a05_dyp(one) ? one->name : other->name);
        return false;
    }
    return true;
}

bool stations_check(const station_t *stations, size_t count, const char *command, bool has_settings)
{
    for (size_t i = 0; i != count && count > 1; i++) {
        const station_t *const one = &stations[i];
        if (!one->mode->is_asked) {
            (void)usage_error(
                command,
                "%s in mode %s sends by itself and cannot share a line with others; ask it, such "
                "as %s:%u:modbus",
                one->model->name, one->mode->name, one->model->name, one->address);
            return false;
        }
        for (size_t j = 0; j != i; j++)
            if (!check_two(&stations[j], one, command, has_settings)) return false;
    }
    return true;
}

bool station_begin(station_t *station, channel_t *channel, const reader_settings_t *settings)
{
    return station->mode->read(&station->reader, channel, settings);
}

void station_refusal(const station_t *station, char *text, size_t capacity)
{
    const char *const refusal = station->reader.refusal;
    (void)snprintf(text, capacity, "%s: %s", station->name,
                   refusal != NULL ? refusal : "its driver does not take these settings");
}
