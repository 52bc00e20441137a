/* SPDX-License-Identifier: MIT */
#ifndef CONFIG_H
#define CONFIG_H

#include "cli/config_keys.h"
#include "cli/result_options.h"
#include "mqtt/settings.h"

/* Reads a configuration file: what `fathom publish` does, and its sensors, each with a name of its own, into a site of
 * zeros. Each line of the site has its text. False after printing what is wrong; then there is nothing to free. */
bool config_load(publish_settings_t *settings, site_t *site, const char *command, const char *path);

/* ---- for config.c ---- */

/* A text of these characters into a buffer of SETTINGS_NAME; slashes: also between others. */
bool config_name(char text[SETTINGS_NAME], const char *value, bool slashes);

/* Reads lines: and below into the site. top: the values there. */
bool config_sensors(site_t *site, config_file_t *file, const char *command, const config_values_t *top);

#endif
