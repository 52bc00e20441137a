/* SPDX-License-Identifier: MIT */
#include "commands/read/read_options.h"

#include <string.h>

static bool parse_path(const char *text, void *member)
{
    *(const char **)member = text;
    return text[0] != '\0' && strlen(text) <= OUTPUT_FILE_NAME / 2;
}

static const option_t read_rows[] = {
    {"count", "N", "Stop after N attempts per sensor", KIND_NUMBER, GROUP_OUTPUT, .min = 1, .max = 1000000000,
     AT(read_options_t, count)},
    {"format", "FORMAT", "Print text, json or csv (default: the ending of FILE, or text)", KIND_CHOICE,
     GROUP_OUTPUT, .words = "text json csv", AT(read_options_t, format)},
    {"output", "FILE", "Append to FILE instead of standard output", KIND_CUSTOM, GROUP_OUTPUT,
     .takes = "the name of a file", .parse = parse_path, .is_path = true, AT(read_options_t, file.path)},
    {"rotate", "day", "Start a new FILE-YYYY-MM-DD every day (UTC)", KIND_CHOICE, GROUP_OUTPUT,
     .words = "day", .min = 1, AT(read_options_t, file.is_by_day), .needs = "output"},
    {"no-header", .help = "Omit the header line of csv", .group = GROUP_OUTPUT,
     AT(read_options_t, no_header)},
    {"stats", "[S]", "Print the counters at the end, or every S seconds", KIND_NUMBER, GROUP_OUTPUT, .min = 1,
     .max = 4000, .scale = 1000000, .otherwise = "", AT(read_options_t, stats_us),
     HAS(read_options_t, stats)},
    {"quiet", .help = "Suppress messages except fatal errors and --stats", .group = GROUP_OUTPUT,
     AT(read_options_t, quiet)},
    {"until-alarm", .help = "Stop with status 3 when an alarm is on", .group = GROUP_PROCESSING,
     AT(read_options_t, until_alarm), .needs = "alarm"},
    {.name = NULL},
};

#define SENSORS(member) offsetof(read_options_t, sensors.member)
const option_table_t read_tables[] = {
    {word_rows, SENSORS(defaults)},
    {interval_rows, SENSORS(reader)},
    {request_rows, SENSORS(reader)},
    {reading_rows, SENSORS(reader)},
    {port_rows, SENSORS(defaults)},
    {reconnect_rows, SENSORS(run)},
    {read_rows, 0},
    {result_rows, offsetof(read_options_t, results)},
    {NULL, 0},
};
