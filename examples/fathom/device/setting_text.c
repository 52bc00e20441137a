/* SPDX-License-Identifier: MIT */
#include "device/setting_text.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "output/words.h"

const char *setting_values_text(const setting_t *setting, char text[SETTING_VALUES])
{
    text[0] = '\0';
    if (setting->words != NULL) {
        for (const char *const *word = setting->words; *word != NULL; word++)
            list_add(text, SETTING_VALUES, *word);
        return text;
    }
    (void)snprintf(text, SETTING_VALUES, "%" PRId32 " to %" PRId32, setting->least, setting->most);
    if (setting->step > 1) {
        char multiple[SETTING_TEXT];
        (void)snprintf(multiple, sizeof multiple, "a multiple of %" PRId32, setting->step);
        list_add(text, SETTING_VALUES, multiple);
    }
    if (setting->unit != NULL) {
        const size_t length = strlen(text);
        (void)snprintf(text + length, SETTING_VALUES - length, " %s", setting->unit);
    }
    return text;
}

const setting_t *setting_of(const setting_t *settings, const char *name)
{
    for (const setting_t *setting = settings; setting->name != NULL; setting++)
        if (strcmp(setting->name, name) == 0) return setting;
    return NULL;
}

static bool parse_number(const setting_t *setting, const char *text, int32_t *value)
{
    char *end = NULL;
    const char *const digits = text[0] == '-' ? text + 1 : text;
    if (*digits < '0' || *digits > '9' || strlen(digits) > 10) return false;
    const long long number = strtoll(text, &end, 10);
    if (*end != '\0' || number < setting->least || number > setting->most) return false;
    if (setting->step > 1 && number % setting->step != 0) return false;
    *value = (int32_t)number;
    return true;
}

bool setting_value(const setting_t *setting, const char *text, int32_t *value)
{
    if (setting->words == NULL) return parse_number(setting, text, value);
    for (int32_t i = 0; setting->words[i] != NULL; i++) {
        if (strcmp(setting->words[i], text) != 0) continue;
        *value = i;
        return true;
    }
    return false;
}

const char *setting_reason(fathom_status_t status)
{
    switch (status) {
    case FATHOM_ERR_NO_RESPONSE:
        return "no response. Not every variant has it";
    case FATHOM_ERR_EXCEPTION:
        return "refused. Not every variant has it";
    case FATHOM_ERR_MALFORMED:
        return "the response has an impossible value";
    default:
        return NULL;
    }
}

void setting_print_value(const setting_t *setting, int32_t value, char text[SETTING_TEXT])
{
    if (setting->words != NULL)
        (void)snprintf(text, SETTING_TEXT, "%s", setting->words[value]);
    else
        (void)snprintf(text, SETTING_TEXT, "%" PRId32, value);
}

static bool is_number(const setting_t *setting, const char *text)
{
    if (setting->kind == SETTING_VERSION || setting->kind == SETTING_IDENTITY) return false;
    return text[0] != '\0' && strspn(text, "-0123456789.") == strlen(text);
}

void setting_json(json_t *json, const char *key, const setting_t *setting, const char *text)
{
    char name[SETTING_TEXT];
    (void)snprintf(name, sizeof name, "%s", setting->name);
    for (char *at = name; *at != '\0'; at++)
        if (*at == '-') *at = '_';
    if (key == NULL) key = name;
    if (text != NULL && (strcmp(text, "on") == 0 || strcmp(text, "off") == 0))
        json_flag(json, key, strcmp(text, "on") == 0);
    else if (text != NULL && is_number(setting, text))
        json_value(json, key, "%s", text);
    else
        json_string(json, key, text);
}

void settings_print(FILE *to, const setting_t *settings)
{
    for (const setting_t *setting = settings; setting->name != NULL; setting++) {
        (void)fprintf(to, "  %s%s\n      %s", setting->name, setting->get == NULL ? " (write-only)" : "",
                      setting->what);
        if (setting->effect == NULL) {
            (void)fputs("; cannot be set", to);
        } else {
            char values[SETTING_VALUES];
            (void)fprintf(to, ": %s\n      %s", setting_values_text(setting, values), setting->effect);
        }
        (void)fputs("\n", to);
    }
}
