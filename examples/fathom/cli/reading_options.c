/* SPDX-License-Identifier: MIT */
#include "cli/reading_options.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "cli/command.h"
#include "cli/options.h"

bool reading_options(sensor_t *const *stations, size_t count, const char *command, const char *const *values)
{
    const option_table_t tables[] = {{reading_rows, 0}, {NULL, 0}};
    static const int rows[] = {OPTION_WINDOW, OPTION_MEANS, OPTION_PROBES, OPTION_VALUE};
    const origin_t origin = usage_origin(command, 0);
    option_given_t given = {{0}};
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++)
        given.line[i] = values[rows[i]] != NULL ? usage_line_of(reading_rows[i].name) + 1 : 0;
    if (!options_suit(tables, &given, stations, count, true, &origin)) return false;
    reader_settings_t settings = {0};
    if (!values_store(reading_rows, values, &settings, command)) return false;
    for (size_t n = 0; n != count; n++) {
        stations[n]->settings.window = settings.window;
        stations[n]->settings.probes = settings.probes;
        stations[n]->settings.value = settings.value;
        stations[n]->settings.has_value = settings.has_value;
    }
    return true;
}

bool temperature_option(sensor_t *const *stations, size_t count, const char *command, const char *text)
{
    const option_t *const row = &reading_rows[4];
    const option_table_t tables[] = {{row, 0}, {NULL, 0}};
    const option_given_t given = {{text != NULL}};
    const origin_t origin = usage_origin(command, 0);
    char word[24];
    if (text == NULL) return true;
    if (!options_suit(tables, &given, stations, count, true, &origin)) return false;
    (void)snprintf(word, sizeof word, "%s", text[0] != '\0' ? text : row->otherwise);
    for (size_t i = 0; i != count; i++)
        if (!option_set(row, word, &stations[i]->settings, &origin)) return false;
    return true;
}

void reading_options_help(FILE *to)
{
    (void)fputs(
        "  --value VALUE     of a16 (auto, modbus) and a05 (auto): processed (steady, slow to follow) or "
        "real-time (the\n"
        "                    last measurement). Default: processed in mode modbus, else what the sensor "
        "has.\n"
        "                    Modbus asks for it. Else the level at the sensor's RX selects: the port's TX, "
        "which is held\n"
        "                    low (a break) for real-time, so a serial port that can do that; high again at "
        "the "
        "end. An a16\n"
        "                    of the variant UART automatic follows in 0.5 s to real-time, in 2.5 to 7.5 s "
        "back; "
        "an RS232\n"
        "                    one does not: fathom set a16 automatic-value. An a05 looks at RX when it is "
        "switched on: the\n"
        "                    tool says when to do that, and prints nothing before\n"
        "  --probes LIST     of an a05: those that are fitted or wanted, such as 1,2,4; default: all four. "
        "In "
        "mode dyp a\n"
        "                    single one is measured alone, in 0.1 s instead of 0.25 s\n"
        "  --first-register R  of an a05 (modbus): where probe 1 is read, 0x0106 (default) or 0x0010, where "
        "the "
        "same stands\n"
        "  --window MIN-MAX  the distances in mm that are believed, such as 300-5000; default 1-16350 (a16), "
        "1-6000 (a05),\n"
        "                    80-30000 (hps167s). Others are refused; of an hps167s what is nearer is "
        "unknown\n"
        "  --means LIST      of a16 and a05: what a value is that is no distance, such as "
        "0=no-target,ffff=unknown; 0,\n"
        "                    fffd, fffe or ffff = unknown, no-target, interference, too-near, fault or "
        "refused.\n"
        "                    Default: 0=unknown,fffd=no-target,fffe=interference,ffff=refused\n",
        to);
}
