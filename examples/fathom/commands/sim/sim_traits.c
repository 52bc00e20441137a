/* SPDX-License-Identifier: MIT */
#include "commands/sim/sim_traits.h"

#include <inttypes.h>
#include <string.h>

#include "cli/command.h"
#include "cli/options.h"

enum { NAMES_TEXT = 300 };

typedef struct {
    const char *name;
    const char *unit; /* of the value; NULL: it has none */
    uint32_t most;    /* of the value, from 1 */
    const char *text;
} trait_t;

static const trait_t traits[DEVICE_TRAITS] = {
    [DEVICE_EXCEPTIONS] = {"exceptions", NULL, 0, "refuses by exception instead of silence"},
    [DEVICE_ANSWERS_BROADCAST] = {"broadcast", NULL, 0, "answers what goes to address FF"},
    [DEVICE_REAL_TIME] = {"real-time", NULL, 0, "sends real-time values by itself"},
    [DEVICE_ANSWERS_FROM_NEW] = {"new-address", NULL, 0, "answers from the new address when it is set"},
    [DEVICE_WARM_UP] = {"warm-up", "S", 255, "measures nothing for so long after power-on"},
    [DEVICE_WARM_UP_REFUSES] = {"warm-up-04", NULL, 0, "says exception 04 meanwhile; else silence"},
    [DEVICE_WARM_UP_ABNORMAL] = {"warm-up-ff", NULL, 0, "sends the abnormal packet meanwhile"},
    [DEVICE_UNASKED] = {"unasked", "MS", 60000, "sends measurements unasked, so often"},
    [DEVICE_NO_OUTPUT] = {"output-off", NULL, 0, "as #10 has set it"},
    [DEVICE_NO_TERMINATION] = {"termination-off", NULL, 0, "as #11 has set it"},
    [DEVICE_BAUD_LATER] = {"baud-later", NULL, 0, "#9 acts from the next power-on, not at once"},
    [DEVICE_OFFSET_ADDS] = {"offset-adds", NULL, 0, "#12 adds to the offset before"},
    [DEVICE_RECONNECT] = {"reconnect", "MS", 1000000, "#2 tells this reconnect time"},
    [DEVICE_NO_BAUD_CODE] = {"baud-code-00", NULL, 0, "#2 tells 00 for its rate"},
    [DEVICE_COUNT_EXCEPTION] = {"count-03", NULL, 0, "exception 03 to a wrong length, not 02"},
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

bool sim_trait_fits(const char *text, const model_t *model) { return has(model, find(text)); }

static bool unknown(const char *command, const model_t *model, const char *text)
{
    char known[NAMES_TEXT] = "";
    for (size_t i = 0; i != DEVICE_TRAITS; i++) {
        if (has(model, &traits[i])) list_add(known, sizeof known, traits[i].name);
    }
    (void)usage_error(command, "there is no '%.*s' for %s, only %s", (int)strcspn(text, "="), text,
                      model->name, known);
    return false;
}

static bool is_ms(const trait_t *trait) { return strcmp(trait->unit, "MS") == 0; }

/* Milliseconds with up to three decimals: 18.5. As microseconds. */
static bool ms_parse(const char *text, uint32_t most, uint32_t *us)
{
    enum { DIGITS = 5, US = 1000 };
    const size_t whole = strcspn(text, ".");
    char digits[DIGITS + 1] = "";
    uint32_t ms = 0;
    if (whole > DIGITS) return false;
    memcpy(digits, text, whole);
    if (!number_parse(digits, 1, most, &ms)) return false;
    *us = ms * US;
    if (text[whole] == '\0') return true;
    uint32_t part = US / 10;
    for (text += whole + 1; *text >= '0' && *text <= '9' && part != 0; text++, part /= 10)
        *us += (uint32_t)(*text - '0') * part;
    return *text == '\0' && part != US / 10 && *us <= most * US;
}

bool sim_trait_take(uint32_t values[DEVICE_TRAITS], const char *command, const model_t *model,
                    const char *text)
{
    const trait_t *const trait = find(text);
    const size_t length = strcspn(text, "=");
    if (!has(model, trait)) return unknown(command, model, text);
    uint32_t value = 1;
    const bool has_value = text[length] == '=';
    const char *const number = text + length + 1;
    const bool is_right = trait->unit == NULL ? !has_value
                          : !has_value        ? false
                          : is_ms(trait)      ? ms_parse(number, trait->most, &value)
                                              : number_parse(number, 1, trait->most, &value);
    if (is_right) {
        values[trait - traits] = value;
        return true;
    }
    if (trait->unit == NULL)
        (void)usage_error(command, "--with %s takes no value, so not '%s'", trait->name, text);
    else
        (void)usage_error(command, "--with takes %s=%s, a %snumber from 1 to %" PRIu32 ", not '%s'",
                          trait->name, trait->unit, is_ms(trait) ? "" : "whole ", trait->most, text);
    return false;
}

void sim_traits_print(FILE *to)
{
    for (size_t i = 0; i != DEVICE_TRAITS; i++) {
        const trait_t *const trait = &traits[i];
        const int rest = 15 - (int)strlen(trait->name);
        const char *gap = "(";
        (void)fprintf(to, "    %s%s%-*s  %-46s ", trait->name, trait->unit != NULL ? "=" : "",
                      rest > 0 ? rest - (trait->unit != NULL ? 1 : 0) : 0,
                      trait->unit != NULL ? trait->unit : "", trait->text);
        for (size_t m = 0; m != MODELS; m++) {
            if (!has(models[m], trait)) continue;
            (void)fprintf(to, "%s%s", gap, models[m]->name);
            gap = " ";
        }
        (void)fputs(")\n", to);
    }
}
