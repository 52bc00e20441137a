/* SPDX-License-Identifier: MIT */
#include "cli/rows.h"

#include <inttypes.h>
#include <stdarg.h>
#include <string.h>
#include <unistd.h>

#include "output/words.h"

#define KEY(key)                                                                                             \
    .at = offsetof(sensor_defaults_t, keys.value[key]), .size = sizeof(uint32_t),                            \
    HAS(sensor_defaults_t, keys.has[key])

const option_t port_rows[] = {
    {"port", "PORT", "Use PORT: serial, [rtu-]tcp:HOST:PORT or a GPIO chip (default: $FATHOM_PORT)",
     KIND_TEXT, GROUP_LINE, AT(sensor_defaults_t, path), .is_once = true, .is_path = true},
    {"baud", "N", "Set the baud rate (default: factory setting)", KIND_ONE_OF, GROUP_LINE,
     .words = PORT_BAUDS, KEY(KEY_BAUD)},
    {"parity", "P", "Set the parity: none, even or odd", KIND_CHOICE, GROUP_LINE, .words = PORT_PARITIES,
     KEY(KEY_PARITY)},
    {"stop-bits", "N", "Set 1 or 2 stop bits; 2 implies no parity", KIND_NUMBER, GROUP_LINE, .min = 1,
     .max = 2, KEY(KEY_STOP_BITS)},
    {"echo", "E", "Expect the adapter's echo: auto, on or off", KIND_CHOICE, GROUP_LINE,
     .words = "auto off on", KEY(KEY_ECHO), .fits = SUITS_REQUESTS},
    {"pieces", .help = "Accept responses in pieces: a network or Bluetooth port", .group = GROUP_LINE,
     KEY(KEY_PIECES)},
    {"rs485", .help = "Let the kernel's driver switch the transceiver", .group = GROUP_LINE, KEY(KEY_RS485)},
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

static const uint8_t meanings[] = {FATHOM_MEANS_UNKNOWN,  FATHOM_MEANS_NO_TARGET, FATHOM_MEANS_INTERFERENCE,
                                   FATHOM_MEANS_TOO_NEAR, FATHOM_MEANS_FAULT,     FATHOM_MEANS_REFUSED};

#define MEANING                                                                                              \
    KIND_CHOICE, .numbers = meanings, .words = "unknown no-target interference too-near fault refused"
static const option_t meaning_keys[] = {
    {"0", "MEANING", "Meaning of the value 0 (unknown)", MEANING, AT(reader_window_t, value_0)},
    {"fffd", "MEANING", "Meaning of FFFD (no-target)", MEANING, AT(reader_window_t, value_fffd)},
    {"fffe", "MEANING", "Meaning of FFFE (interference)", MEANING, AT(reader_window_t, value_fffe)},
    {"ffff", "MEANING", "Meaning of FFFF (refused)", MEANING, AT(reader_window_t, value_ffff)},
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
    {"temperature", "[S]", "Read the temperature too, every S seconds (10)", KIND_NUMBER, GROUP_SENSOR,
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
    if ((fits & READER_TAKES_TEMPERATURE) != 0)
        list_add(list, capacity, "models with a temperature in 'fathom models NAME'");
}

bool options_suit(const option_table_t *tables, const option_given_t *given, sensor_t *const *stations,
                  size_t count, bool is_quiet, const origin_t *origin)
{
    uint16_t all = 0;
    for (size_t i = 0; i != count; i++) all |= suits(stations[i]->mode);
    for (option_walk_t walk = {.table = tables}; option_next(&walk);) {
        const option_t *const row = walk.row;
        const unsigned line = given->line[walk.number];
        const char *const mark = origin_mark(origin);
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
    if (!sensor_words(site, &settings->defaults, arguments->words, count, &arguments->origin)) return false;
    site->duration_us = settings->run.duration_us;
    site->reconnect = settings->run.reconnect;
    for (size_t i = 0; i != site->sensor_count; i++) site->sensors[i]->settings = settings->reader;
    return options_suit(arguments->command->tables, &arguments->given, site->sensors, site->sensor_count,
                        is_quiet, &arguments->origin);
}

/* ---- --level ---- */

static const char shapes[] = "upright horizontal-cylinder table";

static bool parse_shape(const char *text, void *member)
{
    static const fathom_tank_volume_t volumes[] = {fathom_tank_upright, fathom_tank_horizontal_cylinder,
                                                   fathom_tank_table};
    uint32_t n = 0;
    if (!word_find(shapes, text, &n)) return false;
    *(fathom_tank_volume_t *)member = volumes[n];
    return true;
}

/* LEVEL:VOLUME */
static bool parse_point(const char *text, fathom_level_point_t *point)
{
    char word[16];
    uint32_t level_mm = 0;
    const char *const volume = next_word(text, ':', word, sizeof word);
    if (volume == NULL || !number_parse(word, 0, UINT16_MAX, &level_mm) ||
        !number_parse(volume, 0, UINT32_MAX, &point->volume))
        return false;
    point->level_mm = (uint16_t)level_mm;
    return true;
}

static bool parse_points(const char *text, void *member)
{
    results_config_t *const config = member;
    config->tank.points = config->points;
    for (const char *at = text; at != NULL;) {
        char point[32];
        at = next_word(at, '/', point, sizeof point);
        if (config->tank.point_count == RESULTS_POINTS ||
            !parse_point(point, &config->points[config->tank.point_count++]))
            return false;
    }
    return true;
}

#define TANK(member) AT(results_config_t, tank.member)
static const option_t level_keys[] = {
    {"mounting", "MM", "Distance from the tank's bottom to the sensor's face", KIND_NUMBER, .min = 1,
     .max = UINT16_MAX, TANK(mounting_mm), .is_required = true},
    {"height", "MM", "Level at which the tank is full", KIND_NUMBER, .min = 1, .max = UINT16_MAX,
     TANK(height_mm), .is_required = true},
    {"capacity", "VOLUME", "Volume of the full tank, in any unit", KIND_NUMBER, .min = 1, .max = UINT32_MAX,
     TANK(capacity)},
    {"shape", "SHAPE", "upright, horizontal-cylinder or table (upright)", KIND_CUSTOM, .words = shapes,
     .parse = parse_shape, TANK(volume)},
    {"points", "LEVEL:VOLUME/...", "Volumes of shape=table at levels in mm, at most 32", KIND_CUSTOM,
     .takes = "at most 32 of LEVEL:VOLUME, such as 500:400/1500:4000", .parse = parse_points},
    {"offset", "MM", "Distance to add to each reading", KIND_SIGNED, .max = INT16_MAX, TANK(offset_mm)},
    {.name = NULL},
};

/* Rejects the first point at which the table is not as fathom_level_check() wants it. */
static bool check_points(const results_config_t *config, const origin_t *origin)
{
    fathom_level_config_t tank = config->tank;
    for (tank.point_count = tank.point_count > 1 ? 2 : 1; tank.point_count <= config->tank.point_count;
         tank.point_count++) {
        const fathom_level_point_t *const last = &config->points[tank.point_count - 1];
        if (fathom_level_check(&tank) != FATHOM_OK)
            return reject(origin,
                          "points is wrong at %u:%" PRIu32
                          ". Level and volume grow from point to point, and the full tank has a volume.",
                          last->level_mm, last->volume);
    }
    return true;
}

static bool check_level(void *structure, const origin_t *origin)
{
    results_config_t *const config = structure;
    fathom_level_config_t *const tank = &config->tank;
    if (tank->volume == NULL) tank->volume = fathom_tank_upright;
    const bool is_table = tank->volume == fathom_tank_table;
    if (is_table && (tank->points == NULL || tank->capacity != 0))
        return reject(origin, "shape=table takes points= and no capacity=. The last point is the full tank.");
    if (!is_table && tank->points != NULL) return reject(origin, "points= is for shape=table.");
    if (!is_table && tank->capacity == 0) return reject(origin, "capacity is missing.");
    return !is_table || check_points(config, origin);
}

/* ---- --alarm ---- */

/* near<ON[/OFF] or far>ON[/OFF] */
static bool parse_when(const char *text, void *member)
{
    static const char near[] = "near<";
    static const char far[] = "far>";
    fathom_alarm_config_t *const alarm = member;
    const bool is_near = strncmp(text, near, sizeof near - 1) == 0;
    char word[32];
    uint32_t on_mm = 0;
    uint32_t off_mm = 0;
    if (!is_near && strncmp(text, far, sizeof far - 1) != 0) return false;
    const char *const rest =
        next_word(text + (is_near ? sizeof near : sizeof far) - 1, '/', word, sizeof word);
    if (!number_parse(word, 1, UINT16_MAX, &on_mm) ||
        !number_parse(rest != NULL ? rest : word, 1, UINT16_MAX, &off_mm))
        return false;
    alarm->when = is_near ? FATHOM_NEAR : FATHOM_FAR;
    alarm->on_mm = (uint16_t)on_mm;
    alarm->off_mm = (uint16_t)off_mm;
    return true;
}

#define ALARM(member) AT(fathom_alarm_config_t, member)
static const option_t alarm_keys[] = {
    {"when", "near<ON/OFF", "Thresholds in mm: near<ON/OFF or far>ON/OFF", KIND_CUSTOM, .parse = parse_when,
     .takes = "near<ON/OFF or far>ON/OFF, from 1 to 65535 mm, such as near<500/600", .is_required = true,
     .is_first = true},
    {"unknown", "on|off", "State while the distance is unknown", KIND_CHOICE, .words = "on off",
     .min = FATHOM_ALARM_ON, ALARM(if_unknown), .is_required = true},
    {"no-response", "on|off", "State while the sensor does not respond", KIND_CHOICE, .words = "on off",
     .min = FATHOM_ALARM_ON, ALARM(if_no_response), .is_required = true},
    {"hold", "MS/MS", "Time before the alarm switches on, and off", KIND_PAIR, .max = MAX_UNKNOWN_MS,
     .scale = 1000, ALARM(on_hold_us)},
    {"unknown-after", "MS", "Time without a distance until it is unknown", KIND_NUMBER, .min = 1,
     .max = MAX_UNKNOWN_MS, .scale = 1000, ALARM(unknown_us)},
    {"no-target", "far|unknown", "Meaning of a reading without a target (far)", KIND_CHOICE,
     .words = "far unknown", ALARM(no_target_is_unknown)},
    {.name = NULL},
};

static bool check_alarm(void *structure, const origin_t *origin)
{
    const fathom_alarm_config_t *const config = structure;
    fathom_alarm_t alarm;
    if (fathom_alarm_init(&alarm, config) == FATHOM_OK) return true;
    return reject(origin,
                  "the alarm cannot switch off at %u mm after it is on at %u mm. With near, OFF is the "
                  "greater distance; with far, the smaller one.",
                  config->off_mm, config->on_mm);
}

/* ---- the options ---- */

const option_t result_rows[] = {
    {"median", "N", "Print the median of N readings, 3 to 15", KIND_NUMBER, GROUP_PROCESSING,
     .min = FATHOM_MEDIAN_MIN_COUNT, .max = FATHOM_MEDIAN_MAX_COUNT, AT(results_config_t, median)},
    {"gate", "MM", "Drop readings MM or more off the median", KIND_NUMBER, GROUP_PROCESSING, .min = 1,
     .max = UINT16_MAX, AT(results_config_t, gate_mm), .needs = "median"},
    {"level", "KEYS", "Print level and volume of a tank", KIND_KEYS, GROUP_PROCESSING, .keys = level_keys,
     HAS(results_config_t, has_level), .check = check_level},
    {"alarm", "KEYS", "Print only changes of an alarm", KIND_KEYS, GROUP_PROCESSING, .keys = alarm_keys,
     AT(results_config_t, alarm), HAS(results_config_t, has_alarm), .check = check_alarm},
    {.name = NULL},
};

/* A median or an alarm that does not outlast the interval would never know a distance. */
static bool outlasts(const char *what, uint32_t unknown_us, uint32_t interval_us, const origin_t *origin)
{
    const char *const mark = origin_mark(origin);
    if (unknown_us > interval_us) return true;
    return reject(origin,
                  "%sinterval is %" PRIu32 " ms, but %s%s knows nothing after %" PRIu32
                  " ms without a reading. Choose a shorter interval.",
                  mark, interval_us / 1000u, mark, what, unknown_us / 1000u);
}

bool results_finish(results_config_t *results, uint32_t interval_us, const origin_t *origin)
{
    enum { INTERVALS = 3 };
    const uint64_t intervals_us = (uint64_t)INTERVALS * interval_us;
    const uint32_t most_us = MAX_UNKNOWN_MS * 1000u;
    results->unknown_us = intervals_us < most_us ? (uint32_t)intervals_us : most_us;
    if (results->unknown_us < FATHOM_MEDIAN_DEFAULT_UNKNOWN_US)
        results->unknown_us = FATHOM_MEDIAN_DEFAULT_UNKNOWN_US;
    if (results->alarm.unknown_us == 0) results->alarm.unknown_us = results->unknown_us;
    return (results->median == 0 || outlasts("median", results->unknown_us, interval_us, origin)) &&
           (!results->has_alarm || outlasts("alarm", results->alarm.unknown_us, interval_us, origin));
}

const option_t session_format_rows[] = {
    {"format", "FORMAT", "Print text or json (default text)", KIND_CHOICE, GROUP_OUTPUT, .words = "text json",
     AT(session_settings_t, is_json)},
    {.name = NULL},
};

const option_t session_yes_rows[] = {
    {"yes", .help = "Do not ask for confirmation", .group = GROUP_COMMAND,
     AT(session_settings_t, is_confirmed)},
    {.name = NULL},
};

bool session_read(session_t *session, const arguments_t *arguments, int most, int rest)
{
    const session_settings_t *const settings = arguments->settings;
    const int count = arguments->count < most ? arguments->count : most;
    site_free(&session->site);
    memset(session, 0, sizeof *session);
    session->site.asks_all = true;
    session->is_json = settings->is_json;
    if (!sensors_read(&session->site, arguments, &settings->sensors, count, false)) return false;
    for (size_t i = 0; i != session->site.sensor_count; i++) {
        const sensor_t *const station = session->site.sensors[i];
        if (!mode_is_asked(station->mode) || station->mode->pins != 0)
            return reject(&arguments->origin, "%s in mode %s receives no requests. Leave the mode out.",
                          station->model->name, station->mode->name);
    }
    session->sensor = session->site.sensors[0];
    if (arguments->count - count > rest)
        return reject(&arguments->origin, "'%s' is one word too many.", arguments->words[count + rest]);
    return true;
}

bool session_set_mode(session_t *session, const arguments_t *arguments, const model_mode_t *mode)
{
    const session_settings_t *const settings = arguments->settings;
    if (settings->sensors.defaults.mode != NULL && session->sensor->mode != mode)
        return reject(&arguments->origin, "--mode is %s, but this needs mode %s.",
                      session->sensor->mode->name, mode->name);
    session->sensor->mode = mode;
    return true;
}

bool session_can_set(const session_t *session, const arguments_t *arguments)
{
    if (session->sensor->address != 0) return true;
    return reject(&arguments->origin,
                  "a write to address 0 goes to all units, so no setting can be changed there.");
}

const setting_t *setting_named(const session_t *session, const char *name, const arguments_t *arguments)
{
    const setting_t *const settings = session->sensor->model->settings;
    const setting_t *const found = setting_of(settings, name);
    char what[64];
    nearest_t nearest = {.word = name};
    if (found != NULL) return found;
    for (const setting_t *setting = settings; setting->name != NULL; setting++)
        nearest_try(&nearest, setting->name);
    (void)snprintf(what, sizeof what, "setting of %s", session->sensor->model->name);
    (void)reject_unknown(&arguments->origin, what, "", &nearest, true);
    return NULL;
}

bool confirm(const arguments_t *arguments, bool is_confirmed, const char *format, ...)
{
    char text[300];
    char answer[8] = "";
    va_list list;
    if (is_confirmed) return true;
    va_start(list, format);
    (void)vsnprintf(text, sizeof text, format, list);
    va_end(list);
    if (isatty(STDIN_FILENO) != 1 || isatty(STDERR_FILENO) != 1)
        return reject(&arguments->origin, "%s To confirm that, add --yes.", text);
    (void)fprintf(stderr, "%s Continue? [y/N] ", text);
    if (fgets(answer, sizeof answer, stdin) != NULL && (answer[0] == 'y' || answer[0] == 'Y')) return true;
    (void)fputs("fathom: nothing was written.\n", stderr);
    return false;
}
