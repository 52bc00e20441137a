/* SPDX-License-Identifier: MIT */
#include "ports/line_text.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "output/words.h"

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

bool parity_parse(const char *text, uint8_t *parity)
{
    for (uint8_t i = FATHOM_PARITY_NONE; i <= FATHOM_PARITY_ODD; i++) {
        if (strcmp(text, parity_name(i)) != 0) continue;
        *parity = i;
        return true;
    }
    return false;
}

bool baud_parse(const char *text, uint32_t *baud)
{
    static const uint32_t rates[] = {9600, 19200, 38400, 57600, 115200, 230400};
    uint32_t number = 0;
    if (!number_parse(text, 1, UINT32_MAX, &number)) return false;
    for (size_t i = 0; i != sizeof rates / sizeof rates[0]; i++) {
        if (number != rates[i]) continue;
        *baud = number;
        return true;
    }
    return false;
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
