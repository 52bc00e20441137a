/* SPDX-License-Identifier: MIT */
#ifndef EXPLAIN_H
#define EXPLAIN_H

#include <stdio.h>

#include "mqtt/settings.h"
#include "reading/site.h"

/* Prints a table of the sensors, and the topics under which they are published. */
void explain(const publish_settings_t *settings, const site_t *site, FILE *to);

#endif
