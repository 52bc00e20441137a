/* SPDX-License-Identifier: MIT */
#include "cli/sensor_words.h"

#include <string.h>

#include "output/words.h"

/* ---- ports ---- */

/* Returns the line of a port; a chip has one for each sensor. NULL: no memory left. */
static line_t *line_of(site_t *site, const char *path)
{
    const bool has_pins = port_path_has_pins(path);
    line_t *line = site->lines;
    while (line != NULL && (has_pins || !port_is_same(line->settings.path, path))) line = line->next;
    if (line != NULL) return line;
    line = site_add_line(site, path);
    if (line != NULL) line->settings.has_pins = has_pins;
    return line;
}

/* An example of the port of a sensor without one. False: a serial port. */
static bool chip_example(const sensor_word_t *sensor, char text[PORT_EXAMPLE])
{
    const model_mode_t *const modes = sensor->model->modes;
    for (size_t i = 0; sensor->mode != NULL && i != MODEL_MODES && modes[i].name != NULL; i++)
        if (strcmp(sensor->mode, modes[i].name) == 0) return pins_example(&modes[i], "gpiochip0", text);
    return false;
}

/* path: of all sensors that have none of their own; NULL: not given. */
static bool check_common_port(const sensor_word_t *sensor, const char *path, const origin_t *origin)
{
    char example[PORT_EXAMPLE];
    if (path != NULL && !port_path_has_keys(path)) return true;
    if (path != NULL)
        return reject(origin, "--port takes no keys. Write them behind the sensor: %s@%s.", sensor->word,
                      path);
    if (chip_example(sensor, example))
        return reject(origin, "the GPIO lines are missing. Write them behind the sensor: %s@%s.",
                      sensor->word, example);
    return reject(origin,
                  "--port is missing, such as --port /dev/ttyUSB0. 'fathom help ports' explains ports.");
}

/* Adds the keys of another sensor at this port. */
static bool add_keys(port_keys_t *keys, const sensor_word_t *sensor, const origin_t *origin)
{
    for (size_t key = 0; key != PORT_KEYS; key++) {
        if (!sensor->keys.has[key]) continue;
        if (keys->has[key] && keys->value[key] != sensor->keys.value[key])
            return reject(origin, "%s: another sensor at this port has another %s=. Write it at one of them.",
                          sensor->word, port_key_name((port_key_t)key));
        keys->value[key] = sensor->keys.value[key];
        keys->has[key] = true;
    }
    return true;
}

static bool reject_memory(const origin_t *origin) { return reject(origin, "no memory is left."); }

static bool set_port(site_t *site, sensor_t *sensor, const sensor_word_t *word, const char *path,
                     const origin_t *origin)
{
    if (word->port == NULL && !check_common_port(word, path, origin)) return false;
    line_t *const line = line_of(site, word->port != NULL ? word->port : path);
    if (line == NULL) return reject_memory(origin);
    line_add(line, sensor);
    return add_keys(&line->settings.keys, word, origin);
}

static void set_lines(const site_t *site, const port_keys_t *defaults)
{
    for (size_t i = 0; i != site->sensor_count; i++) {
        sensor_t *const sensor = site->sensors[i];
        port_options_t *const port = sensor->port;
        sensor->line = sensor->model->line;
        port_options_line(port, defaults, &sensor->line);
        if (port->line.baud == 0 || sensor->line.baud < port->line.baud) port->line = sensor->line;
    }
    for (size_t i = 0; i != site->sensor_count; i++) {
        const fathom_line_settings_t *const line = &site->sensors[i]->line;
        port_options_t *const port = site->sensors[i]->port;
        if (line->baud != port->line.baud || line->parity != port->line.parity) port->has_mixed_lines = true;
    }
}

static bool set_ports(const site_t *site, const sensor_defaults_t *defaults, const origin_t *origins)
{
    port_keys_t keys = defaults->keys;
    if (defaults->rs485) {
        keys.has[KEY_RS485] = true;
        keys.value[KEY_RS485] = 1;
    }
    set_lines(site, &keys);
    for (line_t *line = site->lines; line != NULL; line = line->next)
        port_options_take(&line->settings, &keys);
    for (size_t i = 0; i != site->sensor_count; i++) {
        const port_options_t *const port = site->sensors[i]->port;
        if (port->has_pins && !sensors_suit_pins(site, port, &origins[i])) return false;
    }
    return true;
}

/* ---- sensors ---- */

static const model_mode_t *asked_mode(const model_t *model)
{
    const model_mode_t *mode = model->modes;
    while (!mode_is_asked(mode)) mode++; /* each sensor has one */
    return mode;
}

/* Without a MODE a sensor is read in its first one; with an ADDRESS, or if sends_requests, in the first that sends
 * requests. */
static bool set_mode(sensor_t *station, const sensor_word_t *sensor, const char *mode, bool sends_requests,
                     const origin_t *origin)
{
    if (sensor->mode != NULL) mode = sensor->mode;
    if (mode != NULL)
        station->mode = mode_word(sensor->model, mode, origin);
    else if (sends_requests || sensor->address != NULL)
        station->mode = asked_mode(sensor->model);
    else
        station->mode = &sensor->model->modes[0];
    return station->mode != NULL;
}

static bool set_address(sensor_t *station, const sensor_word_t *sensor, const sensor_defaults_t *defaults,
                        const origin_t *origin)
{
    const uint8_t least = model_least_address(sensor->model, station->mode);
    station->address = FACTORY_ADDRESS;
    if (defaults->has_address &&
        (defaults->address < least || defaults->address > sensor->model->max_address))
        return reject(origin, "--address is %u. %s takes a whole number from %u to %u.",
                      (unsigned)defaults->address, sensor->model->name, least, sensor->model->max_address);
    if (defaults->has_address) station->address = (uint8_t)defaults->address;
    return sensor_word_address(sensor, station->mode, &station->address, origin);
}

static bool set_station(sensor_t *station, const sensor_word_t *sensor, const sensor_defaults_t *defaults,
                        bool sends_requests, const origin_t *origin)
{
    if (sensor->address != NULL && defaults->has_address)
        return reject(origin, "'%s' has an address already. Leave --address out.", sensor->word);
    if (sensor->mode != NULL && defaults->mode != NULL)
        return reject(origin, "'%s' has a mode already. Leave --mode out.", sensor->word);
    station->model = sensor->model;
    if (!set_mode(station, sensor, defaults->mode, sends_requests, origin) ||
        !set_address(station, sensor, defaults, origin))
        return false;
    station->has_own_name = sensor->name[0] != '\0';
    (void)snprintf(station->name, sizeof station->name, "%s", sensor->name);
    sensor_set_name(station);
    return true;
}

static bool set_stations(site_t *site, const sensor_defaults_t *defaults, const sensor_word_t *sensors,
                         const origin_t *origins)
{
    const size_t count = site->sensor_count;
    for (size_t i = 0; i != count; i++)
        if (!set_port(site, site->sensors[i], &sensors[i], defaults->path, &origins[i])) return false;
    for (size_t i = 0; i != count; i++) {
        const bool sends_requests = site->asks_all || site->sensors[i]->port->station_count > 1;
        if (!set_station(site->sensors[i], &sensors[i], defaults, sends_requests, &origins[i])) return false;
    }
    return true;
}

static bool check_count(int count, const sensor_defaults_t *defaults, const origin_t *origin)
{
    if (count == 0) return reject(origin, "no sensor is named. Name one of a16, a05 and hps167s.");
    if (count > MAX_SENSORS)
        return reject(origin, "%d sensors are named. At most %d can be.", count, MAX_SENSORS);
    if (count > 1 && (defaults->has_address || defaults->mode != NULL))
        return reject(origin, "with several sensors, write --address and --mode behind each, such as "
                              "a16:1:modbus.");
    return true;
}

/* In the order in which a user corrects it. */
bool sensors_add(site_t *site, const sensor_defaults_t *defaults, const sensor_word_t *sensors, int count,
                 const origin_t *origins)
{
    for (int i = 0; i != count; i++)
        if (site_add_sensor(site) == NULL) return reject_memory(&origins[0]);
    if (!set_stations(site, defaults, sensors, origins) || !set_ports(site, defaults, origins) ||
        !sensors_suit_lines(site, origins) || !sensors_set_names(site, origins))
        return false;
    for (size_t i = 0; i != site->sensor_count; i++)
        if (!sensor_suits_port(site->sensors[i], &origins[i])) return false;
    return true;
}

bool sensor_words(site_t *site, const sensor_defaults_t *defaults, char **words, int count,
                  const origin_t *origins)
{
    static sensor_word_t sensors[MAX_SENSORS];
    if (!check_count(count, defaults, &origins[0])) return false;
    for (int i = 0; i != count; i++)
        if (!sensor_word_parse(&sensors[i], words[i], &origins[i])) return false;
    return sensors_add(site, defaults, sensors, count, origins);
}
