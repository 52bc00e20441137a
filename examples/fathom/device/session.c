/* SPDX-License-Identifier: MIT */
#include "device/session.h"

#include <string.h>

#include "diagnosis/advice.h"
#include "ports/line_text.h"

const port_options_t *session_port(const session_t *session) { return session->station->port; }

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
