/* SPDX-License-Identifier: MIT */
#include "commands/sim/sim_options.h"

#include <inttypes.h>
#include <string.h>

#include "cli/command.h"
#include "cli/options.h"
#include "commands/sim/sim_traits.h"
#include "sensors/sensor_text.h"
#include "sim/pty.h"

static const char command[] = "sim";

enum { LINK, DISTANCE, SEED, FAULT, BAUD, WITH, ECHO_ON, COUNTERS, ONE_BY_ONE, HELP, OPTIONS };

static const struct option table[OPTIONS + 1] = {
    [LINK] = {"link", required_argument, NULL, 256},
    [DISTANCE] = {"distance", required_argument, NULL, 256},
    [SEED] = {"seed", required_argument, NULL, 256},
    [FAULT] = {"fault", required_argument, NULL, 256},
    [BAUD] = {"baud", required_argument, NULL, 256},
    [WITH] = {"with", required_argument, NULL, 256},

    [ECHO_ON] = {"echo", no_argument, NULL, 256},
    [COUNTERS] = {"counters", no_argument, NULL, 256},
    [ONE_BY_ONE] = {"one-by-one", no_argument, NULL, 256},
    [HELP] = {"help", no_argument, NULL, 256},
};

/* ---- options that hold for all devices, or as N@VALUE for the N-th ---- */

enum { MAX_GIVEN = 1024 };

typedef struct {
    const char *whole; /* as it was given */
    const char *value; /* without N@ */
    uint32_t device;   /* counted from 1; 0: all */
    int row;
} given_t;

typedef struct {
    given_t list[MAX_GIVEN];
    uint32_t count; /* of all, also of those beyond the list */
} givens_t;

/* The place on the command line tells devices apart; an address would not, two may have the same one. */
static void each(void *ctx, int row, const char *value)
{
    givens_t *const givens = ctx;
    given_t given = {value, value, 0, row};
    const size_t digits = strspn(value, "0123456789");
    if (row != DISTANCE && row != FAULT && row != BAUD && row != WITH) return;
    if (digits != 0 && digits < 9 && value[digits] == '@') {
        for (size_t i = 0; i != digits; i++) given.device = given.device * 10 + (uint32_t)(value[i] - '0');
        if (given.device == 0) given.device = UINT32_MAX; /* there is no such device either */
        given.value = value + digits + 1;
    }
    if (givens->count < MAX_GIVEN) givens->list[givens->count] = given;
    givens->count++;
}

static bool check_givens(const givens_t *givens, uint32_t devices)
{
    if (givens->count > MAX_GIVEN) {
        (void)usage_error(command, "there are more than %d options", MAX_GIVEN);
        return false;
    }
    for (uint32_t i = 0; i != givens->count; i++) {
        const given_t *const given = &givens->list[i];
        if (given->device <= devices) continue;
        (void)usage_error(command, "--%s %s is for a device that is not there; they count from 1 to %" PRIu32,
                          table[given->row].name, given->whole, devices);
        return false;
    }
    return true;
}

/* What was given for this device (0: for all) by itself; of several the last. NULL: nothing. */
static const char *given_of(const givens_t *givens, int row, uint32_t device)
{
    for (uint32_t i = givens->count; i != 0; i--) {
        const given_t *const given = &givens->list[i - 1];
        if (given->row == row && given->device == device) return given->value;
    }
    return NULL;
}

static const char *given_for(const givens_t *givens, int row, uint32_t device)
{
    const char *const own = given_of(givens, row, device);
    return own != NULL ? own : given_of(givens, row, 0);
}

/* ---- the devices ---- */

/* Apart, so that two devices do not do everything at the same moment. */
enum { SEED_STEP = 1000003 };

static bool take_device(sim_device_t *device, const char *text)
{
    sensor_text_t sensor;
    if (!sensor_text_parse(&sensor, command, text, strlen(text))) return false;
    device->model = sensor.model;
    device->mode = model_mode_find(command, sensor.model, sensor.mode);
    device->address = FACTORY_ADDRESS;
    device->line = sensor.model->line;
    if (device->mode != NULL && device->mode->simulate == NULL) {
        (void)usage_error(command, "%s in mode %s has pins and no line, and is not simulated here",
                          sensor.model->name, device->mode->name);
        return false;
    }
    return device->mode != NULL && sensor_text_address(&sensor, command, device->mode, &device->address);
}

static bool take_devices(sim_options_t *options, int count, char **texts)
{
    const sim_device_t *sender = NULL;
    if (count == 0 || count > SIM_DEVICES) {
        if (count == 0)
            (void)usage_error(command, "which sensor? a16, a05 or hps167s");
        else
            (void)usage_error(command, "up to %d devices a line, not %d", SIM_DEVICES, count);
        return false;
    }
    for (; options->count != (uint32_t)count; options->count++) {
        sim_device_t *const device = &options->devices[options->count];
        if (!take_device(device, texts[options->count])) return false;
        if (device->mode->is_asked) continue;
        if (sender != NULL) {
            (void)usage_error(command,
                              "%s and %s would both send by themselves, which one line cannot carry; "
                              "give one of them a mode in which it is asked",
                              sender->model->name, device->model->name);
            return false;
        }
        sender = device;
    }
    return true;
}

static bool has_rates(const sim_device_t *device) { return device->model->rates != NULL; }

static bool take_baud(sim_device_t *device, const char *text)
{
    uint32_t baud = 0;
    if (!has_rates(device)) {
        (void)usage_error(command, "%s has one baud rate only", device->model->name);
        return false;
    }
    if (number_parse(text, 1, UINT32_MAX, &baud) && model_has_rate(device->model, baud)) {
        device->line.baud = baud;
        return true;
    }
    (void)usage_error(command, "--baud of %s takes 19200, 57600, 115200 or 230400, not '%s'",
                      device->model->name, text);
    return false;
}

/* What is for all is meant for those that can have it; there must be one. */
static bool take_traits(sim_options_t *options, const givens_t *givens, uint32_t number)
{
    sim_device_t *const device = &options->devices[number - 1];
    for (uint32_t i = 0; i != givens->count; i++) {
        const given_t *const given = &givens->list[i];
        if (given->row != WITH || (given->device != 0 && given->device != number)) continue;
        bool others_can = false;
        for (uint32_t other = 0; other != options->count && given->device == 0; other++)
            others_can = others_can || sim_trait_fits(given->value, options->devices[other].model);
        if (others_can && !sim_trait_fits(given->value, device->model)) continue;
        if (!sim_trait_take(device->traits, command, device->model, given->value)) return false;
    }
    return true;
}

/* Everything that may differ from device to device; number: from 1. A rate for all is meant for those that can
 * have it, if there are any. */
static bool equip(sim_device_t *device, const givens_t *givens, uint32_t number, uint32_t seed,
                  bool any_rates)
{
    const bool for_all = given_of(givens, BAUD, number) == NULL;
    const char *const baud = given_for(givens, BAUD, number);
    const char *const distance = given_for(givens, DISTANCE, number);
    device->seed = seed + (number - 1) * SEED_STEP;
    for (uint32_t i = 0; i != givens->count; i++) {
        const given_t *const given = &givens->list[i];
        if (given->row == FAULT && (given->device == 0 || given->device == number))
            sim_faults_note(&device->faults, given->value);
    }
    if (!sim_faults_parse(&device->faults, command, device->model, device->mode)) return false;
    if (baud != NULL && !(for_all && any_rates && !has_rates(device)) && !take_baud(device, baud))
        return false;
    if (distance != NULL) return sim_scene_fixed(&device->scene, command, device->model, distance);
    sim_scene_moving(&device->scene, device->model, device->seed, fathom_sim_pty_now_us());
    return true;
}

bool sim_options(sim_options_t *options, int argc, char **argv)
{
    static givens_t givens;
    const char *values[OPTIONS] = {NULL};
    uint32_t seed = 0;
    memset(options, 0, sizeof *options);
    const int rest = options_parse_each(command, argc, argv, table, values, each, &givens);
    if (rest < 0) return false;
    options->wants_help = values[HELP] != NULL;
    if (options->wants_help) return true;
    options->link = values[LINK];
    options->echo = values[ECHO_ON] != NULL;
    options->counters = values[COUNTERS] != NULL;
    options->one_by_one = values[ONE_BY_ONE] != NULL;
    if (!take_devices(options, argc - rest, argv + rest) || !check_givens(&givens, options->count) ||
        !option_number(command, "seed", values[SEED], 0, UINT32_MAX, &seed))
        return false;
    bool any_rates = false;
    for (uint32_t i = 0; i != options->count; i++) any_rates = any_rates || has_rates(&options->devices[i]);
    for (uint32_t i = 0; i != options->count; i++)
        if (!take_traits(options, &givens, i + 1) ||
            !equip(&options->devices[i], &givens, i + 1, seed, any_rates))
            return false;
    return true;
}
