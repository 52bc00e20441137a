/* SPDX-License-Identifier: MIT */
#ifndef CONFIG_H
#define CONFIG_H

#include <stdio.h>

#include "mqtt/settings.h"
#include "reading/site.h"

/* Reads a configuration file: what `fathom publish` does, and its sensors, each with its own name, into a site of
 * zeros. Each line of the site has its text. False after printing what is wrong; then there is nothing to free. */
bool config_load(publish_settings_t *settings, site_t *site, const char *command, const char *path);

/* Prints all keys of such a file, a line each. */
void config_print_keys(FILE *to);

#endif
