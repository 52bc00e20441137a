/* SPDX-License-Identifier: MIT */
#include "commands/read/read_options.h"

#include <string.h>

#include "cli/command.h"
#include "cli/options.h"
#include "cli/pins_help.h"
#include "cli/result_options.h"

static const char command[] = "read";

enum {
    MODE = RESULT_OPTIONS,
    ADDRESS,
    COUNT,
    FORMAT,
    STATS,
    TEMPERATURE,
    UNTIL_ALARM,
    QUIET,
    NO_HEADER,
    OUTPUT,
    ROTATE,
    HELP,
    OPTIONS
};

static const struct option table[OPTIONS + 1] = {
    RESULT_OPTION_ROWS,
    [MODE] = {"mode", required_argument, NULL, 256},
    [ADDRESS] = {"address", required_argument, NULL, 256},
    [COUNT] = {"count", required_argument, NULL, 256},
    [FORMAT] = {"format", required_argument, NULL, 256},
    [STATS] = {"stats", optional_argument, NULL, 256},
    [TEMPERATURE] = {"temperature", optional_argument, NULL, 256},
    [UNTIL_ALARM] = {"until-alarm", no_argument, NULL, 256},
    [QUIET] = {"quiet", no_argument, NULL, 256},
    [NO_HEADER] = {"no-header", no_argument, NULL, 256},
    [OUTPUT] = {"output", required_argument, NULL, 256},
    [ROTATE] = {"rotate", required_argument, NULL, 256},
    [HELP] = {"help", no_argument, NULL, 256},
};

enum { MAX_COUNT = 1000000000, MAX_STATS_S = 4000 };

static bool take_stats(read_options_t *options, const char *text)
{
    uint32_t seconds = 0;
    options->stats = text != NULL;
    if (text == NULL || text[0] == '\0') return true;
    if (!option_number(command, "stats", text, 1, MAX_STATS_S, &seconds)) return false;
    options->stats_us = seconds * 1000000u;
    return true;
}

static bool take_file(output_file_t *file, const char *path, const char *rotate)
{
    file->path = path;
    file->is_by_day = rotate != NULL;
    if (path != NULL && (path[0] == '\0' || strlen(path) > OUTPUT_FILE_NAME / 2))
        (void)usage_error(command, "--output takes the name of a file");
    else if (rotate != NULL && strcmp(rotate, "day") != 0)
        (void)usage_error(command, "--rotate takes day, not '%s'", rotate);
    else if (rotate != NULL && path == NULL)
        (void)usage_error(command, "--rotate takes --output too, such as --output log.csv");
    else
        return true;
    return false;
}

static bool take_until_alarm(read_options_t *options, const char *text)
{
    options->until_alarm = text != NULL;
    if (!options->until_alarm || options->results.has_alarm) return true;
    (void)usage_error(command, "--until-alarm takes --alarm too, such as --alarm "
                               "'near<500,unknown=on,no-response=on'");
    return false;
}

static bool take_no_header(read_options_t *options, const char *text)
{
    options->no_header = text != NULL;
    if (!options->no_header || options->format->begin != NULL) return true;
    (void)usage_error(command, "--no-header is for --format csv");
    return false;
}

bool read_options(read_options_t *options, sensor_options_t *sensors, int argc, char **argv)
{
    const char *values[OPTIONS] = {NULL};
    memset(options, 0, sizeof *options);
    const int rest = options_parse(command, argc, argv, table, values);
    if (rest < 0) return false;
    options->wants_help = values[HELP] != NULL;
    if (options->wants_help) return true;
    if (!sensor_options(sensors, command, argv + rest, argc - rest, values, values[ADDRESS], values[MODE]) ||
        !reading_options(sensors->stations, sensors->station_count, command, values) ||
        !temperature_option(sensors->stations, sensors->station_count, command, values[TEMPERATURE]) ||
        !result_options(&options->results, sensors->stations[0]->settings.period_us, command, values) ||
        !take_until_alarm(options, values[UNTIL_ALARM]))
        return false;
    options->format = format_find(command, values[FORMAT]);
    if (options->format == NULL || !take_file(&options->file, values[OUTPUT], values[ROTATE]) ||
        !take_no_header(options, values[NO_HEADER]) || !take_stats(options, values[STATS]) ||
        !option_number(command, "count", values[COUNT], 1, MAX_COUNT, &sensors->count))
        return false;
    options->quiet = values[QUIET] != NULL;
    if (!options->quiet) sensor_options_tell_useless(sensors, values[ADDRESS], values);
    return true;
}

void read_help(FILE *to)
{
    (void)fputs("fathom read reads sensors on serial ports and pins and prints what they say.\n\n"
                "usage: fathom read [NAME=]SENSOR[:ADDRESS][:MODE][@PORT[,KEY=VALUE...]]... [--port PATH] "
                "[OPTIONS]\n\n",
                to);
    models_print(to);
    (void)fputs(
        "\nThe first mode is the default, or with an address or several sensors at a port the first in which "
        "it is "
        "asked: auto\n"
        "listens to a sensor that sends by itself, modbus and dyp (frames 55 AA) ask it, controlled triggers "
        "it by "
        "a break.\n"
        "A single Modbus request ends the automatic output of an A16 or A05; for an A05 until power-off.\n\n"
        "Several sensors that are asked may share a line, also with different settings: each is asked at its "
        "own.\n"
        "One that does not answer three times in a row is then left alone, longer each time up to 16 "
        "time-outs, so that\n"
        "it does not slow the others; the only one on a line is asked again and again.\n\n"
        "  --mode MODE       how the only sensor is read\n"
        "  --address N       of the only sensor; 1 from the factory\n"
        "  --count N         ends after N attempts of each sensor\n"
        "  --format FORMAT   text (default), json (an object a line) or csv (with a header line); in the "
        "last two an attempt\n"
        "                    that fails is a row too, with the reason in status\n"
        "  --no-header       of csv, to add to a file that has one\n"
        "  --output FILE     adds to this file instead of the standard output; csv has a header line where "
        "it is empty\n"
        "  --rotate day      one such file for each day in UTC: --output log.csv is log-2026-11-23.csv\n"
        "  --quiet, -q       nothing on the standard error but what ends it, and what --stats asks for\n"
        "  --stats[=SECONDS] all counters at the end, and every so many seconds; with --format json an "
        "object a\n"
        "                    line. Every request, and every frame that came, is in them: read, failed or "
        "skipped\n",
        to);
    sensor_options_help(to);
    reading_options_help(to);
    (void)fputs(
        "  --temperature[=S] of an hps167s (modbus): its temperature, read every so many seconds (default "
        "10) "
        "between\n"
        "                    measurements, in each reading: temperature_degc, null where it is not known or "
        "older than\n"
        "                    three times that\n",
        to);
    result_options_help(to);
    (void)fputs(
        "  --until-alarm     ends at the first change that is printed after which an alarm is on, with exit "
        "status 3\n",
        to);
    pins_help(to);
    reading_help(to);
    (void)fputs(
        "\nReadings go to the standard output, everything else to the standard error, --stats too. No target "
        "in range\n"
        "and a fault that the sensor reports are readings. An attempt that fails is a line that says what to "
        "try.\n"
        "Exit status: 0 when nothing failed, 1 when an attempt, the port or the output did, or a sensor gave "
        "no "
        "good\n"
        "reading, 2 for wrong usage. 3 when --until-alarm has ended it, whatever failed before, and never "
        "else.\n\n"
        "examples:\n"
        "  fathom read a16 --port /dev/ttyUSB0                          live, until Ctrl-C\n"
        "  fathom read hps167s --port /dev/ttyUSB0 --address 7 --count 1\n"
        "  fathom read a16:1:modbus hps167s:7 --port /dev/ttyUSB0       two on one pair, 9600 8N1 and 19200 "
        "8E1\n"
        "  fathom read tank=a16@/dev/ttyUSB0 hps167s:7@/dev/ttyUSB1,baud=57600      two ports\n"
        "  fathom read a16:pwm@gpiochip0,trigger=17,echo=27 --stats=10               a pulse at pins\n"
        "  fathom read a05 --mode modbus --port /dev/ttyUSB0 --format csv --interval 1000 > log.csv\n"
        "  fathom read a16 --port /dev/ttyUSB0 --format json | jq .distance_mm\n"
        "  fathom read a16 --port /dev/ttyUSB0 --median 5 --gate 300 --level "
        "mounting=2300,height=2000,capacity=5000\n"
        "  fathom read a05:2:modbus --port /dev/ttyUSB0 --until-alarm --alarm "
        "'near<500/600,unknown=on,no-response=on'\n",
        to);
}
