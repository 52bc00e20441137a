/* SPDX-License-Identifier: MIT */
#include "read_options.h"

#include <string.h>

#include "command.h"
#include "options.h"

static const char command[] = "read";

enum {
    PORT,
    MODE,
    ADDRESS,
    BAUD,
    PARITY,
    COUNT,
    INTERVAL,
    TIMEOUT,
    RETRIES,
    FORMAT,
    ECHO_OF,
    RECONNECT,
    STATS,
    HELP,
    OPTIONS
};

/* getopt_long returns 256 for each: the row counts. */
static const struct option table[OPTIONS + 1] = {
    [PORT] = {"port", required_argument, NULL, 256},
    [MODE] = {"mode", required_argument, NULL, 256},
    [ADDRESS] = {"address", required_argument, NULL, 256},
    [BAUD] = {"baud", required_argument, NULL, 256},
    [PARITY] = {"parity", required_argument, NULL, 256},
    [COUNT] = {"count", required_argument, NULL, 256},
    [INTERVAL] = {"interval", required_argument, NULL, 256},
    [TIMEOUT] = {"timeout", required_argument, NULL, 256},
    [RETRIES] = {"retries", required_argument, NULL, 256},
    [FORMAT] = {"format", required_argument, NULL, 256},
    [ECHO_OF] = {"echo", required_argument, NULL, 256},
    [RECONNECT] = {"reconnect", no_argument, NULL, 256},
    [STATS] = {"stats", optional_argument, NULL, 256},
    [HELP] = {"help", no_argument, NULL, 256},
};

static const uint32_t rates[] = {9600, 19200, 38400, 57600, 115200, 230400};
enum { RATES = sizeof rates / sizeof rates[0] };

/* The longest ones keep every sum of times below the 32 bits of the library's clock. */
enum {
    MAX_COUNT = 1000000000,
    MAX_INTERVAL_MS = 3600000,
    MAX_TIMEOUT_MS = 600000,
    MAX_RETRIES = 254,
    MAX_STATS_S = 4000
};

static bool take_baud(const char *text, uint32_t *baud)
{
    uint32_t number = 0;
    if (text == NULL) return true;
    const bool is_number = number_parse(text, 1, UINT32_MAX, &number);
    for (size_t i = 0; i != RATES && is_number; i++) {
        if (number != rates[i]) continue;
        *baud = number;
        return true;
    }
    (void)usage_error(command, "--baud takes 9600, 19200, 38400, 57600, 115200 or 230400, not '%s'", text);
    return false;
}

static bool take_parity(const char *text, uint8_t *parity)
{
    static const char *const names[] = {
        [FATHOM_PARITY_NONE] = "none", [FATHOM_PARITY_EVEN] = "even", [FATHOM_PARITY_ODD] = "odd"};
    if (text == NULL) return true;
    for (uint8_t i = 0; i != sizeof names / sizeof names[0]; i++) {
        if (strcmp(text, names[i]) != 0) continue;
        *parity = i;
        return true;
    }
    (void)usage_error(command, "--parity takes none, even or odd, not '%s'", text);
    return false;
}

/* In the order of fathom_line_config_t.echo: found out, told that there is none, told that there is. */
static bool take_echo(const char *text, uint8_t *echo)
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

static bool take_stats(read_options_t *options, const char *text)
{
    uint32_t seconds = 0;
    options->stats = text != NULL;
    if (text == NULL || text[0] == '\0') return true;
    if (!option_number(command, "stats", text, 1, MAX_STATS_S, &seconds)) return false;
    options->stats_us = seconds * 1000000u;
    return true;
}

static bool take_numbers(read_options_t *options, const char *const *values)
{
    uint32_t address = FACTORY_ADDRESS;
    uint32_t interval_ms = 0;
    uint32_t timeout_ms = 0;
    uint32_t retries = 0;
    if (!option_number(command, "address", values[ADDRESS], 1, options->sensor->max_address, &address) ||
        !option_number(command, "count", values[COUNT], 1, MAX_COUNT, &options->count) ||
        !option_number(command, "interval", values[INTERVAL], 0, MAX_INTERVAL_MS, &interval_ms) ||
        !option_number(command, "timeout", values[TIMEOUT], 1, MAX_TIMEOUT_MS, &timeout_ms) ||
        !option_number(command, "retries", values[RETRIES], 0, MAX_RETRIES, &retries))
        return false;
    options->interval_us = interval_ms * 1000u;
    options->reader.address = (uint8_t)address;
    options->reader.period_us = options->interval_us;
    options->reader.timeout_us = timeout_ms * 1000u;
    options->reader.retries = (uint8_t)retries;
    return true;
}

bool read_options(read_options_t *options, int argc, char **argv)
{
    const char *values[OPTIONS] = {NULL};
    memset(options, 0, sizeof *options);
    const int rest = options_parse(command, argc, argv, table, values);
    if (rest < 0) return false;
    options->wants_help = values[HELP] != NULL;
    if (options->wants_help) return true;
    if (rest != argc - 1) {
        (void)usage_error(command,
                          rest == argc ? "which sensor? a16, a05 or hps167s" : "one sensor at a time");
        return false;
    }
    options->sensor = sensor_find(command, argv[rest]);
    if (options->sensor == NULL) return false;
    options->mode = sensor_mode_find(command, options->sensor, values[MODE]);
    options->format = format_find(command, values[FORMAT]);
    if (options->mode == NULL || options->format == NULL) return false;
    options->line = options->sensor->line;
    if (!take_baud(values[BAUD], &options->line.baud) ||
        !take_parity(values[PARITY], &options->line.parity) || !take_numbers(options, values) ||
        !take_echo(values[ECHO_OF], &options->echo) || !take_stats(options, values[STATS]))
        return false;
    options->reconnect = values[RECONNECT] != NULL;
    const int asking[] = {ADDRESS, RETRIES, ECHO_OF};
    for (size_t i = 0; i != sizeof asking / sizeof asking[0] && !options->mode->is_asked; i++)
        if (values[asking[i]] != NULL)
            (void)fprintf(stderr, "fathom: in mode %s nothing is asked, so --%s has no effect\n",
                          options->mode->name, table[asking[i]].name);
    options->port = values[PORT];
    if (options->port == NULL) (void)usage_error(command, "--port is missing, such as --port /dev/ttyUSB0");
    return options->port != NULL;
}

void read_help(FILE *to)
{
    (void)fputs("fathom read reads a sensor on a serial port and prints what it says.\n\n"
                "usage: fathom read SENSOR --port PATH [OPTIONS]\n\n",
                to);
    sensors_print(to);
    (void)fputs(
        "\nThe first mode is the default: auto listens to a sensor that sends by itself, modbus and dyp "
        "(frames 55 AA)\n"
        "ask it.\n"
        "A single Modbus request ends the automatic output of an A16 or A05; for an A05 until power-off.\n\n"
        "  --port PATH       the serial port: /dev/ttyUSB0, or the link of `fathom sim`\n"
        "  --mode MODE       how the sensor is read\n"
        "  --address N       of a sensor that is asked; 1 from the factory\n"
        "  --baud N          if not the factory's: 9600, 19200, 38400, 57600, 115200 or 230400\n"
        "  --parity P        if not the factory's: none, even or odd\n"
        "  --count N         ends after N attempts; without it Ctrl-C does\n"
        "  --interval MS     from one attempt to the next; default: as fast as the sensor can\n"
        "  --timeout MS      how long to wait for an answer (default: as the sensor needs, 0.5 to 1 s), or "
        "for a\n"
        "                    good frame of a sensor that sends by itself (default 2000)\n"
        "  --retries N       how often a failed request is repeated before it counts; default 0\n"
        "  --format FORMAT   text (default), json (an object a line) or csv (with a header line)\n"
        "  --reconnect       when the adapter is unplugged, or not there yet: waits for it and goes on. A "
        "USB "
        "adapter\n"
        "                    is known again by its serial number, also as another /dev/ttyUSB; one without "
        "by the\n"
        "                    USB socket that it was in. Any other port is known by its path\n"
        "  --echo ECHO       does the adapter return what it sends? auto (default: found out), on or off\n"
        "  --stats[=SECONDS] all counters at the end, and every so many seconds; with --format json an "
        "object a\n"
        "                    line. Every request, and every frame that came, is in them: read, failed or "
        "skipped\n\n"
        "Readings go to the standard output, everything else to the standard error, --stats too. No target "
        "in range\n"
        "and a fault that the sensor reports are readings. An attempt that fails is a line that says what to "
        "try.\n"
        "Exit status: 0 when nothing failed, 1 when an attempt, the port or the output did, 2 for wrong "
        "usage.\n\n"
        "examples:\n"
        "  fathom read a16 --port /dev/ttyUSB0                          live, until Ctrl-C\n"
        "  fathom read hps167s --port /dev/ttyUSB0 --address 7 --count 1\n"
        "  fathom read a05 --mode modbus --port /dev/ttyUSB0 --format csv --interval 1000 > log.csv\n"
        "  fathom read a16 --port /dev/ttyUSB0 --format json | jq .distance_mm\n",
        to);
}
