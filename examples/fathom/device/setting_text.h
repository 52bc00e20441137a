/* SPDX-License-Identifier: MIT */
#ifndef SETTING_TEXT_H
#define SETTING_TEXT_H

#include "output/record.h"
#include "sensors/setting.h"

/* The settings as text. */

/* Returns the setting with this name; NULL: there is none. */
const setting_t *setting_of(const setting_t *settings, const char *name);

/* Stores the value. Returns false if the text is none. */
bool setting_value(const setting_t *setting, const char *text, int32_t *value);

/* Returns the possible values: "0 to 255 s" or "off, on". */
enum { SETTING_VALUES = 400 };
const char *setting_values_text(const setting_t *setting, char text[SETTING_VALUES]);

/* Prints a value: a word, or a number. */
void setting_print_value(const setting_t *setting, int32_t value, char text[SETTING_TEXT]);

/* Writes a value as a member of the open object: off and on as booleans, numbers as numbers, all else as a string, and
 * null if `text` is NULL. If `key` is NULL, the key is the name of the setting with underscores. */
void setting_json(json_t *json, const char *key, const setting_t *setting, const char *text);

/* Returns why a sensor that responds did not report this setting. NULL: the status is not about this setting alone. */
const char *setting_reason(fathom_status_t status);

/* Prints all settings with their possible values and effects. */
void settings_print(FILE *to, const setting_t *settings);

#endif
