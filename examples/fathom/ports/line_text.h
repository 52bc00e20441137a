/* SPDX-License-Identifier: MIT */
#ifndef LINE_TEXT_H
#define LINE_TEXT_H

#include <stdbool.h>

#include "fathom/hal.h"

/* The settings of a line in words. */

/* "9600 8N1", in a buffer of the caller's. */
enum { LINE_TEXT = 24 };
const char *line_text(const fathom_line_settings_t *settings, char text[LINE_TEXT]);

/* "none", "even" or "odd". */
const char *parity_name(uint8_t parity);

/* One of these; and a rate that a port can have: 9600, 19200, 38400, 57600, 115200 or 230400. Otherwise false. */
bool parity_parse(const char *text, uint8_t *parity);
bool baud_parse(const char *text, uint32_t *baud);

/* What of a sensor's line has to be told because it is not the factory's, as options: " --baud 57600", "". In a buffer
 * of the caller's. */
enum { LINE_OPTIONS = 64 };
const char *line_options(const fathom_line_settings_t *line, const fathom_line_settings_t *factory,
                         char text[LINE_OPTIONS]);

#endif
