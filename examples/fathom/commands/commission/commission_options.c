/* SPDX-License-Identifier: MIT */
#include "commands/commission/commission_options.h"

#include <string.h>

#include "device/setting_text.h"
#include "output/words.h"

static const option_t rows[] = {
    {"addresses", "LIST", "Assign these addresses in this order, such as 2-9 or 5,7,10-12", KIND_TEXT,
     GROUP_COMMAND, AT(commission_settings_t, addresses), .is_required = true,
     .takes = "addresses and ranges, such as 2-9 or 5,7,10-12"},
    {"record", "FILE", "Store in FILE which sensor has which address; continue if it exists", KIND_TEXT,
     GROUP_COMMAND, AT(commission_settings_t, record), .is_required = true, .is_path = true,
     .takes = "the name of a file"},
    {"terminated", "N", "Leave the termination of an hps167s on at address N, or at none (default: the last)",
     KIND_TEXT, GROUP_COMMAND, AT(commission_settings_t, terminated)},
    {"wait", "S", "Stop if no sensor was commissioned for S seconds", KIND_NUMBER, GROUP_COMMAND, .min = 1,
     .max = 86400, .scale = 1000000, AT(commission_settings_t, wait_us)},
    {.name = NULL},
};

const option_table_t commission_tables[] = {{rows, 0}, SESSION_TABLES, {session_format_rows, 0}, {NULL, 0}};

static bool is_in(const commission_options_t *options, uint8_t address)
{
    return memchr(options->addresses, address, options->count) != NULL;
}

static bool add_range(commission_options_t *options, uint32_t first, uint32_t last, const origin_t *origin)
{
    for (uint32_t address = first; address <= last; address++) {
        if (is_in(options, (uint8_t)address))
            return reject(origin, "--addresses has address %u twice.", (unsigned)address);
        options->addresses[options->count++] = (uint8_t)address;
    }
    return true;
}

/* "2-9" or "5,7,10-12,1". */
static bool set_addresses(commission_options_t *options, const model_t *model, const char *list,
                          const origin_t *origin)
{
    while (list != NULL) {
        char item[16];
        uint32_t first = 0;
        uint32_t last = 0;
        list = next_word(list, ',', item, sizeof item);
        if (!range_parse(item, 1, model->max_address, &first, &last))
            return reject(
                origin,
                "--addresses has '%s'. It takes addresses from 1 to %u and ranges with commas between "
                "them, such as 2-9 or 5,7,10-12.",
                item, model->max_address);
        if (!add_range(options, first, last, origin)) return false;
    }
    if (memchr(options->addresses, FACTORY_ADDRESS, options->count - 1) == NULL) return true;
    return reject(origin,
                  "--addresses has address %d before its end. All new sensors have it, so only the last "
                  "one can keep it, such as --addresses 2-8,1.",
                  FACTORY_ADDRESS);
}

static bool set_terminated(commission_options_t *options, const model_t *model, const char *text,
                           const origin_t *origin)
{
    uint32_t address = 0;
    const bool has_termination = setting_of(model->settings, "termination") != NULL;
    if (text != NULL && !has_termination)
        return reject(origin, "--terminated has no effect on %s, which has no such setting.", model->name);
    options->terminated = has_termination ? options->addresses[options->count - 1] : 0;
    if (text == NULL) return true;
    if (strcmp(text, "none") != 0 &&
        (!number_parse(text, 1, model->max_address, &address) || !is_in(options, (uint8_t)address)))
        return reject(origin, "--terminated is '%s'. It takes one of --addresses, or none.", text);
    options->terminated = (uint8_t)address;
    return true;
}

/* Rejects sensors and ports that other commands accept. */
static bool is_suitable(const session_t *session, const origin_t *origin)
{
    const char *const port = session_port(session)->path;
    if (session->sensor->address != FACTORY_ADDRESS)
        return reject(origin, "new sensors have address %d. Leave address %u out.", FACTORY_ADDRESS,
                      session->sensor->address);
    if (!port_path_has_gateway(port)) return true;
    return reject(origin, "%s is no serial port. Behind a gateway, two sensors at one address look like one.",
                  port);
}

bool commission_options(commission_options_t *options, session_t *session, const arguments_t *arguments)
{
    const commission_settings_t *const settings = arguments->settings;
    const origin_t origin = {.command = arguments->command->name};
    if (!session_read(session, arguments, 1, 0) ||
        !session_set_mode(session, arguments, model_mode_of(session->sensor->model, NULL)) ||
        !is_suitable(session, &origin))
        return false;
    const model_t *const model = session->sensor->model;
    options->wait_us = settings->wait_us;
    options->record = settings->record;
    return set_addresses(options, model, settings->addresses, &origin) &&
           set_terminated(options, model, settings->terminated, &origin);
}
