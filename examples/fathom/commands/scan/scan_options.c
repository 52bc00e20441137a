/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "commands/scan/scan.h"
#include "output/words.h"
#include "sensors/models.h"

#define BAUDS    "9600 19200 38400 57600 115200 230400"
#define PARITIES "none even odd"

enum { ITEM_TEXT = 16, MAX_ADDRESS = 254 };

void scan_add_rate(scan_rates_t *rates, uint32_t baud)
{
    for (uint8_t i = 0; i != rates->count; i++)
        if (rates->baud[i] == baud) return;
    rates->baud[rates->count++] = baud;
}

static void add_all_rates(scan_rates_t *rates)
{
    for (size_t i = 0; i != model_count; i++) {
        scan_add_rate(rates, models[i].line.baud);
        for (const uint32_t *rate = models[i].rates; rate != NULL && *rate != 0; rate++)
            scan_add_rate(rates, *rate);
    }
}

static bool parse_rates(const char *text, void *member)
{
    scan_rates_t *const rates = member;
    *rates = (scan_rates_t){0};
    if (strcmp(text, "all") == 0) {
        add_all_rates(rates);
        return true;
    }
    while (text != NULL) {
        char item[ITEM_TEXT];
        uint32_t place = 0;
        uint32_t baud = 0;
        text = next_word(text, ',', item, sizeof item);
        if (!word_find(BAUDS, item, &place) || !number_parse(item, 1, UINT32_MAX, &baud)) return false;
        scan_add_rate(rates, baud);
    }
    return true;
}

static bool parse_parities(const char *text, void *member)
{
    uint8_t *const parities = member;
    *parities = 0;
    if (strcmp(text, "all") == 0) text = "none,even,odd";
    while (text != NULL) {
        char item[ITEM_TEXT];
        uint32_t place = 0;
        text = next_word(text, ',', item, sizeof item);
        if (!word_find(PARITIES, item, &place)) return false;
        *parities |= (uint8_t)(1u << place);
    }
    return true;
}

/* Address 0 stands alone, since most units obey it as a broadcast. */
static bool parse_addresses(const char *text, void *member)
{
    scan_addresses_t *const addresses = member;
    uint32_t first = 0;
    uint32_t last = 0;
    if (strcmp(text, "0") != 0 && !range_parse(text, 1, MAX_ADDRESS, &first, &last)) return false;
    *addresses = (scan_addresses_t){(uint8_t)first, (uint8_t)last};
    return true;
}

static const option_t rows[] = {
    {"port", "PATH", "Use the serial port PATH (default: $FATHOM_PORT)", KIND_TEXT, GROUP_LINE,
     AT(scan_settings_t, port), .is_once = true},
    {"address", "A-B", "Ask the addresses A to B of 1-254, or 0 (default 1-32)", KIND_CUSTOM, GROUP_COMMAND,
     .takes = "an address from 1 to 254, a range such as 1-32, or 0", .parse = parse_addresses,
     AT(scan_settings_t, addresses), HAS(scan_settings_t, has_addresses)},
    {"baud", "LIST", "Try these rates, or all (default 9600,19200)", KIND_CUSTOM, GROUP_LINE,
     .takes = "all, or some of 9600, 19200, 38400, 57600, 115200 and 230400 with commas between them",
     .words = "all " BAUDS, .parse = parse_rates, AT(scan_settings_t, rates)},
    {"parity", "LIST", "Try these parities, or all (default: factory setting)", KIND_CUSTOM, GROUP_LINE,
     .takes = "all, or some of none, even and odd with commas between them", .words = "all " PARITIES,
     .parse = parse_parities, AT(scan_settings_t, parities)},
    {"stop-bits", "N", "Set 1 or 2 stop bits; 2 implies no parity", KIND_NUMBER, GROUP_LINE, .min = 1,
     .max = 2, AT(scan_settings_t, stop_bits)},
    {"timeout", "MS", "Wait MS for a response (150 at 9600 8N1, else 100)", KIND_NUMBER, GROUP_COMMAND,
     .min = 1, .max = 10000, .scale = 1000, AT(scan_settings_t, timeout_us)},
    {"retries", "N", "Ask a silent address N more times (default 0)", KIND_NUMBER, GROUP_COMMAND, .max = 9,
     AT(scan_settings_t, retries)},
    {"listen", "S", "Listen for S seconds before the first request (8)", KIND_NUMBER, GROUP_COMMAND, .min = 1,
     .max = 60, .scale = 1000000, AT(scan_settings_t, listen_us)},
    {"wake", .help = "Send requests also if a sensor sends automatically", .group = GROUP_COMMAND,
     AT(scan_settings_t, wake)},
    {"estimate", .help = "Print how long the scan would take, and stop", .group = GROUP_COMMAND,
     AT(scan_settings_t, estimate)},
    {"format", "FORMAT", "Print text or json, one object a line (default text)", KIND_CHOICE, GROUP_OUTPUT,
     .words = "text json", AT(scan_settings_t, is_json)},
    {.name = NULL},
};

const option_table_t scan_tables[] = {{rows, 0}, {NULL, 0}};
