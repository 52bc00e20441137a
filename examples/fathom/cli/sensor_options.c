/* SPDX-License-Identifier: MIT */
#include "cli/sensor_options.h"

#include <string.h>

#include "cli/command.h"
#include "cli/options.h"
#include "cli/result_options.h"

/* The old options on the new rows, until the last command has rows. */

static const char *const names[RESULT_OPTIONS] = {
    [OPTION_PORT] = "port",           [OPTION_BAUD] = "baud",         [OPTION_PARITY] = "parity",
    [OPTION_STOP_BITS] = "stop-bits", [OPTION_INTERVAL] = "interval", [OPTION_TIMEOUT] = "timeout",
    [OPTION_RETRIES] = "retries",     [OPTION_ECHO] = "echo",         [OPTION_RS485] = "rs485",
    [OPTION_RECONNECT] = "reconnect", [OPTION_DURATION] = "duration", [OPTION_PROBES] = "probes",
    [OPTION_MEANS] = "means",         [OPTION_WINDOW] = "window",     [OPTION_VALUE] = "value",
    [OPTION_MEDIAN] = "median",       [OPTION_GATE] = "gate",         [OPTION_LEVEL] = "level",
    [OPTION_ALARM] = "alarm",         [OPTION_FIRST_REGISTER] = "",
};

bool values_store(const option_t *rows, const char *const *values, void *structure, const char *command)
{
    for (; rows->name != NULL; rows++)
        for (size_t i = 0; i != RESULT_OPTIONS; i++) {
            if (strcmp(names[i], rows->name) != 0 || values[i] == NULL) continue;
            origin_t origin = usage_origin(command, 0);
            origin.line = usage_line_of(rows->name);
            if (!option_set(rows, (char *)values[i], structure, &origin)) return false;
        }
    return true;
}

bool station_options(sensor_t *const *stations, size_t count, const char *command, const char *const *values)
{
    for (size_t i = 0; i != count; i++)
        if (!values_store(interval_rows, values, &stations[i]->settings, command) ||
            !values_store(request_rows, values, &stations[i]->settings, command))
            return false;
    return true;
}

bool sensor_options(site_t *site, const char *command, char **words, int word_count,
                    const char *const *values, const char *address, const char *mode)
{
    origin_t origins[MAX_SENSORS + 1];
    sensor_defaults_t defaults = {.mode = mode, .has_address = address != NULL};
    run_settings_t run = {0};
    for (int i = 0; i <= word_count && i <= MAX_SENSORS; i++) origins[i] = usage_origin(command, (size_t)i);
    if (!option_number(command, "address", address, 0, 254, &defaults.address) ||
        !values_store(port_rows, values, &defaults, command) ||
        !values_store(reconnect_rows, values, &run, command) ||
        !sensor_words(site, &defaults, words, word_count, origins) ||
        !station_options(site->sensors, site->sensor_count, command, values))
        return false;
    site->duration_us = run.duration_us;
    site->reconnect = run.reconnect;
    return true;
}

static void tell_useless(const site_t *site, const sensor_t *station, bool has_effect, const char *name,
                         const char *value)
{
    const bool is_alone = site->sensor_count == 1;
    if (value != NULL && !has_effect)
        (void)fprintf(stderr, "fathom: %s%sin mode %s nothing is asked, so %s has no effect\n",
                      is_alone ? "" : station->name, is_alone ? "" : ": ", station->mode->name, name);
}

void sensor_options_tell_useless(const site_t *site, const char *address, const char *const *values)
{
    for (size_t i = 0; i != site->sensor_count; i++) {
        const sensor_t *const station = site->sensors[i];
        const model_mode_t *const mode = station->mode;
        const bool has_key = station->port->keys.has[KEY_ECHO];
        tell_useless(site, station, mode->has_address, "--address", address);
        tell_useless(site, station, mode_is_asked(mode), "--retries", values[OPTION_RETRIES]);
        tell_useless(site, station, mode_is_asked(mode), has_key ? "echo=" : "--echo",
                     has_key ? "" : values[OPTION_ECHO]);
    }
}

void port_options_help(FILE *to)
{
    (void)fputs(
        "  --port PATH       of every sensor without @PORT: a serial port (/dev/ttyUSB0, or the link of "
        "`fathom "
        "sim`); a\n"
        "                    Modbus TCP server or gateway, for mode modbus: tcp:HOST, tcp:HOST:PORT (502 if "
        "not "
        "given),\n"
        "                    tcp:[IPV6]:PORT; or, of read and watch, a GPIO chip for modes on "
        "pins: gpiochip0\n" OPTIONS_PORT_HELP
        "  --baud N          of serial ports, if not the factory's: 9600, 19200, 38400, 57600, 115200 or "
        "230400\n"
        "  --parity P        if not the factory's: none, even or odd\n"
        "  --stop-bits N     if not the factory's 1: 2, which means no parity too unless --parity is given\n"
        "  --echo ECHO       does the adapter return what it sends? auto (default: found out), on or off\n"
        "  --rs485           the kernel's driver drives the transceiver: RTS is on while bytes leave\n"
        "  @PORT,KEY=VALUE   of this port alone, and before the options: of a serial port baud= parity= "
        "stop= echo= and\n"
        "                    rs485=on|off; of a GPIO chip trigger= echo= in= (its lines, from 0),\n"
        "                    bias=as-is|up|down|off and near=high|low; of tcp: none. Sensors with the same "
        "PORT share\n"
        "                    it, and what stands behind one goes for all\n",
        to);
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
