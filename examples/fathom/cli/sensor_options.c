/* SPDX-License-Identifier: MIT */
#include "cli/sensor_options.h"

#include <string.h>

#include "cli/command.h"
#include "cli/options.h"

/* The longest interval is the longest duration that the library accepts, 35 minutes. */
enum {
    MAX_INTERVAL_MS = FATHOM_MAX_DURATION_US / 1000,
    MAX_TIMEOUT_MS = 600000,
    MAX_RETRIES = 254,
    MAX_DURATION_S = 1000000000
};

bool station_options(station_t *const *stations, size_t count, const char *command, const char *const *values)
{
    uint32_t interval_ms = 0;
    uint32_t timeout_ms = 0;
    uint32_t retries = 0;
    if (!option_number(command, "interval", values[OPTION_INTERVAL], 0, MAX_INTERVAL_MS, &interval_ms) ||
        !option_number(command, "timeout", values[OPTION_TIMEOUT], 1, MAX_TIMEOUT_MS, &timeout_ms) ||
        !option_number(command, "retries", values[OPTION_RETRIES], 0, MAX_RETRIES, &retries))
        return false;
    for (size_t i = 0; i != count; i++) {
        stations[i]->settings.period_us = interval_ms * 1000u;
        stations[i]->settings.timeout_us = timeout_ms * 1000u;
        stations[i]->settings.retries = (uint8_t)retries;
    }
    return true;
}

static bool take_duration(sensor_options_t *options, const char *command, const char *const *values)
{
    uint32_t duration_s = 0;
    if (!option_number(command, "duration", values[OPTION_DURATION], 1, MAX_DURATION_S, &duration_s))
        return false;
    options->duration_us = (uint64_t)duration_s * 1000000u;
    return true;
}

/* ---- the ports ---- */

static const port_options_t *next_chip(const sensor_options_t *options, const port_options_t *port)
{
    const port_options_t *const end = options->ports + options->port_count;
    do port++;
    while (port != end && !port->is_chip);
    return port;
}

/* "gpiochip0" is "/dev/gpiochip0". */
static bool is_same_chip(const char *one, const char *other)
{
    static const char folder[] = "/dev/";
    if (strncmp(one, folder, sizeof folder - 1) == 0) one += sizeof folder - 1;
    if (strncmp(other, folder, sizeof folder - 1) == 0) other += sizeof folder - 1;
    return strcmp(one, other) == 0;
}

/* The kernel gives a line to one user only. port: what has these keys. */
static bool check_pins(const sensor_options_t *options, const char *command, const port_options_t *port)
{
    const port_options_t *const end = options->ports + options->port_count;
    for (const port_options_t *other = port; other != end; other = next_chip(options, other)) {
        if (!is_same_chip(port->path, other->path)) continue;
        for (int one = KEY_TRIGGER; one <= KEY_IN; one++)
            for (int two = KEY_TRIGGER; two <= KEY_IN; two++) {
                const bool is_one = port == other && one >= two;
                if (is_one || !port_keys_has(&port->keys, (port_key_t)one) ||
                    !port_keys_has(&other->keys, (port_key_t)two) ||
                    port->keys.value[one] != other->keys.value[two])
                    continue;
                (void)usage_error(command, "line %u of %s stands for two things, %s and %s",
                                  (unsigned)port->keys.value[one], port->path, port_key_name((port_key_t)one),
                                  port_key_name((port_key_t)two));
                return false;
            }
    }
    return true;
}

/* Its row; a chip has one for each sensor. */
static size_t port_of(sensor_options_t *options, const char *path)
{
    const bool is_chip = port_kind(path, strlen(path)) == PORT_CHIP;
    size_t i = 0;
    while (i != options->port_count && (is_chip || !port_is_same(options->ports[i].path, path))) i++;
    if (i != options->port_count) return i;
    options->port_count++;
    options->ports[i] = (port_options_t){.path = path, .is_chip = is_chip};
    return i;
}

/* path: of all sensors that have none of their own; NULL: not given. */
static bool check_common_port(const char *command, const sensor_place_t *place, const char *path)
{
    char example[STATION_PORT];
    if (path != NULL && !port_path_has_keys(path)) return true;
    if (path != NULL)
        (void)usage_error(command, "--port takes no keys; they stand behind the sensor: %s@%s", place->word,
                          path);
    else if (station_port_example(place, example))
        (void)usage_error(command, "the GPIO lines are missing; they stand behind the sensor: %s@%s",
                          place->word, example);
    else
        (void)usage_error(command,
                          "--port is missing, such as --port /dev/ttyUSB0; or behind the sensor: %s@%s",
                          place->word, "/dev/ttyUSB0");
    return false;
}

static bool take_port(sensor_options_t *options, const char *command, station_t *station,
                      const sensor_place_t *place, const char *path)
{
    if (place->port != NULL)
        path = place->port;
    else if (!check_common_port(command, place, path))
        return false;
    station->port = port_of(options, path);
    port_options_t *const port = &options->ports[station->port];
    port->station_count++;
    return port_keys_add(&port->keys, command, place->word, &place->keys);
}

/* What the options say of all ttys whose own keys do not. */
static bool take_defaults(port_keys_t *keys, const char *command, const char *const *values)
{
    const char *const given[PORT_KEYS] = {[KEY_BAUD] = values[OPTION_BAUD],
                                          [KEY_PARITY] = values[OPTION_PARITY],
                                          [KEY_STOP_BITS] = values[OPTION_STOP_BITS],
                                          [KEY_ECHO] = values[OPTION_ECHO],
                                          [KEY_RS485] = values[OPTION_RS485] != NULL ? "on" : NULL};
    return port_keys_options(keys, command, given);
}

static void take_lines(sensor_options_t *options, const port_keys_t *defaults)
{
    for (size_t i = 0; i != options->station_count; i++) {
        fathom_line_settings_t *const line = &options->stations[i]->line;
        port_options_t *const port = &options->ports[options->stations[i]->port];
        *line = options->stations[i]->model->line;
        port_options_line(port, defaults, line);
        if (port->line.baud == 0 || line->baud < port->line.baud) port->line = *line;
    }
    for (size_t i = 0; i != options->station_count; i++) {
        const fathom_line_settings_t *const line = &options->stations[i]->line;
        port_options_t *const port = &options->ports[options->stations[i]->port];
        if (line->baud != port->line.baud || line->parity != port->line.parity) port->has_mixed_lines = true;
    }
}

static bool take_ports(sensor_options_t *options, const char *command, const char *const *values)
{
    port_keys_t defaults = {.given = 0};
    if (!take_defaults(&defaults, command, values)) return false;
    take_lines(options, &defaults);
    for (size_t i = 0; i != options->port_count; i++) port_options_take(&options->ports[i], &defaults);
    for (size_t i = 0; i != options->station_count; i++) {
        const port_options_t *const port = &options->ports[options->stations[i]->port];
        usage_of_word(i);
        if (port->is_chip && !check_pins(options, command, port)) return false;
    }
    return true;
}

/* ---- the sensors ---- */

static bool take_places(sensor_options_t *options, const char *command, char **words, const char *path,
                        sensor_place_t *places)
{
    for (size_t i = 0; i != options->station_count; i++) {
        usage_of_word(i);
        if (!place_parse(&places[i], command, words[i])) return false;
    }
    for (size_t i = 0; i != options->station_count; i++) {
        usage_of_word(i);
        if (!take_port(options, command, options->stations[i], &places[i], path)) return false;
    }
    return true;
}

static bool take_stations(sensor_options_t *options, const char *command, char **words, const char *path,
                          const char *address, const char *mode)
{
    static sensor_place_t places[MAX_STATIONS]; /* too large for a small stack */
    if (!take_places(options, command, words, path, places)) return false;
    for (size_t i = 0; i != options->station_count; i++) {
        station_t *const station = options->stations[i];
        const port_options_t *const port = &options->ports[station->port];
        usage_of_word(i);
        if (!station_take(station, command, &places[i], address, mode,
                          options->asks_all || port->station_count > 1))
            return false;
    }
    return true;
}

static bool check_count(const char *command, int count, bool has_options)
{
    if (count == 0)
        (void)usage_error(command, "which sensor? a16, a05 or hps167s");
    else if (count > MAX_STATIONS)
        (void)usage_error(command, "up to %d sensors at once, not %d", MAX_STATIONS, count);
    else if (count > 1 && has_options)
        (void)usage_error(command,
                          "with several sensors --address and --mode stand behind each name, such as "
                          "a16:1:modbus");
    else
        return true;
    return false;
}

/* So many stations, all zeros, of which options->beside has none. */
static void take_slots(sensor_options_t *options, size_t count)
{
    static station_t slots[STATION_SLOTS];
    const sensor_options_t *const beside = options->beside;
    bool is_taken[STATION_SLOTS] = {false};
    for (size_t i = 0; beside != NULL && i != beside->station_count; i++)
        is_taken[beside->stations[i]->slot] = true;
    size_t slot = 0;
    for (options->station_count = 0; options->station_count != count; slot++) {
        if (is_taken[slot]) continue;
        reader_free(&slots[slot].reader);
        memset(&slots[slot], 0, sizeof slots[slot]);
        slots[slot].slot = slot;
        options->stations[options->station_count++] = &slots[slot];
    }
}

/* In the order in which a user mends it. */
bool sensor_options(sensor_options_t *options, const char *command, char **words, int word_count,
                    const char *const *values, const char *address, const char *mode)
{
    station_t *const *const stations = options->stations;
    if (!check_count(command, word_count, address != NULL || mode != NULL)) return false;
    take_slots(options, (size_t)word_count);
    options->port_count = 0;
    if (!take_stations(options, command, words, values[OPTION_PORT], address, mode) ||
        !take_ports(options, command, values) ||
        !stations_check(stations, options->station_count, options->ports, command) ||
        !stations_name(stations, options->station_count, options->ports, command) ||
        !station_options(stations, options->station_count, command, values) ||
        !take_duration(options, command, values))
        return false;
    options->reconnect = values[OPTION_RECONNECT] != NULL;
    for (size_t i = 0; i != options->station_count; i++) {
        usage_of_word(i);
        if (!station_suits(stations[i], &options->ports[stations[i]->port], command)) return false;
    }
    return true;
}

static void tell_useless(const sensor_options_t *options, const station_t *station, bool has_effect,
                         const char *name, const char *value)
{
    const bool is_alone = options->station_count == 1;
    if (value != NULL && !has_effect)
        (void)fprintf(stderr, "fathom: %s%sin mode %s nothing is asked, so %s has no effect\n",
                      is_alone ? "" : station->name, is_alone ? "" : ": ", station->mode->name, name);
}

void sensor_options_tell_useless(const sensor_options_t *options, const char *address,
                                 const char *const *values)
{
    for (size_t i = 0; i != options->station_count; i++) {
        const station_t *const station = options->stations[i];
        const model_mode_t *const mode = station->mode;
        const bool has_key = port_keys_has(&options->ports[station->port].keys, KEY_ECHO);
        tell_useless(options, station, mode->has_address, "--address", address);
        tell_useless(options, station, mode_is_asked(mode), "--retries", values[OPTION_RETRIES]);
        tell_useless(options, station, mode_is_asked(mode), has_key ? "echo=" : "--echo",
                     has_key ? "" : values[OPTION_ECHO]);
    }
}

void sensor_options_help(FILE *to)
{
    port_options_help(to);
    (void)fputs(
        "  --duration S      ends after so many seconds; without it Ctrl-C does\n"
        "  --interval MS     from one attempt to the next; default: as fast as the sensor can\n"
        "  --timeout MS      how long to wait for a response (default: as the sensor needs, 0.5 to 1 s), or "
        "for a\n"
        "                    good frame of a sensor that sends by itself (default 10000, of an hps167s "
        "2000)\n"
        "  --retries N       how often a failed request is repeated before it counts; default 0\n"
        "  --reconnect       when the adapter is unplugged, or not there yet: waits for it and goes on. A "
        "USB "
        "adapter\n"
        "                    is known again by its serial number, also as another /dev/ttyUSB; one without "
        "by the\n"
        "                    USB socket that it was in. Any other port is known by its path\n",
        to);
}
