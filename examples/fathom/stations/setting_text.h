/* SPDX-License-Identifier: MIT */
#ifndef SETTING_TEXT_H
#define SETTING_TEXT_H

#include "models/setting.h"

/* The settings as words: on the command line, in lists, in responses. */

/* By name; NULL after a usage error that lists what there is. */
const setting_t *setting_find(const char *command, const char *model, const setting_t *settings,
                              const char *name);

/* False after a usage error. */
bool setting_parse(const char *command, const setting_t *setting, const char *text, int32_t *value);

/* A word, or a number. */
void setting_print_value(const setting_t *setting, int32_t value, char text[SETTING_TEXT]);

/* All of them with their values and effects, for people. */
void settings_print(FILE *to, const setting_t *settings);

#endif
