/* SPDX-License-Identifier: MIT */
#include "cli/session_options.h"

#include <stdarg.h>
#include <string.h>
#include <unistd.h>

#include "device/setting_text.h"
#include "output/words.h"

const option_t session_format_rows[] = {
    {"format", "FORMAT", "Print text or json (default text)", KIND_CHOICE, GROUP_OUTPUT, .words = "text json",
     AT(session_settings_t, is_json)},
    {.name = NULL},
};

const option_t session_yes_rows[] = {
    {"yes", .help = "Do not ask for confirmation", .group = GROUP_COMMAND,
     AT(session_settings_t, is_confirmed)},
    {.name = NULL},
};

static origin_t origin_of(const arguments_t *arguments)
{
    return (origin_t){.command = arguments->command->name};
}

bool session_read(session_t *session, const arguments_t *arguments, int most, int rest)
{
    const session_settings_t *const settings = arguments->settings;
    const origin_t origin = origin_of(arguments);
    const int count = arguments->count < most ? arguments->count : most;
    site_free(&session->site);
    memset(session, 0, sizeof *session);
    session->site.asks_all = true;
    session->is_json = settings->is_json;
    if (!sensors_read(&session->site, arguments, &settings->sensors, count, false)) return false;
    for (size_t i = 0; i != session->site.sensor_count; i++) {
        const sensor_t *const station = session->site.sensors[i];
        if (!mode_is_asked(station->mode) || station->mode->pins != 0)
            return reject(&origin, "%s in mode %s receives no requests. Leave the mode out.",
                          station->model->name, station->mode->name);
    }
    session->sensor = session->site.sensors[0];
    if (arguments->count - count > rest)
        return reject(&origin, "'%s' is one word too many.", arguments->words[count + rest]);
    return true;
}

bool session_set_mode(session_t *session, const arguments_t *arguments, const model_mode_t *mode)
{
    const session_settings_t *const settings = arguments->settings;
    const origin_t origin = origin_of(arguments);
    if (settings->sensors.defaults.mode != NULL && session->sensor->mode != mode)
        return reject(&origin, "--mode is %s, but this needs mode %s.", session->sensor->mode->name,
                      mode->name);
    session->sensor->mode = mode;
    return true;
}

bool session_can_set(const session_t *session, const arguments_t *arguments)
{
    const origin_t origin = origin_of(arguments);
    if (session->sensor->address != 0) return true;
    return reject(&origin, "a write to address 0 goes to all units, so no setting can be changed there.");
}

const setting_t *setting_named(const session_t *session, const char *name, const arguments_t *arguments)
{
    const setting_t *const settings = session->sensor->model->settings;
    const origin_t origin = origin_of(arguments);
    const setting_t *const found = setting_of(settings, name);
    char what[64];
    char known[SETTING_VALUES] = "";
    nearest_t nearest = {.word = name};
    if (found != NULL) return found;
    for (const setting_t *setting = settings; setting->name != NULL; setting++) {
        nearest_try(&nearest, setting->name);
        list_add(known, sizeof known, setting->name);
    }
    (void)snprintf(what, sizeof what, "setting of %s", session->sensor->model->name);
    (void)reject_unknown(&origin, what, "", &nearest, known);
    return NULL;
}

bool confirm(const arguments_t *arguments, bool is_confirmed, const char *format, ...)
{
    const origin_t origin = origin_of(arguments);
    char text[300];
    char answer[8] = "";
    va_list list;
    if (is_confirmed) return true;
    va_start(list, format);
    (void)vsnprintf(text, sizeof text, format, list);
    va_end(list);
    if (isatty(STDIN_FILENO) != 1 || isatty(STDERR_FILENO) != 1)
        return reject(&origin, "%s To confirm that, add --yes.", text);
    (void)fprintf(stderr, "%s Continue? [y/N] ", text);
    if (fgets(answer, sizeof answer, stdin) != NULL && (answer[0] == 'y' || answer[0] == 'Y')) return true;
    (void)fputs("fathom: nothing was written.\n", stderr);
    return false;
}
