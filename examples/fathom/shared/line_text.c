/* SPDX-License-Identifier: MIT */
#include "shared/line_text.h"

#include <inttypes.h>
#include <stdio.h>

const char *line_text(const fathom_line_settings_t *settings, char text[LINE_TEXT])
{
    static const char parities[] = "NEO";
    (void)snprintf(text, LINE_TEXT, "%" PRIu32 " 8%c%u", settings->baud, parities[settings->parity],
                   settings->stop_bits);
    return text;
}

const char *parity_name(uint8_t parity)
{
    static const char *const names[] = {
        [FATHOM_PARITY_NONE] = "none", [FATHOM_PARITY_EVEN] = "even", [FATHOM_PARITY_ODD] = "odd"};
    return names[parity];
}

const char *line_options(const fathom_line_settings_t *line, const fathom_line_settings_t *factory,
                         char text[LINE_OPTIONS])
{
    int at = 0;
    text[0] = '\0';
    if (line->baud != factory->baud) at += snprintf(text, LINE_OPTIONS, " --baud %" PRIu32, line->baud);
    if (line->parity != factory->parity)
        at += snprintf(text + at, (size_t)(LINE_OPTIONS - at), " --parity %s", parity_name(line->parity));
    if (line->stop_bits != factory->stop_bits)
        (void)snprintf(text + at, (size_t)(LINE_OPTIONS - at), " --stop-bits %u", line->stop_bits);
    return text;
}
