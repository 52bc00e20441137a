/* SPDX-License-Identifier: MIT */
#include <inttypes.h>
#include <string.h>

#include "commands/sim/sim.h"
#include "output/words.h"

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

static const trait_t *find(const char *text)
{
    const size_t length = strcspn(text, "=");
    for (size_t i = 0; i != DEVICE_TRAITS; i++)
        if (strlen(traits[i].name) == length && memcmp(traits[i].name, text, length) == 0) return &traits[i];
    return NULL;
}

static bool has(const model_t *model, const trait_t *trait)
{
    return trait != NULL && (model->traits >> (trait - traits) & 1) != 0;
}

bool sim_can_have_trait(const sim_sensor_t *sensor, const char *text)
{
    return has(sensor->model, find(text));
}

static bool reject_name(const model_t *model, const char *text, const origin_t *origin)
{
    char name[24];
    (void)snprintf(name, sizeof name, "%.*s", (int)strcspn(text, "="), text);
    nearest_t nearest = {.word = name};
    for (size_t i = 0; i != DEVICE_TRAITS; i++)
        if (has(model, &traits[i])) nearest_try(&nearest, traits[i].name);
    char what[40];
    (void)snprintf(what, sizeof what, "trait of %s", model->name);
    return reject_unknown(origin, what, "", &nearest, true);
}

static bool parse_value(const trait_t *trait, const char *text, uint32_t *value)
{
    uint32_t one = 1;
    for (uint32_t i = 0; i != trait->places; i++) one *= 10;
    return sim_decimal(text, strlen(text), trait->places, one, trait->max * one, value);
}

bool sim_add_trait(sim_sensor_t *sensor, const char *text, const origin_t *origin)
{
    const trait_t *const trait = find(text);
    const char *const value = strchr(text, '=');
    if (!has(sensor->model, trait)) return reject_name(sensor->model, text, origin);
    uint32_t *const set = &sensor->traits[trait - traits];
    *set = 1;
    if (trait->unit == NULL && value == NULL) return true;
    if (trait->unit != NULL && value != NULL && parse_value(trait, value + 1, set)) return true;
    if (trait->unit == NULL) return reject(origin, "with is '%s'. %s takes no value.", text, trait->name);
    return reject(origin, "with is '%s'. It takes %s=%s, a %snumber from 1 to %" PRIu32 ".", text,
                  trait->name, trait->unit, trait->places != 0 ? "" : "whole ", trait->max);
}

const char *sim_trait_name(size_t n) { return n < DEVICE_TRAITS ? traits[n].name : NULL; }

void sim_print_traits(FILE *to)
{
    for (size_t i = 0; i != DEVICE_TRAITS; i++) {
        const trait_t *const trait = &traits[i];
        const int rest = 15 - (int)strlen(trait->name);
        const char *gap = "(";
        (void)fprintf(to, "    %s%s%-*s  %-46s ", trait->name, trait->unit != NULL ? "=" : "",
                      rest > 0 ? rest - (trait->unit != NULL ? 1 : 0) : 0,
                      trait->unit != NULL ? trait->unit : "", trait->text);
        for (size_t m = 0; m != model_count; m++) {
            if (!has(&models[m], trait)) continue;
            (void)fprintf(to, "%s%s", gap, models[m].name);
            gap = " ";
        }
        (void)fputs(")\n", to);
    }
}
