/* SPDX-License-Identifier: MIT */
#include "cli/session_options.h"

#include <limits.h>
#include <string.h>

#include "cli/options.h"

const struct option session_table[SESSION_OPTIONS + 1] = {
    SESSION_OPTION_ROWS,
};

/* Nothing can be asked for in a mode in which a sensor is only listened to, or on pins. */
static bool check_modes(const site_t *site, const char *command)
{
    for (size_t i = 0; i != site->sensor_count; i++) {
        const model_mode_t *const mode = site->sensors[i]->mode;
        if (mode_is_asked(mode) && mode->pins == 0) continue;
        (void)usage_error(command, "in mode %s nothing is asked; leave it out", mode->name);
        return false;
    }
    return true;
}

/* Rows of what reads again and again, of no use to what asks once. */
static bool check_repetition(const char **values, const char *command)
{
    static const int rows[] = {OPTION_INTERVAL, OPTION_RECONNECT, OPTION_DURATION};
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        if (values[rows[i]] == NULL) continue;
        (void)usage_error(command, "there is no option --%s", session_table[rows[i]].name);
        return false;
    }
    return true;
}

/* The same as session_options, of so many of the words, if there are that many. */
static bool take_options(session_t *session, const char *command, int argc, char **argv,
                         const struct option *table, const char **values, int most, char ***words, int *count,
                         bool *wants_help)
{
    site_free(&session->site);
    memset(session, 0, sizeof *session);
    const int rest = options_parse(command, argc, argv, table, values);
    if (rest < 0) return false;
    *wants_help = values[SESSION_HELP] != NULL;
    if (*wants_help) return true;
    const int taken = argc - rest < most ? argc - rest : most;
    session->site.asks_all = true;
    if (!check_repetition(values, command) ||
        !option_json(command, values[SESSION_FORMAT], &session->is_json) ||
        !sensor_options(&session->site, command, argv + rest, taken, values, values[SESSION_ADDRESS],
                        values[SESSION_MODE]) ||
        !check_modes(&session->site, command))
        return false;
    session->station = session->site.sensors[0];
    *words = argv + rest + taken;
    *count = argc - rest - taken;
    return true;
}

bool session_options(session_t *session, const char *command, int argc, char **argv,
                     const struct option *table, const char **values, char ***words, int *count,
                     bool *wants_help)
{
    return take_options(session, command, argc, argv, table, values, 1, words, count, wants_help);
}

static bool take_sensors(session_t *session, const command_t *command, int argc, char **argv,
                         const struct option *table, const char **values, int most, int *status)
{
    char **words = NULL;
    int count = 0;
    bool wants_help = false;
    *status = STATUS_USAGE;
    if (!take_options(session, command->name, argc, argv, table, values, most, &words, &count, &wants_help))
        return false;
    if (wants_help)
        *status = command_help(command);
    else if (count != 0)
        (void)usage_error(command->name, "one sensor at a time; '%s' is too much", words[0]);
    return !wants_help && count == 0;
}

bool session_options_of_one(session_t *session, const command_t *command, int argc, char **argv,
                            const struct option *table, const char **values, int *status)
{
    return take_sensors(session, command, argc, argv, table, values, 1, status);
}

bool session_options_of_several(session_t *session, const command_t *command, int argc, char **argv,
                                const struct option *table, const char **values, int *status)
{
    return take_sensors(session, command, argc, argv, table, values, INT_MAX, status);
}

bool session_set_mode(session_t *session, const char *command, const char *const *values,
                      const model_mode_t *mode)
{
    if (values[SESSION_MODE] != NULL && session->station->mode != mode) {
        (void)usage_error(command, "this takes --mode %s", mode->name);
        return false;
    }
    session->station->mode = mode;
    return true;
}

bool session_can_set(const session_t *session, const char *command)
{
    if (session->station->address != 0) return true;
    (void)usage_error(command, "what is written to address 0 goes to all units, so nothing can be set there");
    return false;
}

void session_line_help(FILE *to)
{
    port_options_help(to);
    (void)fputs(
        "  --address N       1 from the factory; also as in hps167s:7\n"
        "  --mode MODE       modbus (default), or dyp for an a05 with frames 55 AA\n"
        "  --timeout MS      how long to wait for a measurement\n"
        "  --retries N       how often a failed request is repeated; what changes something never is\n",
        to);
}

void session_options_help(FILE *to)
{
    session_line_help(to);
    (void)fputs("  --format FORMAT   text (default) or json\n", to);
}
