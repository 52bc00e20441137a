/* SPDX-License-Identifier: MIT */
#include "commands/scan/scan_options.h"

#include <string.h>

#include "cli/command.h"
#include "cli/options.h"
#include "ports/line_text.h"
#include "sensors/models.h"

static const char command[] = "scan";

enum {
    PORT,
    BAUD,
    PARITY,
    STOP_BITS,
    ADDRESS,
    TIMEOUT,
    RETRIES,
    LISTEN,
    WAKE,
    ESTIMATE,
    FORMAT,
    HELP,
    OPTIONS
};

static const struct option table[OPTIONS + 1] = {
    [PORT] = {"port", required_argument, NULL, OPTION_ONCE},
    [BAUD] = {"baud", required_argument, NULL, 256},
    [PARITY] = {"parity", required_argument, NULL, 256},
    [STOP_BITS] = {"stop-bits", required_argument, NULL, 256},
    [ADDRESS] = {"address", required_argument, NULL, 256},
    [TIMEOUT] = {"timeout", required_argument, NULL, 256},
    [RETRIES] = {"retries", required_argument, NULL, 256},
    [LISTEN] = {"listen", required_argument, NULL, 256},
    [WAKE] = {"wake", no_argument, NULL, 256},
    [ESTIMATE] = {"estimate", no_argument, NULL, 256},
    [FORMAT] = {"format", required_argument, NULL, 256},
    [HELP] = {"help", no_argument, NULL, 256},
};

enum {
    FIRST_ADDRESS = 1,
    LAST_ADDRESS = 32, /* of an HPS-167S; an A16 or A05 that was given more is found with --address */
    MAX_ADDRESS = 254,
    MAX_TIMEOUT_MS = 10000,
    MAX_RETRIES = 9,
    /* No period of the frames is printed. A16 2(2) gives its value 7.5 s to settle; two frames at 3 s fit too. */
    DEFAULT_LISTEN_S = 8,
    MAX_LISTEN_S = 60,
    ALL_PARITIES = 1 << FATHOM_PARITY_NONE | 1 << FATHOM_PARITY_EVEN | 1 << FATHOM_PARITY_ODD,
    ITEM_TEXT = 16
};

/* Each once, in the order in which they come; 0 ends them. */
static void add_rate(uint32_t bauds[SCAN_RATES + 1], uint32_t baud)
{
    uint8_t i = 0;
    while (bauds[i] != 0 && bauds[i] != baud) i++;
    bauds[i] = baud;
}

/* All that a sensor can have. */
static void add_all_rates(uint32_t bauds[SCAN_RATES + 1])
{
    for (size_t i = 0; i != model_count; i++) {
        add_rate(bauds, models[i].line.baud);
        for (const uint32_t *rate = models[i].rates; rate != NULL && *rate != 0; rate++)
            add_rate(bauds, *rate);
    }
}

/* Adds those that the user wants. */
static bool take_bauds(const char *list, uint32_t bauds[SCAN_RATES + 1])
{
    if (strcmp(list, "all") == 0) {
        add_all_rates(bauds);
        return true;
    }
    while (list != NULL) {
        char item[ITEM_TEXT];
        uint32_t baud = 0;
        list = next_word(list, ',', item, sizeof item);
        if (!baud_parse(item, &baud)) {
            (void)usage_error(
                command,
                "--baud takes all, or some of 9600, 19200, 38400, 57600, 115200 and 230400 with commas "
                "between them, not '%s'",
                item);
            return false;
        }
        add_rate(bauds, baud);
    }
    return true;
}

/* One bit each. */
static bool take_parities(const char *list, unsigned *parities)
{
    if (strcmp(list, "all") == 0) {
        *parities = ALL_PARITIES;
        return true;
    }
    while (list != NULL) {
        char item[ITEM_TEXT];
        uint8_t parity = FATHOM_PARITY_NONE;
        list = next_word(list, ',', item, sizeof item);
        if (!parity_parse(item, &parity)) {
            (void)usage_error(command,
                              "--parity takes all, or some of none, even and odd with commas between them, "
                              "not '%s'",
                              item);
            return false;
        }
        *parities |= 1u << parity;
    }
    return true;
}

static void add_settings(scan_plan_t *plan, uint32_t baud, uint8_t parity, uint32_t stop_bits)
{
    const fathom_line_settings_t settings = {baud, parity, (uint8_t)stop_bits};
    plan->settings[plan->setting_count++] = settings;
}

/* A sensor's own parity comes first: where something answers, the others of this rate are left out. Two stop bits take
 * the place of the parity bit (HPS-167S 2.2.2). */
static bool take_settings(scan_options_t *options, const char *const *values)
{
    const char *const baud_list = values[BAUD];
    const char *const parity_list = values[PARITY];
    uint32_t stop_bits = 1;
    uint32_t bauds[SCAN_RATES + 1] = {0};
    unsigned parities = 0;
    for (size_t i = 0; baud_list == NULL && i != model_count; i++) add_rate(bauds, models[i].line.baud);
    if (baud_list != NULL && !take_bauds(baud_list, bauds)) return false;
    if (parity_list != NULL && !take_parities(parity_list, &parities)) return false;
    if (!option_number(command, "stop-bits", values[STOP_BITS], 1, 2, &stop_bits)) return false;
    if (parities == 0 && stop_bits == 2) parities = 1u << FATHOM_PARITY_NONE;
    for (uint8_t i = 0; bauds[i] != 0; i++) {
        const uint8_t factory = scan_factory_parity(bauds[i]);
        if (parities == 0 || (parities & 1u << factory) != 0)
            add_settings(&options->plan, bauds[i], factory, stop_bits);
        for (uint8_t parity = 0; parity != SCAN_PARITIES; parity++)
            if (parity != factory && (parities & 1u << parity) != 0)
                add_settings(&options->plan, bauds[i], parity, stop_bits);
    }
    return true;
}

/* A or A-B. */
static bool take_addresses(scan_plan_t *plan, const char *text)
{
    uint32_t first = FIRST_ADDRESS;
    uint32_t last = LAST_ADDRESS;
    if (text != NULL && strcmp(text, "0") == 0) {
        first = last = 0; /* by itself only: most units take it for a broadcast */
    } else if (text != NULL && !range_parse(text, 1, MAX_ADDRESS, &first, &last)) {
        (void)usage_error(command, "--address takes one from 1 to %d, or a range such as 1-32, not '%s'",
                          MAX_ADDRESS, text);
        return false;
    }
    plan->first = (uint8_t)first;
    plan->last = (uint8_t)last;
    return true;
}

static bool take_numbers(scan_plan_t *plan, const char *const *values)
{
    uint32_t timeout_ms = 0;
    uint32_t listen_s = DEFAULT_LISTEN_S;
    uint32_t retries = 0;
    if (!option_number(command, "timeout", values[TIMEOUT], 1, MAX_TIMEOUT_MS, &timeout_ms) ||
        !option_number(command, "retries", values[RETRIES], 0, MAX_RETRIES, &retries) ||
        !option_number(command, "listen", values[LISTEN], 1, MAX_LISTEN_S, &listen_s))
        return false;
    plan->timeout_us = timeout_ms * 1000u;
    plan->listen_us = listen_s * 1000000u;
    plan->repeats = (uint8_t)retries;
    return true;
}

bool scan_options(scan_options_t *options, int argc, char **argv)
{
    const char *values[OPTIONS] = {NULL};
    memset(options, 0, sizeof *options);
    const int rest = options_parse(command, argc, argv, table, values);
    if (rest < 0) return false;
    options->wants_help = values[HELP] != NULL;
    if (options->wants_help) return true;
    if (rest != argc) {
        (void)usage_error(command, "it takes options only, not '%s'", argv[rest]);
        return false;
    }
    if (!take_settings(options, values) || !take_addresses(&options->plan, values[ADDRESS]) ||
        !take_numbers(&options->plan, values) || !option_json(command, values[FORMAT], &options->is_json))
        return false;
    options->is_default = values[BAUD] == NULL && values[PARITY] == NULL && values[STOP_BITS] == NULL &&
                          values[ADDRESS] == NULL;
    options->wake = values[WAKE] != NULL;
    options->estimate = values[ESTIMATE] != NULL;
    options->port = values[PORT];
    if (options->estimate && options->port == NULL) return true;
    if (!option_port(command, options->port)) return false;
    if (strncmp(options->port, "tcp:", 4) != 0) return true;
    (void)usage_error(command, "it needs a serial port; the rates behind '%s' are the gateway's",
                      options->port);
    return false;
}

void scan_help(FILE *to)
{
    (void)fputs(
        "fathom scan finds A16, A05 and HPS-167S on a serial port, each in a line with the command that "
        "reads "
        "it.\n\n"
        "usage: fathom scan --port PATH [OPTIONS]\n\n"
        "It only reads: nothing that it sends can change a setting of a sensor. But even a read ends the "
        "output of\n"
        "an A16 or A05 that sends by itself (for an A05 until power-off). So it listens first, and asks "
        "nothing where\n"
        "something sends.\n\n"
        "  --port PATH       the serial port: /dev/ttyUSB0, or the link of `fathom sim`\n" OPTIONS_PORT_HELP
        "  --address A-B     the addresses to ask, 1..254; default 1-32. Or 0 alone, which an A16 or A05 may "
        "have\n"
        "  --baud LIST       the rates, such as 9600,57600, or all; default 9600,19200\n"
        "  --parity LIST     some of none,even,odd, or all; default: as from the factory, none at 9600 and "
        "even above\n"
        "  --stop-bits N     1 (default) or 2; 2 means no parity too unless --parity is given\n"
        "  --timeout MS      how long an address may take to answer; default 150 at 9600 8N1, else 100\n"
        "  --retries N       how often a silent address is asked again; default 0\n"
        "  --listen SECONDS  how long it listens first; default 8\n"
        "  --wake            asks also where something sends by itself\n"
        "  --estimate        only tells how long the scan would take\n"
        "  --format FORMAT   text (default) or json, an object a line\n\n"
        "Where something answers, other parities of the same rate are not tried at that address.\n"
        "What is found goes to the standard output, everything else to the standard error.\n"
        "Exit status: 0 when a sensor was found, 1 when none was or the port failed, 2 for wrong usage.\n\n"
        "examples:\n"
        "  fathom scan --port /dev/ttyUSB0                      sensors as from the factory, addresses 1 to "
        "32\n"
        "  fathom scan --port /dev/ttyUSB0 --address 1-254 --baud all --parity all\n"
        "  fathom scan --port /dev/ttyUSB0 --baud 57600,115200,230400 --format json\n",
        to);
}
