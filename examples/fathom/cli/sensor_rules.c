/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "cli/sensor_words.h"

/* ---- the port of a sensor ---- */

bool pins_example(const model_mode_t *mode, const char *chip, char text[PORT_EXAMPLE])
{
    static const uint8_t examples[] = {17, 27, 5};
    (void)snprintf(text, PORT_EXAMPLE, "%.20s", chip);
    for (unsigned i = 0; KEY_TRIGGER + i <= KEY_IN; i++) {
        const size_t length = strlen(text);
        if ((mode->pins >> i & 1u) != 0)
            (void)snprintf(text + length, PORT_EXAMPLE - length, ",%s=%u", port_key_name(KEY_TRIGGER + i),
                           examples[i]);
    }
    return mode->pins != 0;
}

static bool suits_tcp(const sensor_t *station, const char *path, const origin_t *origin)
{
    const char *const wrong = port_path_error(path);
    if (wrong != NULL) return reject(origin, "%s: %s.", path, wrong);
    if (station->mode->is_modbus) return true;
    return reject(origin, "%s in mode %s needs a serial port. Over TCP, use Modbus: %s:modbus.",
                  station->model->name, station->mode->name, station->model->name);
}

static bool suits_chip(const sensor_t *station, const port_options_t *port, const origin_t *origin)
{
    const model_mode_t *const mode = station->mode;
    const char *const model = station->model->name;
    char example[PORT_EXAMPLE];
    (void)pins_example(mode, port->path, example);
    for (unsigned i = 0; KEY_TRIGGER + i <= KEY_IN; i++) {
        const bool is_given = port->keys.has[KEY_TRIGGER + i];
        const char *const name = port_key_name(KEY_TRIGGER + i);
        if ((mode->pins >> i & 1u) != 0 && !is_given)
            return reject(origin, "%s in mode %s needs %s=, such as @%s.", model, mode->name, name, example);
        if ((mode->pins >> i & 1u) == 0 && is_given)
            return reject(origin, "%s in mode %s has no %s=. Write it such as @%s.", model, mode->name, name,
                          example);
    }
    if (!mode->is_contact && port->keys.has[KEY_NEAR])
        return reject(origin, "%s in mode %s reports distances and has no near=. Write it such as @%s.",
                      model, mode->name, example);
    return true;
}

bool sensor_suits_port(const sensor_t *station, const origin_t *origin)
{
    const port_options_t *const port = station->port;
    const model_mode_t *const mode = station->mode;
    const char *const model = station->model->name;
    char example[PORT_EXAMPLE];
    if (port_path_has_gateway(port->path)) return suits_tcp(station, port->path, origin);
    const bool has_pins = pins_example(mode, "gpiochip0", example);
    if (!port->has_pins && port->keys.has[KEY_TRIGGER] && (mode->may_pins & MODEL_PIN_TRIGGER) == 0)
        return reject(origin, "%s in mode %s has no trigger=. Leave it out.", model, mode->name);
    if (port->has_pins == has_pins) return !has_pins || suits_chip(station, port, origin);
    if (port->has_pins)
        return reject(origin, "%s in mode %s needs a serial port, and %s is a GPIO chip.", model, mode->name,
                      port->path);
    return reject(origin, "%s in mode %s needs GPIO lines, such as %s:%s@%s.", model, mode->name, model,
                  mode->name, example);
}

/* ---- the lines of GPIO chips ---- */

/* "gpiochip0" is "/dev/gpiochip0". */
static bool is_same_chip(const char *one, const char *other)
{
    static const char folder[] = "/dev/";
    if (strncmp(one, folder, sizeof folder - 1) == 0) one += sizeof folder - 1;
    if (strncmp(other, folder, sizeof folder - 1) == 0) other += sizeof folder - 1;
    return strcmp(one, other) == 0;
}

/* The kernel gives a line to one user only. `other` may be the same port. */
static bool suit_pins(const port_options_t *port, const port_options_t *other, const origin_t *origin)
{
    for (int one = KEY_TRIGGER; one <= KEY_IN; one++)
        for (int two = KEY_TRIGGER; two <= KEY_IN; two++) {
            const bool is_one = port == other && one >= two;
            if (is_one || !port->keys.has[one] || !other->keys.has[two] ||
                port->keys.value[one] != other->keys.value[two])
                continue;
            return reject(origin, "line %u of %s is used twice, as %s= and as %s=. Each needs its own line.",
                          (unsigned)port->keys.value[one], port->path, port_key_name((port_key_t)one),
                          port_key_name((port_key_t)two));
        }
    return true;
}

bool sensors_suit_pins(const site_t *site, const port_options_t *port, const origin_t *origin)
{
    for (const line_t *line = site->lines; line != NULL; line = line->next)
        if (line->settings.has_pins && is_same_chip(port->path, line->settings.path) &&
            !suit_pins(port, &line->settings, origin))
            return false;
    return true;
}

/* ---- names ---- */

static bool has_namesake(sensor_t *const *stations, size_t count, const sensor_t *station, bool elsewhere)
{
    for (size_t i = 0; i != count; i++) {
        if (elsewhere && stations[i]->port == station->port) continue;
        if (strcmp(stations[i]->name, station->name) == 0) return true;
    }
    return false;
}

/* Adds the port to a name that the user did not choose. Characters that JSON or CSV would have to quote become "_". */
static void add_port(sensor_t *station, const char *path)
{
    const size_t length = strlen(station->name);
    (void)snprintf(station->name + length, sizeof station->name - length, "@%s", port_last_part(path));
    for (char *at = station->name; *at != '\0'; at++)
        if (*at == '"' || *at == '\\' || *at == ',' || (unsigned char)*at < ' ') *at = '_';
}

bool sensors_set_names(const site_t *site, const origin_t *origins)
{
    sensor_t *const *const stations = site->sensors;
    const size_t count = site->sensor_count;
    bool is_ambiguous[MAX_SENSORS];
    for (size_t i = 0; i != count; i++)
        is_ambiguous[i] = !stations[i]->has_own_name && has_namesake(stations, count, stations[i], true);
    for (size_t i = 0; i != count; i++)
        if (is_ambiguous[i]) add_port(stations[i], stations[i]->port->path);
    for (size_t i = 0; i != count; i++) {
        if (!has_namesake(stations, i, stations[i], false)) continue;
        if (origins[i].file != NULL)
            return reject(&origins[i], "two sensors have the name %s. Change name: of one of them.",
                          stations[i]->name);
        return reject(&origins[i], "two sensors have the name %s. Give each its own name, such as one=%s.",
                      stations[i]->name, stations[i]->model->name);
    }
    return true;
}

/* ---- sensors that share a line ---- */

/* has_settings: each sensor is read at its own line settings; not so behind a gateway. */
static bool suit_each_other(const sensor_t *one, const sensor_t *other, bool has_settings,
                            const origin_t *origin)
{
    const bool is_same_line = one->line.baud == other->line.baud && one->line.parity == other->line.parity;
    if (one->address == other->address && (!has_settings || is_same_line))
        return reject(origin, "%s and %s have the same address, so both would respond at once.", one->name,
                      other->name);
    /* One flipped bit in a response 55 AA gives its address to every other A05 on the line. */
    if (one->model == other->model && (one->mode->can_move_others || other->mode->can_move_others))
        return reject(origin,
                      "a damaged response in mode dyp can change the address of another %s on the line. Use "
                      "Modbus for all of them, such as %s:modbus.",
                      one->model->name, one->mode->can_move_others ? one->name : other->name);
    return true;
}

static bool suits_line(const sensor_t *station, const port_options_t *port, const origin_t *origin)
{
    if (port->station_count > MAX_SENSORS_ON_A_LINE)
        return reject(origin, "%s has %zu sensors. A line has at most %d.", port->path, port->station_count,
                      MAX_SENSORS_ON_A_LINE);
    if (port->station_count == 1 || mode_is_asked(station->mode)) return true;
    return reject(
        origin,
        "%s in mode %s sends automatically and cannot share a line. Use a mode that sends requests, "
        "such as %s:%u:modbus.",
        station->model->name, station->mode->name, station->model->name, station->address);
}

bool sensors_suit_lines(const site_t *site, const origin_t *origins)
{
    for (size_t i = 0; i != site->sensor_count; i++) {
        const sensor_t *const one = site->sensors[i];
        const bool has_settings = !port_path_has_gateway(one->port->path);
        if (!suits_line(one, one->port, &origins[i])) return false;
        for (size_t j = 0; j != i; j++)
            if (site->sensors[j]->port == one->port &&
                !suit_each_other(site->sensors[j], one, has_settings, &origins[i]))
                return false;
    }
    return true;
}
