/* SPDX-License-Identifier: MIT */
#include "stations/station.h"

#include <string.h>

#include "shared/command.h"
#include "shared/options.h"

enum { MAX_TEXT = 40 };

static const model_mode_t *asked_mode(const model_t *model)
{
    const model_mode_t *mode = model->modes;
    while (!mode->is_asked) mode++; /* each sensor has one */
    return mode;
}

/* part: what follows the sensor's name; option: of --address; NULL: there is none. */
static bool take_address(station_t *station, const char *command, const char *part, const char *option)
{
    uint32_t number = FACTORY_ADDRESS;
    const uint8_t least = model_least_address(station->model, station->mode);
    const uint8_t max = station->model->max_address;
    if (!option_number(command, "address", option, least, max, &number)) return false;
    if (part != NULL && part[0] != '\0' && !number_parse(part, least, max, &number)) {
        (void)usage_error(command, "the address of %s is a number from %u to %u, not '%s'",
                          station->model->name, least, max, part);
        return false;
    }
    station->address = (uint8_t)number;
    return true;
}

bool station_parse(station_t *station, const char *command, const char *text, const char *address,
                   const char *mode, bool is_shared)
{
    char parts[MAX_TEXT];
    if (strlen(text) >= sizeof parts) return model_find(command, text) != NULL;
    memcpy(parts, text, strlen(text) + 1);
    char *const address_part = strchr(parts, ':');
    char *const mode_part = address_part != NULL ? strchr(address_part + 1, ':') : NULL;
    if (address_part != NULL) *address_part = '\0';
    if (mode_part != NULL) *mode_part = '\0';
    station->model = model_find(command, parts);
    if (station->model == NULL) return false;
    if ((address_part != NULL && address != NULL) || (mode_part != NULL && mode != NULL)) {
        (void)usage_error(command, "'%s' and an option say the same; leave one of them out", text);
        return false;
    }
    if (mode_part != NULL) mode = mode_part + 1;
    station->mode = mode == NULL && (is_shared || address_part != NULL)
                        ? asked_mode(station->model)
                        : model_mode_find(command, station->model, mode);
    if (station->mode == NULL ||
        !take_address(station, command, address_part != NULL ? address_part + 1 : NULL, address))
        return false;
    (void)snprintf(station->name, sizeof station->name, station->mode->is_asked ? "%s:%u" : "%s",
                   station->model->name, station->address);
    return true;
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
    /* One flipped bit in an answer 55 AA gives its address to every other A05 that hears it. */
    if (one->model == other->model && (is_a05_dyp(one) || is_a05_dyp(other))) {
        (void)usage_error(
            command,
            "a damaged answer in mode dyp can change the address of another %s on the line; ask "
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
