/* SPDX-License-Identifier: MIT */
#include "stations/sensor_options.h"

#include <string.h>

#include "shared/command.h"
#include "shared/line_text.h"
#include "shared/options.h"
#include "shared/tcp_address.h"

/* The longest ones keep every sum of times below the 32 bits of the library's clock. */
enum { MAX_INTERVAL_MS = 3600000, MAX_TIMEOUT_MS = 600000, MAX_RETRIES = 254, MAX_DURATION_S = 1000000000 };

static bool take_baud(const char *command, const char *text, uint32_t *baud)
{
    if (text == NULL || baud_parse(text, baud)) return true;
    (void)usage_error(command, "--baud takes 9600, 19200, 38400, 57600, 115200 or 230400, not '%s'", text);
    return false;
}

static bool take_parity(const char *command, const char *text, uint8_t *parity)
{
    if (text == NULL || parity_parse(text, parity)) return true;
    (void)usage_error(command, "--parity takes none, even or odd, not '%s'", text);
    return false;
}

/* Two of them take the place of the parity bit: a character has 11 bits either way (HPS-167S 2.2.2). */
static bool take_stop_bits(const char *command, const char *text, fathom_line_settings_t *line)
{
    uint32_t number = line->stop_bits;
    if (!option_number(command, "stop-bits", text, 1, 2, &number)) return false;
    line->stop_bits = (uint8_t)number;
    if (number == 2) line->parity = FATHOM_PARITY_NONE;
    return true;
}

/* In the order of fathom_line_config_t.echo: found out, told that there is none, told that there is. */
static bool take_echo(const char *command, const char *text, uint8_t *echo)
{
    static const char *const names[] = {"auto", "off", "on"};
    if (text == NULL) return true;
    for (uint8_t i = 0; i != sizeof names / sizeof names[0]; i++) {
        if (strcmp(text, names[i]) != 0) continue;
        *echo = i;
        return true;
    }
    (void)usage_error(command, "--echo takes auto, on or off, not '%s'", text);
    return false;
}

static bool take_numbers(sensor_options_t *options, const char *command, const char *const *values)
{
    uint32_t interval_ms = 0;
    uint32_t timeout_ms = 0;
    uint32_t retries = 0;
    uint32_t duration_s = 0;
    if (!option_number(command, "interval", values[OPTION_INTERVAL], 0, MAX_INTERVAL_MS, &interval_ms) ||
        !option_number(command, "timeout", values[OPTION_TIMEOUT], 1, MAX_TIMEOUT_MS, &timeout_ms) ||
        !option_number(command, "retries", values[OPTION_RETRIES], 0, MAX_RETRIES, &retries) ||
        !option_number(command, "duration", values[OPTION_DURATION], 1, MAX_DURATION_S, &duration_s))
        return false;
    options->interval_us = interval_ms * 1000u;
    options->timeout_us = timeout_ms * 1000u;
    options->retries = (uint8_t)retries;
    options->duration_us = (uint64_t)duration_s * 1000000u;
    return true;
}

static bool take_stations(sensor_options_t *options, const char *command, char **words, size_t count,
                          const char *address, const char *mode)
{
    if (count == 0 || count > MAX_STATIONS) {
        (void)usage_error(command,
                          count == 0 ? "which sensor? a16, a05 or hps167s" : "a line has 32 sensors at most");
        return false;
    }
    if (count > 1 && (address != NULL || mode != NULL)) {
        (void)usage_error(command,
                          "with several sensors --address and --mode stand behind each name, such as "
                          "a16:1:modbus");
        return false;
    }
    for (size_t i = 0; i != count; i++)
        if (!station_parse(&options->stations[i], command, words[i], address, mode, count > 1)) return false;
    options->station_count = count;
    return true;
}

static bool take_lines(sensor_options_t *options, const char *command, const char *const *values)
{
    for (size_t i = 0; i != options->station_count; i++) {
        fathom_line_settings_t *const line = &options->stations[i].line;
        *line = options->stations[i].model->line;
        if (!take_baud(command, values[OPTION_BAUD], &line->baud) ||
            !take_stop_bits(command, values[OPTION_STOP_BITS], line) ||
            !take_parity(command, values[OPTION_PARITY], &line->parity))
            return false;
        port_options_t *const port = &options->ports[options->stations[i].port];
        if (port->line.baud == 0 || line->baud < port->line.baud) port->line = *line;
    }
    for (size_t i = 0; i != options->station_count; i++) {
        const fathom_line_settings_t *const line = &options->stations[i].line;
        port_options_t *const port = &options->ports[options->stations[i].port];
        if (line->baud != port->line.baud || line->parity != port->line.parity) port->has_mixed_lines = true;
    }
    return true;
}

bool sensor_options(sensor_options_t *options, const char *command, char **words, int word_count,
                    const char *const *values, const char *address, const char *mode)
{
    const char *const path = values[OPTION_PORT];
    const bool has_settings = path == NULL || !tcp_names(path);
    options->port_count = 1;
    if (!take_stations(options, command, words, (size_t)word_count, address, mode) ||
        !take_lines(options, command, values) ||
        !stations_check(options->stations, options->station_count, command, has_settings) ||
        !take_numbers(options, command, values) ||
        !take_echo(command, values[OPTION_ECHO], &options->ports[0].echo))
        return false;
    options->reconnect = values[OPTION_RECONNECT] != NULL;
    options->ports[0].path = path;
    if (path == NULL) {
        (void)usage_error(command, "--port is missing, such as --port /dev/ttyUSB0");
        return false;
    }
    for (size_t i = 0; i != options->station_count; i++)
        if (!tcp_suits(command, path, options->stations[i].mode->name)) return false;
    return true;
}

static void tell_useless(const sensor_options_t *options, bool has_effect, const char *name,
                         const char *value)
{
    const model_mode_t *const mode = options->stations[0].mode;
    if (value != NULL && !has_effect)
        (void)fprintf(stderr, "fathom: in mode %s nothing is asked, so %s has no effect\n", mode->name, name);
}

void sensor_options_tell_useless(const sensor_options_t *options, const char *address,
                                 const char *const *values)
{
    const model_mode_t *const mode = options->stations[0].mode;
    tell_useless(options, mode->has_address, "--address", address);
    tell_useless(options, mode->is_asked, "--retries", values[OPTION_RETRIES]);
    tell_useless(options, mode->is_asked, "--echo", values[OPTION_ECHO]);
}

void sensor_options_help(FILE *to)
{
    (void)fputs(
        "  --port PATH       the serial port: /dev/ttyUSB0, or the link of `fathom sim`; or a Modbus TCP "
        "server "
        "or\n"
        "                    gateway: tcp:HOST, tcp:HOST:PORT (502 if not given), tcp:[IPV6]:PORT, for mode "
        "modbus;\n"
        "                    --baud, --parity, --stop-bits and --echo mean nothing there\n"
        "  --baud N          if not the factory's: 9600, 19200, 38400, 57600, 115200 or 230400\n"
        "  --parity P        if not the factory's: none, even or odd\n"
        "  --stop-bits N     if not the factory's 1: 2, which means no parity too unless --parity is given\n"
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
        "                    USB socket that it was in. Any other port is known by its path\n"
        "  --echo ECHO       does the adapter return what it sends? auto (default: found out), on or off\n",
        to);
}
