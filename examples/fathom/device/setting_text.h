/* SPDX-License-Identifier: MIT */
#ifndef SETTING_TEXT_H
#define SETTING_TEXT_H

#include "output/json.h"
#include "sensors/setting.h"

/* The settings as words: on the command line, in lists, in responses. */

/* By name; NULL: there is none. */
const setting_t *setting_of(const setting_t *settings, const char *name);

/* Its value, where the text is one. */
bool setting_value(const setting_t *setting, const char *text, int32_t *value);

/* What it may be, "0 to 255 s" or "off, on". */
enum { SETTING_VALUES = 400 };
const char *setting_values_text(const setting_t *setting, char text[SETTING_VALUES]);

/* A word, or a number. */
void setting_print_value(const setting_t *setting, int32_t value, char text[SETTING_TEXT]);

/* Writes a value as a member of the open object: off and on as booleans, numbers as numbers, all else as a string, and
 * null if `text` is NULL. If `key` is NULL, the key is the name of the setting with underscores. */
void setting_json(json_t *json, const char *key, const setting_t *setting, const char *text);

/* Why a device that answers has not told this one; NULL: the status says nothing of this one alone. */
const char *setting_reason(fathom_status_t status);

/* All of them with their values and effects, for people. */
void settings_print(FILE *to, const setting_t *settings);

#endif
