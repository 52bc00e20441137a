/* SPDX-License-Identifier: MIT */
#include "commands/commission/commission_options.h"

#include <string.h>

#include "cli/command.h"
#include "cli/options.h"
#include "device/setting_text.h"

static const char command[] = "commission";

enum { ADDRESSES = SESSION_OPTIONS, RECORD, TERMINATED, WAIT, OPTIONS };

static const struct option table[OPTIONS + 1] = {
    SESSION_OPTION_ROWS,
    [ADDRESSES] = {"addresses", required_argument, NULL, 256},
    [RECORD] = {"record", required_argument, NULL, 256},
    [TERMINATED] = {"terminated", required_argument, NULL, 256},
    [WAIT] = {"wait", required_argument, NULL, 256},
};

enum { MAX_WAIT_S = 86400 };

static bool is_in(const commission_options_t *options, uint8_t address)
{
    return memchr(options->addresses, address, options->count) != NULL;
}

static bool take_range(commission_options_t *options, uint32_t first, uint32_t last)
{
    for (uint32_t address = first; address <= last; address++) {
        if (is_in(options, (uint8_t)address)) {
            (void)usage_error(command, "address %u stands twice in --addresses", (unsigned)address);
            return false;
        }
        options->addresses[options->count++] = (uint8_t)address;
    }
    return true;
}

/* "2-9" or "5,7,10-12,1". */
static bool take_addresses(commission_options_t *options, const model_t *model, const char *list)
{
    if (list == NULL) {
        (void)usage_error(command, "which addresses are to be given? --addresses is missing, such as "
                                   "--addresses 2-9");
        return false;
    }
    while (list != NULL) {
        char item[16];
        uint32_t first = 0;
        uint32_t last = 0;
        list = next_word(list, ',', item, sizeof item);
        if (!range_parse(item, 1, model->max_address, &first, &last)) {
            (void)usage_error(command,
                              "--addresses takes addresses from 1 to %u and ranges with commas between them, "
                              "such as 2-9 or 5,7,10-12; not '%s'",
                              model->max_address, item);
            return false;
        }
        if (!take_range(options, first, last)) return false;
    }
    if (memchr(options->addresses, FACTORY_ADDRESS, options->count - 1) == NULL) return true;
    (void)usage_error(command,
                      "all units come with address %d, so it can be given to the last one only; put "
                      "it at the end, such as --addresses 2-8,1",
                      FACTORY_ADDRESS);
    return false;
}

static bool take_terminated(commission_options_t *options, const model_t *model, const char *text)
{
    uint32_t address = 0;
    const bool has_termination = setting_of(model->settings, "termination") != NULL;
    if (text != NULL && !has_termination) {
        (void)usage_error(command, "%s has no termination that can be set; leave --terminated out",
                          model->name);
        return false;
    }
    options->terminated = has_termination ? options->addresses[options->count - 1] : 0;
    if (text == NULL) return true;
    if (strcmp(text, "none") != 0 &&
        (!number_parse(text, 1, model->max_address, &address) || !is_in(options, (uint8_t)address))) {
        (void)usage_error(command, "--terminated takes one of --addresses, or none, not '%s'", text);
        return false;
    }
    options->terminated = (uint8_t)address;
    return true;
}

/* What a session may be and this may not. */
static bool is_suitable(const session_t *session)
{
    const char *const port = session_port(session)->path;
    if (session->station->address != FACTORY_ADDRESS)
        (void)usage_error(command, "it looks for units at address %d, with which they come; leave %u out",
                          FACTORY_ADDRESS, session->station->address);
    else if (strncmp(port, "tcp:", 4) == 0)
        (void)usage_error(command,
                          "it needs a serial port; behind '%s' two units at one address cannot be "
                          "told from one",
                          port);
    else
        return true;
    return false;
}

bool commission_options(commission_options_t *options, session_t *session, int argc, char **argv,
                        bool *wants_help)
{
    const char *values[OPTIONS] = {NULL};
    char **words = NULL;
    int count = 0;
    uint32_t wait_s = 0;
    memset(options, 0, sizeof *options);
    if (!session_options(session, command, argc, argv, table, values, &words, &count, wants_help))
        return false;
    if (*wants_help) return true;
    const model_t *const model = session->station->model;
    if (count != 0) {
        (void)usage_error(command, "one model at a time; '%s' is too much", words[0]);
        return false;
    }
    if (!session_set_mode(session, command, values, model_mode_of(session->station->model, NULL)) ||
        !is_suitable(session) || !take_addresses(options, model, values[ADDRESSES]) ||
        !take_terminated(options, model, values[TERMINATED]) ||
        !option_number(command, "wait", values[WAIT], 1, MAX_WAIT_S, &wait_s))
        return false;
    options->wait_us = wait_s * UINT64_C(1000000);
    options->record = values[RECORD];
    if (options->record != NULL) return true;
    (void)usage_error(command,
                      "--record is missing. It is the file that stores which sensor has which address");
    return false;
}

void commission_help(FILE *to)
{
    (void)fputs(
        "Assign addresses to new sensors that all have address 1. Connect them one after the other: the\n"
        "command prints the address that the next one gets, finds it, sets it up and verifies it.\n\n"
        "usage: fathom commission SENSOR --port PATH --addresses LIST --record FILE [OPTIONS]\n\n"
        "  --addresses LIST  addresses to assign, in this order, such as 2-9 or 5,7,10-12; 1 only as the "
        "last\n"
        "  --record FILE     text file that stores which sensor has which address; made if it does not "
        "exist.\n"
        "                    With the same file an interrupted command continues. No address in it is\n"
        "                    assigned again\n"
        "  --terminated N    hps167s: address at which the termination resistor stays on, or none; default\n"
        "                    the last of the list. It is switched off in all others from their next "
        "power-on\n"
        "  --wait SECONDS    end if no sensor was commissioned for this time; default: wait until Ctrl-C\n",
        to);
    session_options_help(to);
    (void)fputs(
        "\nThe port must be a serial port. No sensor may respond at the new address, and the sensor at "
        "address\n"
        "1 must be alone, which three reads check. The record has a line of the sensor before anything is\n"
        "written. Each write is announced, is made once, and only if the sensor has another value. Then the\n"
        "sensor is verified at its new address. After a failed or unconfirmed write the command ends. Run "
        "it\n"
        "again: it finds out where the sensor is. If a sensor reports its new termination only after a\n"
        "power-on, switch it off and on, and run the command again.\n\n"
        "Each hps167s is known by its UUID and may be taken off the line. An a16 or a05 has no UUID: keep "
        "the\n"
        "finished ones connected and switched on, since each has to respond when the command runs again.\n\n"
        "Exit status: 0 when all addresses are assigned and verified, 1 when not, 2 for wrong usage.\n\n"
        "examples:\n"
        "  fathom commission hps167s --port /dev/ttyUSB0 --addresses 2-9 --record hall.txt\n"
        "  fathom commission a16 --port /dev/ttyUSB0 --addresses 2-8,1 --record tanks.txt --wait 300\n"
        "  fathom sim hps167s hps167s hps167s --one-by-one --link ./bus      to try it, in another "
        "terminal\n",
        to);
}
