/* SPDX-License-Identifier: MIT */
#include "device/session.h"

#include <limits.h>
#include <string.h>

#include "cli/command.h"
#include "cli/options.h"
#include "diagnosis/advice.h"
#include "ports/line_text.h"

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

const port_options_t *session_port(const session_t *session) { return session->station->port; }

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

const setting_t *session_settings(const session_t *session) { return session->station->model->settings; }

void session_listen(session_t *session, uint32_t for_us) { port_listen(&session->port, for_us); }

/* Its driver, from the beginning. */
static bool begin(session_t *session)
{
    sensor_t *const station = session->station;
    reader_settings_t settings = station->settings;
    settings.line = &station->line;
    settings.backoff_us = READER_BACKOFF_US;
    settings.address = station->address;
    if (!sensor_start(station, &session->port, &settings)) {
        char text[256];
        sensor_refusal(station, text, sizeof text);
        (void)fprintf(stderr, "fathom: %s\n", text);
        return false;
    }
    if (port_has_line(&session->port)) reader_listen_unasked(station->reader);
    return true;
}

bool session_open(session_t *session, const host_t *host)
{
    port_settings_t settings = port_options_settings(session_port(session));
    settings.line = session->station->line;
    if (!session->has_begun && !host->begin(host->ctx)) return false;
    session->has_begun = true;
    if (!port_open_now(&session->port, host, &settings)) {
        (void)fprintf(stderr, "fathom: %s\n", port_error(&session->port));
        return false;
    }
    counters_begin_port(&session->port_counts, &session->port);
    if (!begin(session)) {
        port_close(&session->port);
        return false;
    }
    /* What the device sends unasked is known before the first request, which leaves room for it (line.h). */
    if (port_has_line(&session->port)) port_listen(&session->port, PORT_LISTEN_US);
    return true;
}

bool session_move(session_t *session, uint8_t address, const fathom_line_settings_t *line)
{
    sensor_t *const station = session->station;
    reader_cancel(station->reader);
    memset(&station->counters, 0, sizeof station->counters); /* they prove nothing about another place */
    station->address = address;
    station->line = *line;
    sensor_set_name(station);
    return begin(session);
}

void session_close(session_t *session) { port_close(&session->port); }

fathom_status_t session_call(session_t *session, session_call_t call, void *ctx)
{
    reader_t *const reader = session->station->reader;
    fathom_status_t waited = FATHOM_OK;
    counters_begin_attempt(&session->station->counters);
    listener_forget(&session->port.listener);
    while (waited == FATHOM_OK) {
        const fathom_status_t status = call(reader, ctx);
        if (status != FATHOM_PENDING) return status;
        waited = port_wait(&session->port, reader_due_us(reader));
    }
    return waited;
}

/* ---- settings ---- */

typedef struct {
    const setting_t *setting;
    char *text;
    int32_t value;
} what_t;

static fathom_status_t call_get(reader_t *reader, void *ctx)
{
    const what_t *const what = ctx;
    return what->setting->get(reader, what->setting, what->text);
}

static fathom_status_t call_set(reader_t *reader, void *ctx)
{
    const what_t *const what = ctx;
    return what->setting->set(reader, what->setting, what->value);
}

/*
 * Calls again after a failure that wrote nothing. A busy line and another master prove nothing about the unit. If the
 * device sends by itself, one of its frames may have met the request or the response.
 */
static fathom_status_t call_again(session_t *session, session_call_t call, what_t *what)
{
    enum { TIMES = 4 };
    reader_t *const reader = session->station->reader;
    fathom_status_t status = FATHOM_PENDING;
    for (unsigned times = 0; times != TIMES; times++) {
        status = session_call(session, call, what);
        const bool is_met = status == FATHOM_ERR_NO_RESPONSE || status == FATHOM_ERR_CHECKSUM ||
                            status == FATHOM_ERR_MALFORMED;
        const reader_facts_t facts = reader_facts(reader);
        const bool is_of_line = status == FATHOM_ERR_LINE_BUSY || status == FATHOM_ERR_OTHER_MASTER;
        if (facts.is_written || !(is_of_line || (is_met && facts.has_unasked))) break;
    }
    return status;
}

fathom_status_t session_get(session_t *session, const setting_t *setting, char text[SETTING_TEXT])
{
    what_t what = {.setting = setting, .text = text};
    text[0] = '\0';
    return call_again(session, call_get, &what);
}

fathom_status_t session_set(session_t *session, const setting_t *setting, int32_t value)
{
    what_t what = {.setting = setting, .value = value};
    return call_again(session, call_set, &what);
}

const char *session_line_text(const session_t *session, char text[LINE_TEXT])
{
    return port_line_text(&session->port, &session->station->line, text);
}

void session_explain(session_t *session, fathom_status_t status)
{
    sensor_t *const station = session->station;
    failure_t failure = {.status = status,
                         .model = station->model,
                         .mode = station->mode,
                         .reader = station->reader,
                         .port = &session->port,
                         .counters = &station->counters,
                         .line = &station->line,
                         .address = station->address,
                         .is_setting = true};
    (void)counters_take(&station->counters, &session->port_counts, &session->port, station->reader);
    listener_judge(&session->port.listener, station->address, &failure.evidence);
    advice_print(stderr, &failure);
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
