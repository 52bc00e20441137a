/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "cli/command.h"
#include "cli/key_list.h"
#include "cli/options.h"
#include "cli/result_options.h"

static const char name[] = "alarm";

enum { MAX_WORD = 32 };

#define MAX_TIME "2000000" /* MAX_UNKNOWN_MS */

static bool take_side(const char *value, uint8_t *side)
{
    const bool is_on = strcmp(value, "on") == 0;
    if (!is_on && strcmp(value, "off") != 0) return false;
    *side = is_on ? FATHOM_ALARM_ON : FATHOM_ALARM_OFF;
    return true;
}

static bool take_unknown(void *ctx, const char *value)
{
    return take_side(value, &((results_config_t *)ctx)->alarm.if_unknown);
}

static bool take_no_response(void *ctx, const char *value)
{
    return take_side(value, &((results_config_t *)ctx)->alarm.if_no_response);
}

/* "500/600": two numbers; or the second one is as the first. */
static bool take_two(const char *text, uint32_t min, uint32_t max, uint32_t *first, uint32_t *second)
{
    char word[MAX_WORD];
    const char *const rest = next_word(text, '/', word, sizeof word);
    return number_parse(word, min, max, first) && number_parse(rest != NULL ? rest : word, min, max, second);
}

static bool take_hold(void *ctx, const char *value)
{
    fathom_alarm_config_t *const alarm = &((results_config_t *)ctx)->alarm;
    uint32_t on_ms = 0;
    uint32_t off_ms = 0;
    if (!take_two(value, 0, MAX_UNKNOWN_MS, &on_ms, &off_ms)) return false;
    alarm->on_hold_us = on_ms * 1000u;
    alarm->off_hold_us = off_ms * 1000u;
    return true;
}

static bool take_unknown_after(void *ctx, const char *value)
{
    uint32_t ms = 0;
    if (!number_parse(value, 1, MAX_UNKNOWN_MS, &ms)) return false;
    ((results_config_t *)ctx)->alarm.unknown_us = ms * 1000u;
    return true;
}

static bool take_no_target(void *ctx, const char *value)
{
    const bool is_unknown = strcmp(value, "unknown") == 0;
    ((results_config_t *)ctx)->alarm.no_target_is_unknown = is_unknown;
    return is_unknown || strcmp(value, "far") == 0;
}

#define SAY "on or off (say which: a bumper, a tank and a pit differ)"

static const key_row_t keys[] = {
    {"unknown", SAY, take_unknown, true},
    {"no-response", SAY, take_no_response, true},
    {"hold", "the ms before it goes on, and off if that differs, from 0 to " MAX_TIME ", such as 200/1000",
     take_hold, false},
    {"unknown-after", "the ms without a distance after which it is not known, from 1 to " MAX_TIME,
     take_unknown_after, false},
    {"no-target", "far (the default) or unknown", take_no_target, false},
};

/* near<ON[/OFF] or far>ON[/OFF] */
static bool take_thresholds(fathom_alarm_config_t *alarm, const char *text)
{
    static const char near[] = "near<";
    static const char far[] = "far>";
    uint32_t on_mm = 0;
    uint32_t off_mm = 0;
    alarm->when = strncmp(text, near, strlen(near)) == 0 ? FATHOM_NEAR : FATHOM_FAR;
    if (alarm->when == FATHOM_FAR && strncmp(text, far, strlen(far)) != 0) return false;
    const char *const numbers = text + strlen(alarm->when == FATHOM_NEAR ? near : far);
    if (!take_two(numbers, 1, UINT16_MAX, &on_mm, &off_mm)) return false;
    alarm->on_mm = (uint16_t)on_mm;
    alarm->off_mm = (uint16_t)off_mm;
    return true;
}

bool alarm_option(results_config_t *config, const char *command, const char *text)
{
    char word[MAX_WORD];
    fathom_alarm_t alarm;
    const char *const rest = next_word(text, ',', word, sizeof word);
    config->has_alarm = true;
    if (!take_thresholds(&config->alarm, word)) {
        (void)usage_error(command,
                          "--%s begins with near<ON or near<ON/OFF, far>ON or far>ON/OFF, in mm from 1 to "
                          "65535, such as near<500/600, not with '%s'",
                          name, word);
        return false;
    }
    if (!key_list(command, name, rest, keys, sizeof keys / sizeof keys[0], config)) return false;
    if (fathom_alarm_init(&alarm, &config->alarm) == FATHOM_OK) return true;
    (void)usage_error(command,
                      "--%s %s: it goes off farther away than on with near, and nearer than on with far",
                      name, word);
    return false;
}
