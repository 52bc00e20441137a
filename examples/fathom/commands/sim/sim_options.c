/* SPDX-License-Identifier: MIT */
#include <inttypes.h>
#include <string.h>

#include "cli/command.h"
#include "cli/options.h"
#include "cli/sensor_word.h"
#include "commands/sim/sim.h"
#include "sim/pty.h"

static const char command[] = "sim";

enum { LINK, SEED, ECHO_ON, COUNTERS, ONE_BY_ONE, HELP, DISTANCE, BAUD, WITH, FAULT, OPTIONS };

static const struct option table[OPTIONS + 1] = {
    [LINK] = {"link", required_argument, NULL, 256},
    [SEED] = {"seed", required_argument, NULL, 256},
    [ECHO_ON] = {"echo", no_argument, NULL, 256},
    [COUNTERS] = {"counters", no_argument, NULL, 256},
    [ONE_BY_ONE] = {"one-by-one", no_argument, NULL, 256},
    [HELP] = {"help", no_argument, NULL, 256},
    [DISTANCE] = {"distance", required_argument, NULL, 256},
    [BAUD] = {"baud", required_argument, NULL, 256},
    [WITH] = {"with", required_argument, NULL, 256},
    [FAULT] = {"fault", required_argument, NULL, 256},
};

/* ---- the keys that a sensor has ---- */

static bool has_rates(const sim_sensor_t *sensor, const char *text)
{
    (void)text;
    return sensor->model->rates != NULL;
}

static bool set_baud(sim_sensor_t *sensor, const char *text)
{
    uint32_t baud = 0;
    if (!has_rates(sensor, text)) {
        (void)usage_error(command, "%s has one baud rate only", sensor->model->name);
        return false;
    }
    if (number_parse(text, 1, UINT32_MAX, &baud) && model_has_rate(sensor->model, baud)) {
        sensor->line.baud = baud;
        return true;
    }
    char rates[64] = "";
    for (const uint32_t *rate = sensor->model->rates; *rate != 0; rate++) {
        const size_t length = strlen(rates);
        const char *const gap = rate == sensor->model->rates ? "" : rate[1] != 0 ? ", " : " or ";
        (void)snprintf(rates + length, sizeof rates - length, "%s%" PRIu32, gap, *rate);
    }
    (void)usage_error(command, "--baud of %s takes %s, not '%s'", sensor->model->name, rates, text);
    return false;
}

/* As options they apply to all sensors that can have them, behind a sensor to that sensor. */
static const struct {
    int row; /* whose name the key has */
    bool (*fits)(const sim_sensor_t *sensor,
                 const char *text); /* NULL: every sensor must be able to have it */
    bool (*set)(sim_sensor_t *sensor, const char *text);
} keys[] = {{DISTANCE, NULL, sim_set_distance},
            {BAUD, has_rates, set_baud},
            {WITH, sim_can_have_trait, sim_add_trait},
            {FAULT, NULL, sim_add_fault}};
enum { KEYS = sizeof keys / sizeof keys[0] };

/* Applies KEY=VALUE to a sensor. */
static bool set_key(sim_sensor_t *sensor, const char *text)
{
    const size_t length = strcspn(text, "=");
    for (size_t i = 0; i != KEYS; i++) {
        const char *const name = table[keys[i].row].name;
        if (text[length] == '=' && strlen(name) == length && memcmp(name, text, length) == 0)
            return keys[i].set(sensor, text + length + 1);
    }
    (void)usage_error(command, "a sensor takes distance=, baud=, with= and fault=, not '%s'", text);
    return false;
}

/* Returns the comma before the next KEY=; other commas belong to a list of distances. NULL: there is none. */
static char *next_key(char *text)
{
    char *comma = strchr(text, ',');
    while (comma != NULL && comma[1 + strcspn(comma + 1, ",=")] != '=') comma = strchr(comma + 1, ',');
    return comma;
}

static bool set_keys(sim_sensor_t *sensor, char *text)
{
    while (text != NULL) {
        char *const next = next_key(text);
        if (next != NULL) *next = '\0';
        if (!set_key(sensor, text)) return false;
        text = next != NULL ? next + 1 : NULL;
    }
    return true;
}

/* ---- options for all sensors ---- */

enum { MAX_GIVEN = 64 };

typedef struct {
    struct {
        int row;
        const char *text;
    } list[MAX_GIVEN];
    uint32_t count; /* including those that the list has no room for */
} givens_t;

static void note(void *ctx, int row, const char *text)
{
    givens_t *const givens = ctx;
    if (row < DISTANCE) return;
    if (givens->count < MAX_GIVEN) {
        givens->list[givens->count].row = row;
        givens->list[givens->count].text = text;
    }
    givens->count++;
}

static bool set_of_all(sim_options_t *options, int row, const char *text)
{
    const size_t i = (size_t)(row - DISTANCE);
    bool fits_any = false;
    for (uint32_t s = 0; s != options->count && keys[i].fits != NULL; s++)
        fits_any = fits_any || keys[i].fits(&options->sensors[s], text);
    for (uint32_t s = 0; s != options->count; s++) {
        if (fits_any && !keys[i].fits(&options->sensors[s], text)) continue;
        if (!keys[i].set(&options->sensors[s], text)) return false;
    }
    return true;
}

/* ---- the sensors ---- */

/* Two sensors with neighbouring seeds would do everything at the same time. */
enum { SEED_STEP = 1000003 };

/* Reads SENSOR[:ADDRESS][:MODE]. */
static bool parse_sensor(sim_sensor_t *sensor, char *text)
{
    sensor_word_t parsed;
    const origin_t origin = {.command = command};
    if (!sensor_word_parse(&parsed, text, &origin)) return false;
    sensor->model = parsed.model;
    sensor->mode =
        parsed.mode != NULL ? mode_word(parsed.model, parsed.mode, &origin) : &parsed.model->modes[0];
    sensor->address = FACTORY_ADDRESS;
    sensor->line = parsed.model->line;
    if (sensor->mode == NULL) return false;
    if (sensor->mode->simulated_as != 0)
        return sensor_word_address(&parsed, sensor->mode, &sensor->address, &origin);
    (void)usage_error(command, "%s in mode %s has pins and no line, and is not simulated here",
                      parsed.model->name, sensor->mode->name);
    return false;
}

/* One line cannot carry the frames of two sensors that both send automatically. */
static bool has_one_sender(const sim_options_t *options)
{
    const sim_sensor_t *sender = NULL;
    for (uint32_t i = 0; i != options->count; i++) {
        const sim_sensor_t *const sensor = &options->sensors[i];
        if (mode_is_asked(sensor->mode)) continue;
        if (sender != NULL) {
            (void)usage_error(command,
                              "%s and %s would both send by themselves, which one line cannot carry; "
                              "give one of them a mode in which it is asked",
                              sender->model->name, sensor->model->name);
            return false;
        }
        sender = sensor;
    }
    return true;
}

/* Cuts each word behind its sensor; the keys that follow it are in keys_of[], NULL if there are none. */
static bool parse_sensors(sim_options_t *options, int count, char **words, char *keys_of[SIM_SENSORS],
                          uint32_t seed)
{
    if (count == 0) (void)usage_error(command, "which sensor? a16, a05 or hps167s");
    if (count > SIM_SENSORS)
        (void)usage_error(command, "up to %d sensors a line, not %d", SIM_SENSORS, count);
    if (count == 0 || count > SIM_SENSORS) return false;
    const uint32_t now_us = fathom_sim_pty_now_us();
    for (; options->count != (uint32_t)count; options->count++) {
        sim_sensor_t *const sensor = &options->sensors[options->count];
        char *const comma = strchr(words[options->count], ',');
        keys_of[options->count] = comma != NULL ? comma + 1 : NULL;
        if (comma != NULL) *comma = '\0';
        if (!parse_sensor(sensor, words[options->count])) return false;
        sensor->seed = seed + options->count * SEED_STEP;
        sim_move(sensor, now_us);
    }
    return has_one_sender(options);
}

bool sim_options(sim_options_t *options, int argc, char **argv)
{
    const char *values[OPTIONS] = {NULL};
    char *keys_of[SIM_SENSORS];
    givens_t givens = {.count = 0};
    uint32_t seed = 0;
    memset(options, 0, sizeof *options);
    const int rest = options_parse_each(command, argc, argv, table, values, note, &givens);
    if (rest < 0) return false;
    options->wants_help = values[HELP] != NULL;
    if (options->wants_help) return true;
    options->link = values[LINK];
    options->echo = values[ECHO_ON] != NULL;
    options->counters = values[COUNTERS] != NULL;
    options->one_by_one = values[ONE_BY_ONE] != NULL;
    if (givens.count > MAX_GIVEN) {
        (void)usage_error(command, "there are more than %d options", MAX_GIVEN);
        return false;
    }
    if (!option_number(command, "seed", values[SEED], 0, UINT32_MAX, &seed) ||
        !parse_sensors(options, argc - rest, argv + rest, keys_of, seed))
        return false;
    for (uint32_t i = 0; i != givens.count; i++)
        if (!set_of_all(options, givens.list[i].row, givens.list[i].text)) return false;
    for (uint32_t i = 0; i != options->count; i++)
        if (!set_keys(&options->sensors[i], keys_of[i])) return false;
    return true;
}
