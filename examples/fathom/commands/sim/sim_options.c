/* SPDX-License-Identifier: MIT */
#include <inttypes.h>
#include <string.h>

#include "cli/sensor_words.h"
#include "commands/sim/sim.h"
#include "output/words.h"
#include "sim/pty.h"

static bool parse_another(const char *text, void *member)
{
    sim_texts_t *const texts = member;
    if (texts->count == sizeof texts->text / sizeof texts->text[0]) return false;
    texts->text[texts->count++] = text;
    return true;
}

static const option_t sim_rows[] = {
    {"link", "PATH", "Make a link to the port, and remove it at the end", KIND_TEXT, GROUP_COMMAND,
     .is_path = true, AT(sim_settings_t, link)},
    {"echo", .help = "Return each request, as an adapter with local echo does", .group = GROUP_COMMAND,
     AT(sim_settings_t, has_echo)},
    {"counters", .help = "Print at the end what each sensor did, as JSON", .group = GROUP_COMMAND,
     AT(sim_settings_t, has_counters)},
    {"one-by-one", .help = "Connect each sensor after the one before left its address",
     .group = GROUP_COMMAND, AT(sim_settings_t, one_by_one)},
    {"seed", "N", "Vary movement, response times and faults (default 0)", KIND_NUMBER, GROUP_COMMAND,
     .max = UINT32_MAX, AT(sim_settings_t, seed)},
    {.name = NULL},
};

static const option_t key_rows[] = {
    {"distance", "MM", "Measure MM; an a05 takes up to four, as 700,900", KIND_TEXT, GROUP_SENSOR,
     AT(sim_keys_t, distance)},
    {"baud", "RATE", "Use the rate that an hps167s was set to", KIND_ONE_OF, GROUP_SENSOR,
     .words = "19200 57600 115200 230400", AT(sim_keys_t, baud)},
    {"with", "NAME", "Start with a state or behaviour (fathom help faults)", KIND_CUSTOM, GROUP_SENSOR,
     .takes = "at most 32 traits", .parse = parse_another, .list = sim_trait_name, AT(sim_keys_t, with)},
    {"fault", "KIND", "Damage frames: KIND[=P[@N]] (fathom help faults)", KIND_CUSTOM, GROUP_SENSOR,
     .takes = "at most 32 faults", .parse = parse_another, .list = sim_fault_name, AT(sim_keys_t, faults)},
    {.name = NULL},
};

const option_table_t sim_tables[] = {{sim_rows, 0}, {key_rows, offsetof(sim_settings_t, keys)}, {NULL, 0}};

/* ---- keys ---- */

static bool has_rates(const sim_sensor_t *sensor) { return sensor->model->rates != NULL; }

/* Applies the keys to a sensor. */
static bool apply(sim_sensor_t *sensor, const sim_keys_t *keys, const origin_t *origin)
{
    if (keys->distance != NULL && !sim_set_distance(sensor, keys->distance, origin)) return false;
    if (keys->baud != 0 && !model_has_rate(sensor->model, keys->baud))
        return reject(origin, "%s does not have the rate %" PRIu32 ".", sensor->model->name, keys->baud);
    if (keys->baud != 0) sensor->line.baud = keys->baud;
    for (uint8_t i = 0; i != keys->with.count; i++)
        if (!sim_add_trait(sensor, keys->with.text[i], origin)) return false;
    for (uint8_t i = 0; i != keys->faults.count; i++)
        if (!sim_add_fault(sensor, keys->faults.text[i], origin)) return false;
    return true;
}

static bool can_any_have_trait(const sim_site_t *site, const char *text)
{
    uint32_t i = 0;
    while (i != site->count && !sim_can_have_trait(&site->sensors[i], text)) i++;
    return i != site->count;
}

/* Applies the options to all sensors. A rate and a trait are for the sensors that can have it, if there are any. */
static bool apply_to_all(sim_site_t *site, const sim_keys_t *keys, const origin_t *origin)
{
    bool any_has_rates = false;
    for (uint32_t i = 0; i != site->count; i++) any_has_rates = any_has_rates || has_rates(&site->sensors[i]);
    for (uint32_t i = 0; i != site->count; i++) {
        sim_sensor_t *const sensor = &site->sensors[i];
        sim_keys_t fitting = *keys;
        fitting.with.count = 0;
        for (uint8_t t = 0; t != keys->with.count; t++) {
            const char *const text = keys->with.text[t];
            if (sim_can_have_trait(sensor, text) || !can_any_have_trait(site, text))
                fitting.with.text[fitting.with.count++] = text;
        }
        if (any_has_rates && !has_rates(sensor)) fitting.baud = 0;
        if (!apply(sensor, &fitting, origin)) return false;
    }
    return true;
}

/* Returns the comma before the next KEY=; other commas belong to a list of distances. NULL: there is none. */
static char *next_key(char *text)
{
    char *comma = strchr(text, ',');
    while (comma != NULL && comma[1 + strcspn(comma + 1, ",=")] != '=') comma = strchr(comma + 1, ',');
    return comma;
}

/* Reads KEY=VALUE,KEY=VALUE... and applies the keys to a sensor. */
static bool apply_own(sim_sensor_t *sensor, char *text, const origin_t *origin)
{
    static const option_table_t tables[] = {{key_rows, 0}, {NULL, 0}};
    sim_keys_t keys = {.baud = 0};
    while (text != NULL) {
        option_walk_t walk;
        char *const next = next_key(text);
        if (next != NULL) *next = '\0';
        char *const equals = strchr(text, '=');
        if (equals != NULL) *equals = '\0';
        if (!option_find(&walk, tables, text)) return option_reject_unknown(tables, "key", text, origin);
        if (equals == NULL) return reject(origin, "%s has no value.", text);
        if (!option_set(walk.row, equals + 1, &keys, origin)) return false;
        text = next != NULL ? next + 1 : NULL;
    }
    return apply(sensor, &keys, origin);
}

/* ---- the sensors ---- */

/* Two sensors with neighbouring seeds would do everything at the same time. */
enum { SEED_STEP = 1000003 };

/* Reads SENSOR[:ADDRESS][:MODE]. */
static bool parse_sensor(sim_sensor_t *sensor, char *text, const origin_t *origin)
{
    sensor_word_t word;
    if (!sensor_word_parse(&word, text, origin)) return false;
    sensor->model = word.model;
    sensor->mode = word.mode != NULL ? mode_word(word.model, word.mode, origin) : &word.model->modes[0];
    sensor->address = FACTORY_ADDRESS;
    sensor->line = word.model->line;
    if (sensor->mode == NULL) return false;
    if (sensor->mode->simulated_as != 0)
        return sensor_word_address(&word, sensor->mode, &sensor->address, origin);
    return reject(origin, "%s in mode %s has pins and no line, and is not simulated here.", word.model->name,
                  sensor->mode->name);
}

/* One line cannot carry the frames of two sensors that both send automatically. */
static bool has_one_sender(const sim_site_t *site, const origin_t *origin)
{
    const sim_sensor_t *sender = NULL;
    for (uint32_t i = 0; i != site->count; i++) {
        const sim_sensor_t *const sensor = &site->sensors[i];
        if (mode_is_asked(sensor->mode)) continue;
        if (sender != NULL)
            return reject(origin,
                          "%s and %s would both send automatically, which one line cannot carry. Give one of "
                          "them a mode in which it receives requests.",
                          sender->model->name, sensor->model->name);
        sender = sensor;
    }
    return true;
}

bool sim_sensors(sim_site_t *site, const arguments_t *arguments)
{
    const sim_settings_t *const settings = arguments->settings;
    const origin_t origin = {.command = "sim"};
    const uint32_t now_us = fathom_sim_pty_now_us();
    char *keys_of[SIM_SENSORS];
    if (arguments->count == 0) return reject(&origin, "no sensor is named: a16, a05 or hps167s.");
    if (arguments->count > SIM_SENSORS)
        return reject(&origin, "a line has at most %d sensors, not %d.", SIM_SENSORS, arguments->count);
    for (; site->count != (uint32_t)arguments->count; site->count++) {
        sim_sensor_t *const sensor = &site->sensors[site->count];
        char *const word = arguments->words[site->count];
        char *const comma = strchr(word, ',');
        if (comma != NULL) *comma = '\0';
        keys_of[site->count] = comma != NULL ? comma + 1 : NULL;
        if (!parse_sensor(sensor, word, &origin)) return false;
        sensor->seed = settings->seed + site->count * SEED_STEP;
        sim_move(sensor, now_us);
    }
    if (!has_one_sender(site, &origin) || !apply_to_all(site, &settings->keys, &origin)) return false;
    for (uint32_t i = 0; i != site->count; i++) {
        const origin_t own = {.command = "sim", .within = arguments->words[i]};
        if (!apply_own(&site->sensors[i], keys_of[i], &own)) return false;
    }
    return true;
}
