/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): SIGUSR1 */
#include <errno.h>
#include <inttypes.h>
#include <poll.h>
#include <signal.h>
#include <string.h>

#include "cli/command.h"
#include "cli/rows.h"
#include "commands/commands.h"
#include "output/record.h"
#include "output/words.h"
#include "ports/host.h"
#include "ports/port.h"
#include "sensors/models.h"
#include "sim/fault.h"
#include "sim/pty.h"
#include "sim/scene.h"

enum { MAX_SIMULATED = 64, PROBES = 4, MAX_MM = 65535, WORD_TEXT = 32 };

/* A sensor of the line. Do not move it. */
typedef struct {
    const model_t *model;
    const model_mode_t *mode;
    fathom_line_settings_t line;
    device_settings_t settings; /* whose scene is one of the next two */
    fathom_sim_fixed_t fixed;
    fathom_sim_moving_t moving[PROBES];
    fathom_sim_fault_t fault;
    device_t device;
} simulated_t;

/* Texts of an option that can be given several times. */
typedef struct {
    uint8_t count;
    const char *text[FATHOM_SIM_FAULT_RULES];
} texts_t;

/* Options that apply to all sensors that can have them, or keys behind a sensor. */
typedef struct {
    const char *distance; /* NULL: the target moves */
    uint32_t baud;        /* 0: of the factory */
    texts_t with;
    texts_t faults;
} keys_t;

typedef struct {
    const char *link; /* NULL: none */
    bool has_echo;
    bool has_counters;
    bool one_by_one; /* connects each sensor when the sensor before it has left its first address */
    uint32_t seed;
    keys_t keys; /* of all sensors */
} settings_t;

typedef struct {
    const settings_t *settings;
    fathom_sim_line_t line;
    fathom_sim_pty_t pty;
    uint32_t count;
    uint32_t connected; /* the first sensors */
    uint32_t left_us;   /* time at which the last connected sensor left its first address */
    bool has_left;      /* `left_us` is valid */
    simulated_t sensors[MAX_SIMULATED];
} simulation_t;

/* ---- traits ---- */

typedef struct {
    const char *name;
    const char *text;
    const char *unit; /* of the value; NULL: the trait has no value */
    uint32_t max;     /* of the value, from 1 */
    uint32_t places;  /* decimal places of the value; it is stored without its point */
} trait_t;

static const trait_t traits[DEVICE_TRAITS] = {
    [DEVICE_EXCEPTIONS] = {"exceptions", "refuse by an exception instead of silence", NULL, 0, 0},
    [DEVICE_ANSWERS_BROADCAST] = {"broadcast", "respond to requests to address FF", NULL, 0, 0},
    [DEVICE_REAL_TIME] = {"real-time", "send real-time values automatically", NULL, 0, 0},
    [DEVICE_ANSWERS_FROM_NEW] = {"new-address", "confirm a new address from that address", NULL, 0, 0},
    [DEVICE_WARM_UP] = {"warm-up", "do not measure for S seconds after power-on", "S", 255, 0},
    [DEVICE_WARM_UP_REFUSES] = {"warm-up-04", "refuse by exception 04 meanwhile", NULL, 0, 0},
    [DEVICE_WARM_UP_ABNORMAL] = {"warm-up-ff", "send the abnormal packet meanwhile", NULL, 0, 0},
    [DEVICE_UNASKED] = {"unasked", "send an unsolicited measurement every MS ms", "MS", 60000, 3},
    [DEVICE_NO_OUTPUT] = {"output-off", "start with the output off, as #10 sets it", NULL, 0, 0},
    [DEVICE_NO_TERMINATION] = {"termination-off", "start without termination, as #11 sets it", NULL, 0, 0},
    [DEVICE_BAUD_LATER] = {"baud-later", "apply #9 from the next power-on", NULL, 0, 0},
    [DEVICE_OFFSET_ADDS] = {"offset-adds", "add the offset of #12 to the previous one", NULL, 0, 0},
    [DEVICE_RECONNECT] = {"reconnect", "report this reconnect time in #2", "MS", 1000000, 0},
    [DEVICE_NO_BAUD_CODE] = {"baud-code-00", "report 00 as the rate in #2", NULL, 0, 0},
    [DEVICE_COUNT_EXCEPTION] = {"count-03", "refuse a wrong length by 03, not by 02", NULL, 0, 0},
};

static const char *trait_name(size_t n) { return n < DEVICE_TRAITS ? traits[n].name : NULL; }

/* Returns the number of the trait that stands before '='; DEVICE_TRAITS: there is none. */
static size_t find_trait(const char *text)
{
    char name[WORD_TEXT];
    size_t n = 0;
    (void)next_word(text, '=', name, sizeof name);
    while (n != DEVICE_TRAITS && strcmp(traits[n].name, name) != 0) n++;
    return n;
}

static bool has_trait(const model_t *model, size_t n)
{
    return n < DEVICE_TRAITS && (model->traits >> n & 1) != 0;
}

/* ---- faults: fault n has the kind n + 1 ---- */

/* A port has no clock that could jump. */
static const char *fault_name(size_t n)
{
    return n + 1 < FATHOM_SIM_FAULT_CLOCK_JUMP ? fathom_sim_fault_name((uint8_t)(n + 1)) : NULL;
}

static bool has_fault(const model_t *model, const model_mode_t *mode, size_t n)
{
    const device_settings_t settings = {.address = FACTORY_ADDRESS,
                                        .facts = mode->row != NULL ? mode->row->facts : NULL};
    device_t device;
    if (fault_name(n) == NULL) return false;
    model->simulate(&device, &settings, mode->simulated_as);
    return fathom_sim_fault_applies((uint8_t)(n + 1), &device.base);
}

/* ---- the values of keys ---- */

/* Rejects NAME[=VALUE], since no trait or fault of the sensor has this name. */
static bool reject_name(const simulated_t *sensor, bool is_fault, const char *text, const origin_t *origin)
{
    const char *(*const name_of)(size_t n) = is_fault ? fault_name : trait_name;
    char name[WORD_TEXT];
    char what[80];
    nearest_t nearest = {.word = name};
    (void)next_word(text, '=', name, sizeof name);
    for (size_t n = 0; name_of(n) != NULL; n++) {
        if (is_fault ? !has_fault(sensor->model, sensor->mode, n) : !has_trait(sensor->model, n)) continue;
        nearest_try(&nearest, name_of(n));
    }
    (void)snprintf(what, sizeof what, "%s of %s%s%s", is_fault ? "fault" : "trait", sensor->model->name,
                   is_fault ? " in mode " : "", is_fault ? sensor->mode->name : "");
    return reject_unknown(origin, what, "", &nearest, true);
}

/* Reads a decimal such as 18.5 with up to `places` digits behind its point as a whole number: 18500 with 3 places. */
static bool parse_decimal(const char *text, uint32_t places, uint32_t min, uint32_t max, uint32_t *number)
{
    static const char figures[] = "0123456789";
    char digits[WORD_TEXT];
    const size_t whole = strspn(text, figures);
    const size_t part = text[whole] == '.' ? strspn(text + whole + 1, figures) : 0;
    const char *const end = text + whole + (part != 0 ? part + 1 : 0);
    if (whole == 0 || *end != '\0' || part > places) return false;
    (void)snprintf(digits, sizeof digits, "%.*s%.*s%.*s", (int)whole, text, (int)part, end - part,
                   (int)(places - part), "000000");
    return number_parse(digits, min, max, number);
}

/* Reads NAME or NAME=VALUE of a trait that the sensor can have. */
static bool add_trait(simulated_t *sensor, const char *text, const origin_t *origin)
{
    const size_t n = find_trait(text);
    const char *const value = strchr(text, '=');
    const trait_t *const trait = &traits[n];
    uint32_t one = 1;
    for (uint32_t i = 0; i != trait->places; i++) one *= 10;
    sensor->settings.traits[n] = 1;
    if (trait->unit == NULL)
        return value == NULL || reject(origin, "with is '%s'. %s takes no value.", text, trait->name);
    if (value != NULL &&
        parse_decimal(value + 1, trait->places, one, trait->max * one, &sensor->settings.traits[n]))
        return true;
    return reject(origin, "with is '%s'. It takes %s=%s, a %snumber from 1 to %" PRIu32 ".", text,
                  trait->name, trait->unit, trait->places != 0 ? "" : "whole ", trait->max);
}

/* Reads P[@N]; P is 0.05 or 5%. */
static bool parse_chance(const char *text, uint32_t *chance_ppm, uint32_t *at_frame)
{
    char chance[WORD_TEXT];
    const char *const frame = next_word(text, '@', chance, sizeof chance);
    char *const percent = strchr(chance, '%');
    const bool is_percent = percent != NULL && percent[1] == '\0';
    if (is_percent) *percent = '\0';
    return parse_decimal(chance, is_percent ? 4 : 6, 1, FATHOM_SIM_FAULT_ALWAYS_PPM, chance_ppm) &&
           (frame == NULL || number_parse(frame, 1, UINT32_MAX, at_frame));
}

/* Reads KIND[=P[@N]]. */
static bool add_fault(simulated_t *sensor, const char *text, const origin_t *origin)
{
    char name[WORD_TEXT];
    const char *const chance = next_word(text, '=', name, sizeof name);
    const uint8_t kind = fathom_sim_fault_find(name);
    uint32_t chance_ppm = FATHOM_SIM_FAULT_ALWAYS_PPM;
    uint32_t at_frame = 0;
    if (kind == 0 || !has_fault(sensor->model, sensor->mode, kind - 1u))
        return reject_name(sensor, true, text, origin);
    if (chance != NULL && !parse_chance(chance, &chance_ppm, &at_frame))
        return reject(
            origin, "fault is '%s'. It takes KIND[=P[@N]], P from 0.000001 to 1 or as 5%%, N from 1.", text);
    return fathom_sim_fault_add(&sensor->fault, kind, chance_ppm, at_frame) != NULL ||
           reject(origin, "a sensor has at most %u faults.", FATHOM_SIM_FAULT_RULES);
}

/* What a sensor may report instead of a distance, if in its first mode it can have the fault of this name. */
static const struct {
    uint8_t fault;
    int32_t value;
} conditions[] = {{FATHOM_SIM_FAULT_NO_TARGET, FATHOM_SIM_NO_TARGET},
                  {FATHOM_SIM_FAULT_INTERFERENCE, FATHOM_SIM_INTERFERENCE},
                  {FATHOM_SIM_FAULT_FAULT, FATHOM_SIM_FAULT}};
enum { CONDITIONS = sizeof conditions / sizeof conditions[0] };

static bool parse_distance(const simulated_t *sensor, const char *word, int32_t *value,
                           const origin_t *origin)
{
    char words[64] = "";
    uint32_t mm = 0;
    for (size_t i = 0; i != CONDITIONS; i++) {
        const char *const name = fathom_sim_fault_name(conditions[i].fault);
        if (!has_fault(sensor->model, sensor->model->modes, conditions[i].fault - 1u)) continue;
        *value = conditions[i].value;
        if (strcmp(word, name) == 0) return true;
        list_add(words, sizeof words, name);
    }
    if (!number_parse(word, 0, MAX_MM, &mm))
        return reject(origin, "distance of %s is '%s'. It takes 0 to %d mm, %s.", sensor->model->name, word,
                      MAX_MM, words);
    *value = (int32_t)mm;
    return true;
}

/* Reads a distance for each probe; the last one is also that of the other probes. */
static bool set_distance(simulated_t *sensor, const char *list, const origin_t *origin)
{
    uint8_t count = 0;
    int32_t value = 0;
    for (const char *rest = list; rest != NULL;) {
        char word[WORD_TEXT];
        rest = next_word(rest, ',', word, sizeof word);
        if (count == sensor->model->probes)
            return reject(origin, "distance '%s' is more than the %u of %s.", list, sensor->model->probes,
                          sensor->model->name);
        if (!parse_distance(sensor, word, &value, origin)) return false;
        sensor->fixed.value[count++] = value;
    }
    for (; count != PROBES; count++) sensor->fixed.value[count] = value;
    sensor->settings.scene = fathom_sim_fixed(&sensor->fixed);
    return true;
}

static int32_t moving_distance(void *ctx, uint8_t probe, uint32_t now_us)
{
    simulated_t *const sensor = ctx;
    if (probe < 1 || probe > PROBES) return FATHOM_SIM_NO_TARGET;
    const fathom_sim_scene_t one = fathom_sim_moving(&sensor->moving[probe - 1]);
    return one.distance(one.ctx, probe, now_us);
}

/* Makes the target of each probe move to and fro, each at another speed. */
static void set_moving(simulated_t *sensor, uint32_t now_us)
{
    for (uint8_t i = 0; i != PROBES; i++) {
        fathom_sim_moving_t *const moving = &sensor->moving[i];
        moving->from_mm = sensor->model->near_mm;
        moving->to_mm = sensor->model->far_mm;
        moving->period_us = 8000000u + i * 3000000u;
        moving->start_us = now_us - sensor->settings.seed % moving->period_us;
    }
    sensor->settings.scene = (fathom_sim_scene_t){.distance = moving_distance, .ctx = sensor};
}

/* ---- options and keys ---- */

static bool parse_another(const char *text, void *member)
{
    texts_t *const texts = member;
    if (texts->count == sizeof texts->text / sizeof texts->text[0]) return false;
    texts->text[texts->count++] = text;
    return true;
}

static const option_t option_rows[] = {
    {"link", "PATH", "Make a link to the port, and remove it at the end", KIND_TEXT, GROUP_COMMAND,
     .is_path = true, AT(settings_t, link)},
    {"echo", .help = "Return each request, as an adapter with local echo does", .group = GROUP_COMMAND,
     AT(settings_t, has_echo)},
    {"counters", .help = "Print at the end what each sensor did, as JSON", .group = GROUP_COMMAND,
     AT(settings_t, has_counters)},
    {"one-by-one", .help = "Connect each sensor after the one before left its address",
     .group = GROUP_COMMAND, AT(settings_t, one_by_one)},
    {"seed", "N", "Vary movement, response times and faults (default 0)", KIND_NUMBER, GROUP_COMMAND,
     .max = UINT32_MAX, AT(settings_t, seed)},
    {.name = NULL},
};

static const option_t key_rows[] = {
    {"distance", "MM", "Measure MM; an a05 takes up to four, as 700,900", KIND_TEXT, GROUP_SENSOR,
     AT(keys_t, distance)},
    {"baud", "RATE", "Use the rate that an hps167s was set to", KIND_ONE_OF, GROUP_SENSOR,
     .words = "19200 57600 115200 230400", AT(keys_t, baud)},
    {"with", "NAME", "Start with a state or behaviour (fathom help faults)", KIND_CUSTOM, GROUP_SENSOR,
     .takes = "at most 32 traits", .parse = parse_another, .list = trait_name, AT(keys_t, with)},
    {"fault", "KIND", "Damage frames: KIND[=P[@N]] (fathom help faults)", KIND_CUSTOM, GROUP_SENSOR,
     .takes = "at most 32 faults", .parse = parse_another, .list = fault_name, AT(keys_t, faults)},
    {.name = NULL},
};

static const option_table_t tables[] = {{option_rows, 0}, {key_rows, offsetof(settings_t, keys)}, {NULL, 0}};

/* Adds a trait to the sensors that can have it. */
static bool add_trait_to(simulated_t *sensors, uint32_t count, const char *text, const origin_t *origin)
{
    bool is_used = false;
    for (uint32_t i = 0; i != count; i++) {
        if (!has_trait(sensors[i].model, find_trait(text))) continue;
        if (!add_trait(&sensors[i], text, origin)) return false;
        is_used = true;
    }
    return is_used || reject_name(&sensors[0], false, text, origin);
}

/* Applies keys to sensors. A rate and a trait are for those that can have it; if none can, they are rejected. */
static bool apply(simulated_t *sensors, uint32_t count, const keys_t *keys, const origin_t *origin)
{
    bool has_rate = false;
    for (uint32_t i = 0; i != count; i++) {
        simulated_t *const sensor = &sensors[i];
        if (keys->distance != NULL && !set_distance(sensor, keys->distance, origin)) return false;
        if (model_has_rate(sensor->model, keys->baud)) sensor->line.baud = keys->baud;
        has_rate = has_rate || sensor->line.baud == keys->baud;
        for (uint8_t f = 0; f != keys->faults.count; f++)
            if (!add_fault(sensor, keys->faults.text[f], origin)) return false;
    }
    if (keys->baud != 0 && !has_rate)
        return reject(origin, "%s does not have the rate %" PRIu32 ".", sensors[0].model->name, keys->baud);
    for (uint8_t t = 0; t != keys->with.count; t++)
        if (!add_trait_to(sensors, count, keys->with.text[t], origin)) return false;
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
static bool apply_own(simulated_t *sensor, char *text, const origin_t *origin)
{
    static const option_table_t key_tables[] = {{key_rows, 0}, {NULL, 0}};
    keys_t keys = {.baud = 0};
    while (text != NULL) {
        option_walk_t walk;
        char *const next = next_key(text);
        if (next != NULL) *next = '\0';
        char *const equals = strchr(text, '=');
        if (equals != NULL) *equals = '\0';
        if (!option_find(&walk, key_tables, text))
            return option_reject_unknown(key_tables, "key", text, origin);
        if (equals == NULL) return reject(origin, "%s has no value.", text);
        if (!option_set(walk.row, equals + 1, &keys, origin)) return false;
        text = next != NULL ? next + 1 : NULL;
    }
    return apply(sensor, 1, &keys, origin);
}

/* ---- the sensors ---- */

/* Reads SENSOR[:ADDRESS][:MODE]. */
static bool parse_sensor(simulated_t *sensor, char *text, const origin_t *origin)
{
    sensor_word_t word;
    if (!sensor_word_parse(&word, text, origin)) return false;
    sensor->model = word.model;
    sensor->mode = word.mode != NULL ? mode_word(word.model, word.mode, origin) : &word.model->modes[0];
    sensor->settings.address = FACTORY_ADDRESS;
    sensor->line = word.model->line;
    if (sensor->mode == NULL) return false;
    if (sensor->mode->simulated_as != 0)
        return sensor_word_address(&word, sensor->mode, &sensor->settings.address);
    char example[PORT_EXAMPLE];
    (void)pins_example(sensor->mode, "gpiochip0", example);
    return reject(
        origin,
        "%s in mode %s has GPIO pins and no line to simulate. Connect a module and run 'fathom read "
        "%s:%s@%s', or simulate a sensor with a line, such as 'fathom sim a16'.",
        word.model->name, sensor->mode->name, word.model->name, sensor->mode->name, example);
}

/* Reads the words of the sensors with their keys. */
static bool parse_sensors(simulation_t *simulation, const arguments_t *arguments)
{
    /* Two sensors with neighbouring seeds would do everything at the same time. */
    enum { SEED_STEP = 1000003 };
    const settings_t *const settings = arguments->settings;
    const origin_t *const origin = &arguments->origin;
    const uint32_t now_us = fathom_sim_pty_now_us();
    const simulated_t *sender = NULL;
    char *keys[MAX_SIMULATED];
    if (arguments->count == 0)
        return reject(origin, "no sensor is named: a16, a05, hps167s, or a name of 'fathom models'.");
    if (arguments->count > MAX_SIMULATED)
        return reject(origin, "a line has at most %d sensors, not %d.", MAX_SIMULATED, arguments->count);
    for (uint32_t i = 0; i != (uint32_t)arguments->count; i++, simulation->count++) {
        simulated_t *const sensor = &simulation->sensors[i];
        keys[i] = strchr(arguments->words[i], ',');
        if (keys[i] != NULL) *keys[i]++ = '\0';
        if (!parse_sensor(sensor, arguments->words[i], origin)) return false;
        sensor->settings.seed = settings->seed + i * SEED_STEP;
        fathom_sim_fault_init(&sensor->fault, sensor->settings.seed);
        set_moving(sensor, now_us);
        for (uint32_t j = 0; j != i; j++)
            if (simulation->sensors[j].model == sensor->model) sensor->settings.number++;
        if (mode_is_asked(sensor->mode)) continue;
        if (sender != NULL)
            return reject(origin,
                          "%s and %s would both send automatically, which one line cannot carry. Give one of "
                          "them a mode in which it receives requests.",
                          sender->model->name, sensor->model->name);
        sender = sensor;
    }
    if (!apply(simulation->sensors, simulation->count, &settings->keys, origin)) return false;
    for (uint32_t i = 0; i != simulation->count; i++) {
        const origin_t own = {.command = "sim", .within = arguments->words[i]};
        if (!apply_own(&simulation->sensors[i], keys[i], &own)) return false;
    }
    return true;
}

static void connect_sensor(simulation_t *simulation, uint32_t now_us)
{
    simulated_t *const sensor = &simulation->sensors[simulation->connected++];
    sensor->settings.baud = sensor->line.baud;
    if (sensor->mode->row != NULL) sensor->settings.facts = sensor->mode->row->facts;
    sensor->model->simulate(&sensor->device, &sensor->settings, sensor->mode->simulated_as);
    fathom_sim_fault_attach(&sensor->fault, &simulation->line, &sensor->device.base);
    fathom_sim_attach(&simulation->line, &sensor->device.base, now_us);
}

/* ---- what the command prints ---- */

/* Prints a sensor and how to read it. */
static void print_sensor(const simulated_t *sensor, const char *between, const char *port)
{
    char line[LINE_TEXT];
    (void)fprintf(stderr, "%s, mode %s, address %u, %s%s", sensor->model->name, sensor->mode->name,
                  sensor->settings.address, line_text(&sensor->line, line), between);
    read_command_print(stderr, sensor->model, sensor->mode->name,
                       sensor->mode->has_address ? sensor->settings.address : -1, &sensor->line, port);
    (void)fputs("\n", stderr);
}

/* Sensors that disturb each other are mostly intended, but the user should know. */
static void print_clashes(const simulation_t *simulation)
{
    for (uint32_t i = 0; i != simulation->count; i++) {
        const simulated_t *const one = &simulation->sensors[i];
        if (!mode_is_asked(one->mode))
            (void)fprintf(stderr,
                          "fathom: sensor %" PRIu32 " sends automatically, into the frames of the others.\n",
                          i + 1);
        for (uint32_t j = i + 1; j != simulation->count; j++) {
            const simulated_t *const other = &simulation->sensors[j];
            if (other->settings.address == one->settings.address && other->line.baud == one->line.baud)
                (void)fprintf(stderr,
                              "fathom: sensors %" PRIu32 " and %" PRIu32
                              " both have address %u, and their responses collide.\n",
                              i + 1, j + 1, one->settings.address);
        }
    }
}

/* Prints only the path on stdout, for scripts, and what a person may want to know on stderr. */
static bool announce(const simulation_t *simulation)
{
    const char *const path = fathom_sim_pty_path(&simulation->pty);
    const char *const port = simulation->settings->link != NULL ? simulation->settings->link : path;
    if (printf("%s\n", path) < 0 || fflush(stdout) != 0) {
        (void)fprintf(stderr, "fathom: cannot write the path of the port: %s\n", strerror(errno));
        return false;
    }
    if (simulation->count == 1) {
        (void)fputs("fathom: simulates ", stderr);
        print_sensor(&simulation->sensors[0], ", until Ctrl-C; to read it: ", port);
        return true;
    }
    if (simulation->settings->one_by_one)
        (void)fputs("fathom: each further sensor is connected a second after the sensor before it left its "
                    "address.\n",
                    stderr);
    else
        print_clashes(simulation);
    (void)fprintf(stderr, "fathom: simulates %" PRIu32 " sensors on one line, until Ctrl-C; to read each:\n",
                  simulation->count);
    for (uint32_t i = 0; i != simulation->count; i++) {
        (void)fprintf(stderr, "  %2" PRIu32 "  ", i + 1);
        print_sensor(&simulation->sensors[i], ": ", port);
    }
    return true;
}

/* Prints a JSON object of sensor i: its place on the command line, its present address and rate, its counters, and the
 * collisions on the line. */
static void print_counters(const simulation_t *simulation, uint32_t i)
{
    const simulated_t *const sensor = &simulation->sensors[i];
    const fathom_sim_device_t *const device = &sensor->device.base;
    const fathom_sim_counters_t *const counters = &device->counters;
    const struct {
        const char *name;
        uint32_t value;
    } fields[] = {{"address", device->address},
                  {"baud", device->settings.baud},
                  {"requests", counters->requests},
                  {"answered", counters->answered},
                  {"exceptions", counters->exceptions},
                  {"unserved", counters->unserved},
                  {"others", counters->others},
                  {"crc_errors", counters->crc_errors},
                  {"truncated", counters->truncated},
                  {"unheard", counters->unheard},
                  {"wrong_settings", counters->wrong_settings},
                  {"automatic", counters->automatic},
                  {"writes", counters->writes},
                  {"writes_refused", counters->writes_refused},
                  {"flash_writes", counters->flash_writes},
                  {"resets", counters->resets},
                  {"resets_refused", counters->resets_refused},
                  {"measurements", counters->measurements},
                  {"line_collisions", simulation->line.counters.collisions}};
    json_t json = {.to = stderr};
    json_begin(&json, NULL, '{');
    json_value(&json, "device", "%" PRIu32, i + 1);
    json_string(&json, "model", sensor->model->name);
    json_string(&json, "mode", sensor->mode->name);
    for (size_t f = 0; f != sizeof fields / sizeof fields[0]; f++)
        json_value(&json, fields[f].name, "%" PRIu32, fields[f].value);
    json_end(&json, '}');
    (void)fputc('\n', stderr);
}

void sim_print_traits(FILE *to)
{
    for (size_t i = 0; i != DEVICE_TRAITS; i++) {
        char name[WORD_TEXT];
        const char *gap = "(";
        (void)snprintf(name, sizeof name, "%s%s%s", traits[i].name, traits[i].unit != NULL ? "=" : "",
                       traits[i].unit != NULL ? traits[i].unit : "");
        (void)fprintf(to, "  %-15s  %-43s ", name, traits[i].text);
        for (size_t m = 0; m != model_count; m++) {
            if (!has_trait(&models[m], i)) continue;
            (void)fprintf(to, "%s%s", gap, models[m].name);
            gap = " ";
        }
        (void)fputs(")\n", to);
    }
}

void sim_print_faults(FILE *to)
{
    for (size_t n = 0; fault_name(n) != NULL; n++)
        (void)fprintf(to, "  %-13s  %s\n", fault_name(n), fathom_sim_fault_text((uint8_t)(n + 1)));
}

/* ---- the command ---- */

static bool open_line(simulation_t *simulation)
{
    const simulated_t *const first = &simulation->sensors[0];
    const char *const link = simulation->settings->link;
    const fathom_sim_pty_config_t config = {.link = link};
    const uint32_t now_us = fathom_sim_pty_now_us();
    fathom_sim_line_init(&simulation->line, &first->line, now_us);
    /* A sensor without an address has a wire in each direction; the others share an RS485 pair. */
    simulation->line.full_duplex = simulation->count == 1 && !first->mode->has_address;
    simulation->line.echo = simulation->settings->has_echo;
    do connect_sensor(simulation, now_us);
    while (simulation->connected != simulation->count && !simulation->settings->one_by_one);
    if (fathom_sim_pty_open(&simulation->pty, &simulation->line, &config) == 0) return true;
    if (link != NULL && errno == EEXIST)
        (void)fprintf(stderr,
                      "fathom: %s exists, and is not the link of a killed fathom sim. "
                      "Choose another --link, or remove it.\n",
                      link);
    else
        (void)fprintf(stderr, "fathom: cannot make the simulated port%s%s: %s\n",
                      link != NULL ? " and its link " : "", link != NULL ? link : "", strerror(errno));
    return false;
}

/* Connects the next sensor a second after the last one has left its address, as a person would. Returns the time until
 * this function must be called again, at most `due_us`. */
static uint32_t connect_next(simulation_t *simulation, uint32_t due_us)
{
    enum { CONNECT_US = 1000000 };
    const simulated_t *const last = &simulation->sensors[simulation->connected - 1];
    if (simulation->connected == simulation->count || last->device.base.address == last->settings.address)
        return due_us;
    const uint32_t now_us = fathom_sim_pty_now_us();
    if (!simulation->has_left) simulation->left_us = now_us;
    simulation->has_left = true;
    const uint32_t passed_us = fathom_elapsed_us(now_us, simulation->left_us);
    if (passed_us < CONNECT_US) return due_us < CONNECT_US - passed_us ? due_us : CONNECT_US - passed_us;
    simulation->has_left = false;
    connect_sensor(simulation, now_us);
    (void)fprintf(stderr, "fathom: sensor %" PRIu32 " is connected.\n", simulation->connected);
    return 0;
}

static int serve(simulation_t *simulation, const host_t *host)
{
    enum { POWER_OFF_US = 1000000 };
    uint32_t due_us = 0;
    while (!host->has_ended(host->ctx)) {
        if (host_had_signal()) {
            for (uint32_t i = 0; i != simulation->connected; i++)
                fathom_sim_power_cycle(&simulation->line, &simulation->sensors[i].device.base, POWER_OFF_US,
                                       fathom_sim_pty_now_us());
            (void)fprintf(stderr, "fathom: power off for a second.\n");
        }
        if (fathom_sim_pty_pump(&simulation->pty, &due_us) < 0) {
            (void)fprintf(stderr, "fathom: the simulated port failed: %s\n", strerror(errno));
            return STATUS_FAILED;
        }
        due_us = connect_next(simulation, due_us);
        host->wait(host->ctx, fathom_sim_pty_fd(&simulation->pty), POLLIN, due_us, false);
    }
    return STATUS_OK;
}

static int start(const host_t *host, const arguments_t *arguments)
{
    static simulation_t simulation;
    memset(&simulation, 0, sizeof simulation);
    simulation.settings = arguments->settings;
    if (!parse_sensors(&simulation, arguments)) return STATUS_USAGE;
    if (!host->begin(host->ctx) || !open_line(&simulation)) return STATUS_FAILED;
    host_watch_signal(SIGUSR1); /* before the path is printed, by which the process can be known */
    const int status = announce(&simulation) ? serve(&simulation, host) : STATUS_FAILED;
    for (uint32_t i = 0; i != simulation.connected && simulation.settings->has_counters; i++)
        print_counters(&simulation, i);
    fathom_sim_pty_close(&simulation.pty);
    return status;
}

const command_t sim_command = {
    .name = "sim",
    .summary = "Simulate sensors behind a serial port until interrupted",
    .usage = "SENSOR[:ADDRESS][:MODE][,KEY=VALUE...]... [OPTIONS]",
    .tables = tables,
    .common = "link distance fault counters",
    .own_group = "Simulation",
    .about =
        "It prints the path of a pseudo terminal, which any program can open like a serial port. Write an "
        "option of one sensor behind it: a05:2,distance=1500,fault=drop=5%. An option without a sensor "
        "applies to all sensors that can have it. SIGUSR1 cuts the power of all sensors for a second.\n",
    .examples = "  fathom sim a16 --link ./tank\n"
                "  fathom sim a05::modbus --link ./bumper --distance 1000,2000,1953,no-target\n"
                "  fathom sim a16:1:modbus a05:2:modbus hps167s:7,distance=2083 --link ./bus\n",
    .status = "Exit status: 0 after Ctrl-C, 1 the port cannot be made, 2 wrong usage.\n",
    .topics = "faults, sensors",
    .operands = OPERANDS_SIMULATED,
    .settings_size = sizeof(settings_t),
    .start = start,
};
