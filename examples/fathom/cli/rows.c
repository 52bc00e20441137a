/* SPDX-License-Identifier: MIT */
#include "cli/rows.h"

#include <string.h>

#include "output/words.h"

#define BAUDS "9600 19200 38400 57600 115200 230400"
#define KEY(key)                                                                                             \
    .at = offsetof(sensor_defaults_t, keys.value[key]), .size = sizeof(uint32_t),                            \
    HAS(sensor_defaults_t, keys.has[key])

const option_t port_rows[] = {
    {"port", "PORT", "Use PORT: a serial port, tcp:HOST[:PORT], or a GPIO chip (default: $FATHOM_PORT)",
     KIND_TEXT, GROUP_LINE, AT(sensor_defaults_t, path), .is_once = true, .is_path = true},
    {"baud", "N", "Set the baud rate (default: factory setting)", KIND_ONE_OF, GROUP_LINE, .words = BAUDS,
     KEY(KEY_BAUD)},
    {"parity", "P", "Set the parity: none, even or odd", KIND_CHOICE, GROUP_LINE, .words = "none even odd",
     KEY(KEY_PARITY)},
    {"stop-bits", "N", "Set 1 or 2 stop bits; 2 implies no parity", KIND_NUMBER, GROUP_LINE, .min = 1,
     .max = 2, KEY(KEY_STOP_BITS)},
    {"echo", "E", "Expect the adapter's echo: auto, on or off", KIND_CHOICE, GROUP_LINE,
     .words = "auto off on", KEY(KEY_ECHO), .fits = SUITS_REQUESTS},
    {"rs485", .help = "Let the kernel's driver switch the transceiver", .group = GROUP_LINE,
     AT(sensor_defaults_t, rs485)},
    {.name = NULL},
};

const option_t word_rows[] = {
    {"address", "N", "Use address N (default 1)", KIND_NUMBER, GROUP_SENSOR, .max = 254,
     AT(sensor_defaults_t, address), HAS(sensor_defaults_t, has_address), .fits = SUITS_ADDRESS},
    {"mode", "MODE", "Use another mode of the sensor", KIND_TEXT, GROUP_SENSOR,
     .words = "auto modbus dyp controlled pwm switch relay", AT(sensor_defaults_t, mode)},
    {.name = NULL},
};

const option_t interval_rows[] = {
    {"interval", "MS", "Read every MS milliseconds (default: as fast as the sensor allows)", KIND_NUMBER,
     GROUP_SENSOR, .max = FATHOM_MAX_DURATION_US / 1000, .scale = 1000, AT(reader_settings_t, period_us)},
    {.name = NULL},
};

const option_t request_rows[] = {
    {"timeout", "MS", "Wait at most MS for a response, or for a frame", KIND_NUMBER, GROUP_SENSOR, .min = 1,
     .max = 600000, .scale = 1000, AT(reader_settings_t, timeout_us)},
    {"retries", "N", "Repeat a failed request N times (default 0)", KIND_NUMBER, GROUP_SENSOR, .max = 254,
     AT(reader_settings_t, retries), .fits = SUITS_REQUESTS},
    {.name = NULL},
};

/* ---- what distances are ---- */

static const char meanings[] = "unknown no-target interference too-near fault refused";

static bool parse_meaning(const char *text, void *member)
{
    static const uint8_t numbers[] = {FATHOM_MEANS_UNKNOWN,      FATHOM_MEANS_NO_TARGET,
                                      FATHOM_MEANS_INTERFERENCE, FATHOM_MEANS_TOO_NEAR,
                                      FATHOM_MEANS_FAULT,        FATHOM_MEANS_REFUSED};
    uint32_t n = 0;
    if (!word_find(meanings, text, &n)) return false;
    *(uint8_t *)member = numbers[n];
    return true;
}

#define MEANING KIND_CUSTOM, .parse = parse_meaning, .words = meanings
static const option_t meaning_keys[] = {
    {"0", "MEANING", "Meaning of the value 0 (unknown)", MEANING, AT(fathom_dyp_window_t, value_0)},
    {"fffd", "MEANING", "Meaning of FFFD (no-target)", MEANING, AT(fathom_dyp_window_t, value_fffd)},
    {"fffe", "MEANING", "Meaning of FFFE (interference)", MEANING, AT(fathom_dyp_window_t, value_fffe)},
    {"ffff", "MEANING", "Meaning of FFFF (refused)", MEANING, AT(fathom_dyp_window_t, value_ffff)},
    {.name = NULL},
};

/* Beyond 65529 the values of all three sensors have other meanings (FFFD, HPS-167S #5). */
const option_t reading_rows[] = {
    {"window", "MIN-MAX", "Reject distances outside MIN to MAX mm", KIND_PAIR, GROUP_SENSOR, .min = 1,
     .max = 65529, .separator = '-', AT(reader_settings_t, window.min_mm), .fits = READER_TAKES_WINDOW},
    {"means", "KEYS", "Give the values 0, fffd, fffe, ffff a meaning", KIND_KEYS, GROUP_SENSOR,
     .keys = meaning_keys, AT(reader_settings_t, window), .fits = READER_TAKES_MEANINGS},
    {"probes", "LIST", "Read these probes of an a05, such as 1,2", KIND_SET, GROUP_SENSOR, .min = 1,
     .max = FATHOM_DYP_PROBES, AT(reader_settings_t, probes), .fits = READER_TAKES_PROBES},
    {"value", "VALUE", "Read processed or real-time distances (a16, a05)", KIND_CHOICE, GROUP_SENSOR,
     .words = "processed real-time", AT(reader_settings_t, value), HAS(reader_settings_t, has_value),
     .fits = READER_TAKES_VALUE},
    {"temperature", "[S]", "Read an hps167s's temperature every S seconds (10)", KIND_NUMBER, GROUP_SENSOR,
     .min = 1, .max = 1000, .scale = 1000000, .otherwise = "10", AT(reader_settings_t, temperature_us),
     .fits = READER_TAKES_TEMPERATURE},
    {.name = NULL},
};

const option_t reconnect_rows[] = {
    {"duration", "S", "Stop after S seconds", KIND_NUMBER, GROUP_OUTPUT, .min = 1, .max = 1000000000,
     .scale = 1000000, AT(run_settings_t, duration_us)},
    {"reconnect", .help = "Reopen a port that was unplugged or is missing", .group = GROUP_LINE,
     AT(run_settings_t, reconnect)},
    {.name = NULL},
};

/* ---- which options have an effect on which sensor ---- */

static uint16_t suits(const model_mode_t *mode)
{
    return (uint16_t)(mode->takes | (mode_is_asked(mode) ? SUITS_REQUESTS : 0) |
                      (mode->has_address ? SUITS_ADDRESS : 0));
}

/* "a16 (auto, modbus), a05 (auto)" */
static void fitting_modes(uint16_t fits, char *list, size_t capacity)
{
    list[0] = '\0';
    for (size_t i = 0; i != model_count; i++) {
        const model_t *const model = &models[i];
        char modes[64] = "";
        char text[96];
        for (size_t m = 0; m != MODEL_MODES && model->modes[m].name != NULL; m++)
            if ((suits(&model->modes[m]) & fits) != 0) list_add(modes, sizeof modes, model->modes[m].name);
        if (modes[0] == '\0') continue;
        (void)snprintf(text, sizeof text, "%s (%s)", model->name, modes);
        list_add(list, capacity, text);
    }
}

bool options_suit(const option_table_t *tables, const option_given_t *given, sensor_t *const *stations,
                  size_t count, bool is_quiet, const origin_t *origin)
{
    uint16_t all = 0;
    for (size_t i = 0; i != count; i++) all |= suits(stations[i]->mode);
    for (option_walk_t walk = {.table = tables}; option_next(&walk);) {
        const option_t *const row = walk.row;
        const unsigned line = given->line[walk.number];
        const char *const mark = origin->file == NULL ? "--" : "";
        const char *const model = stations[0]->model->name;
        const char *const mode = stations[0]->mode->name;
        origin_t its = *origin;
        char modes[200];
        if (row->fits == 0 || line == 0 || (row->fits & all) != 0) continue;
        if (its.file != NULL) its.line = line;
        fitting_modes(row->fits, modes, sizeof modes);
        if ((row->fits & SUITS_NOTICES) == 0)
            return reject(&its, "%s%s has no effect on %s (%s). It is for %s.", mark, row->name, model, mode,
                          modes);
        if (!is_quiet)
            (void)fprintf(stderr, "fathom: %s%s has no effect on %s in mode %s, which sends no requests.\n",
                          mark, row->name, model, mode);
    }
    return true;
}

bool sensors_read(site_t *site, const arguments_t *arguments, const sensor_settings_t *settings, int count,
                  bool is_quiet)
{
    const origin_t origin = {.command = arguments->command->name};
    origin_t origins[MAX_SENSORS];
    for (int i = 0; i != MAX_SENSORS; i++) origins[i] = origin;
    if (!sensor_words(site, &settings->defaults, arguments->words, count, origins)) return false;
    site->duration_us = settings->run.duration_us;
    site->reconnect = settings->run.reconnect;
    for (size_t i = 0; i != site->sensor_count; i++) site->sensors[i]->settings = settings->reader;
    return options_suit(arguments->command->tables, &arguments->given, site->sensors, site->sensor_count,
                        is_quiet, &origin);
}
